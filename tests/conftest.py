"""For all rooms: no property test fails because the machine was busy; plain Python unless SCHMIDT_PURE=0."""

import os

os.environ.setdefault("SCHMIDT_PURE", "1")

from hypothesis import settings

import scenarios  # noqa: F401  (before the other rooms, so that the library can be used)

settings.register_profile("house", deadline=None)
settings.load_profile("house")
