"""Searches and surveys that found the numbers of the plant files; no command of the product needs them."""
