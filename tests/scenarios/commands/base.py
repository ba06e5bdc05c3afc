"""`python -m tests.scenarios.commands.base WORDS...`: schmidt as if the base alone were installed."""

import re
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from types import ModuleType


def closure(package: str, extras: frozenset[str] = frozenset()) -> set[str]:
    """Packages that an installation of `package` brings, in lower case with dashes."""
    found: set[str] = set()
    waiting = [(package, extras)]
    while waiting:
        name, wanted = waiting.pop()
        name = re.sub(r"[-_.]+", "-", name).lower()
        if name in found and not wanted:
            continue
        found.add(name)
        try:
            lines = requires(name) or []
        except PackageNotFoundError:  # of another platform
            continue
        for line in lines:
            extra = re.search(r"extra == ['\"]([\w-]+)", line)
            if extra is None or extra[1] in wanted:
                inner = re.search(r"^[\w.-]+\[([\w,-]+)\]", line)
                names = frozenset(inner[1].split(",")) if inner else frozenset()
                match = re.match(r"[\w.-]+", line)
                assert match is not None
                waiting.append((match[0], names))
    return found


class BaseOnly(PathFinder):
    """Finds no module of a package outside the base."""

    hidden: frozenset[str] = frozenset()

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """As PathFinder, but for what is hidden."""
        return None if name.partition(".")[0] in cls.hidden else super().find_spec(name, path, target)


def hide() -> None:
    """Hide what the base does not bring. A module of two packages is there when one of them is."""
    base = closure("schmidt")
    BaseOnly.hidden = frozenset(
        module
        for module, packages in packages_distributions().items()
        if not base & {re.sub(r"[-_.]+", "-", each).lower() for each in packages}
    ) - {"tests", "setuptools", "_distutils_hack"}
    sys.meta_path[:] = [BaseOnly if finder is PathFinder else finder for finder in sys.meta_path]


if __name__ == "__main__":
    hide()
    from scenarios.cli import main

    main()
