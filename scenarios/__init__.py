"""Scenario files, their schema, the wiring, the runner and the command line."""

from scenarios.native import use
from scenarios.native.finder import ours_first

ours_first()
try:
    use()
except ImportError as error:  # SCHMIDT_PURE=0 insists on what is not there
    raise SystemExit(f"schmidt: {error}") from None
