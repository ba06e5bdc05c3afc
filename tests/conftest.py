"""For all rooms: no property test fails because the machine was busy; plain Python unless SCHMIDT_PURE=0."""

import os
import signal

os.environ.setdefault("SCHMIDT_PURE", "1")

from hypothesis import settings

import scenarios  # noqa: F401  (before the other rooms, so that the library can be used)

settings.register_profile("house", deadline=None)
settings.load_profile("house")
# What a shell starts in the background ignores Ctrl-C, and so would the programs that tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)
