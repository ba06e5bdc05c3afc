"""Readers: axis logs, PHD2 guide logs, and any drive's table with a rig file."""
