"""Blind tests: a sealer that writes logs with a hidden effect, and a harness that scores a finder on them."""
