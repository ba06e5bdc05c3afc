"""Sealer: another simulator of the same drive. It imports none of the project's rooms (a test holds it)."""
