"""In a checkout: a `plant.py` or `bus/` of somebody else on the path is not taken for a room of ours.

A wheel needs none of this: its rooms lie below the package `schmidt` (`native/relocate.py`).
"""

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

from scenarios.native.modules import PACKAGE, ROOT
from scenarios.native.relocate import ROOMS


class Rooms:
    """Entry of `sys.meta_path`: the six rooms, from where this file lies."""

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """A room by its name; the modules in it follow."""
        return PathFinder.find_spec(name, [str(ROOT)]) if name in ROOMS else None


def ours_first() -> None:
    """Let the rooms be found here, whatever stands on the path; once."""
    if not PACKAGE and not any(isinstance(finder, Rooms) for finder in sys.meta_path):
        sys.meta_path.insert(0, Rooms())
