"""Broken input for every door: "accepted, or refused with a declared error, and all boards still tick"."""

import scenarios  # noqa: F401  (before the other rooms, so that the library can be used)
