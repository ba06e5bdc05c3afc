"""Faults: what each does while it is on, and what is left when it is over."""
