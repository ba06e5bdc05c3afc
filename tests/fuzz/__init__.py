"""Broken input for every door: "accepted, or refused with a declared error, and all boards still tick"."""
