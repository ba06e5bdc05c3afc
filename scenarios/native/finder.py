"""Finds our rooms first, and their compiled modules, all or none: compiled code relies on its own kind."""

import os
import sys
from collections.abc import Sequence
from importlib.machinery import ExtensionFileLoader, ModuleSpec, PathFinder
from importlib.util import spec_from_file_location
from pathlib import Path
from types import ModuleType

from scenarios.native.modules import PACKAGE, ROOMS, ROOT
from scenarios.native.stamp import LIBRARY, difference, read

PURE = "SCHMIDT_PURE"


class Finder:
    """Entry of `sys.meta_path`. files: module name to its compiled file."""

    def __init__(self, files: dict[str, Path]) -> None:
        self.files = files

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The compiled module of this name, if there is one."""
        file = self.files.get(name)
        if file is None:
            return None
        return spec_from_file_location(name, file, loader=ExtensionFileLoader(name, str(file)))


def compiled() -> bool:
    """Whether this process runs compiled."""
    return any(isinstance(finder, Finder) for finder in sys.meta_path)


def plain() -> bool:
    """Run plain in this process after all, if nothing compiled has been imported yet; whether it does."""
    for finder in [each for each in sys.meta_path if isinstance(each, Finder)]:
        if finder.files.keys().isdisjoint(sys.modules):
            sys.meta_path.remove(finder)
    return not compiled()


def use(library: Path = LIBRARY) -> None:
    """Let imports from now on find the library, when there is one and it fits; otherwise one line at most.

    Raises ImportError when SCHMIDT_PURE=0 insists on it.
    """
    wish = os.environ.get(PURE, "")
    if compiled() or wish not in ("", "0"):
        return
    stamp = read(library)
    modules = {} if stamp is None else stamp.get("modules")
    files = {name: library / file for name, file in modules.items()} if isinstance(modules, dict) else {}
    late = not files.keys().isdisjoint(sys.modules)
    reason = "is not there" if stamp is None else difference(stamp)
    if wish == "0" and (reason or late):
        reason = reason or "comes too late: import scenarios before the other rooms"
        raise ImportError(f"the compiled library {reason}; `make compiled` builds it, {PURE}=1 does without")
    if stamp is not None and reason:
        print(f"schmidt: the compiled library {reason}; running plain (`make compiled`)", file=sys.stderr)
        os.environ[PURE] = "1"  # processes of its own run alike, and do not say it again
    elif files and not late:
        sys.meta_path.insert(0, Finder(files))


class Rooms:
    """Entry of `sys.meta_path`: the six rooms from where this file lies, not somebody's `plant.py`.

    A wheel needs none of this: its rooms lie below the package `schmidt` (`setup.py`).
    """

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """A room by its name; the modules in it follow."""
        return PathFinder.find_spec(name, [str(ROOT)]) if name in (*ROOMS, "calibration") else None


def ours_first() -> None:
    """Let the rooms be found here, whatever stands on the path; once."""
    if not PACKAGE and not any(isinstance(finder, Rooms) for finder in sys.meta_path):
        sys.meta_path.insert(0, Rooms())
