"""Snapshots: restore and go on equals going on."""
