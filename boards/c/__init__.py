"""Boards whose firmware is compiled C (docs/guides/firmware-in-c.md)."""
