"""Extras of the installation: which one a package belongs to, and the command that installs it."""

import re
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec

PROJECT = "schmidt"
_LINE = re.compile(
    r"(?P<name>[\w-]+)(?:\[(?P<extras>[\w,-]+)\])?(?P<versions>[^;]*).*extra == ['\"](?P<of>[\w-]+)"
)


class MissingPart(ValueError):
    """Packages of an extra are not installed; the message is the command that installs them."""


def need(*extras: str) -> None:
    """Raise MissingPart unless all packages of these extras are installed."""
    for extra in extras:
        packages = dict(_packages(extra))
        missing = [name for name in packages if find_spec(name.replace("-", "_")) is None]
        if missing:
            raise MissingPart(_advice(missing, extra, packages))


def advice(module: str) -> str:
    """What to install for a module that could not be imported; empty where no extra brings it."""
    package = module.partition(".")[0].replace("_", "-")
    for extra in dict.fromkeys(found["of"] for found in _lines()):
        packages = dict(_packages(extra))
        if package in packages and extra != "all":
            return _advice([package], extra, packages)
    return ""


def _advice(missing: list[str], extra: str, packages: dict[str, str]) -> str:
    wanted = " ".join(f'"{name}{versions}"' for name, versions in packages.items())
    return f"not installed: {', '.join(missing)} (extra {extra}); {sys.executable} -m pip install {wanted}"


def _packages(extra: str) -> Iterator[tuple[str, str]]:
    """(package, versions) of an extra and of the extras it names."""
    for found in _lines():
        if found["of"] != extra:
            continue
        if found["name"] == PROJECT:
            for inner in found["extras"].split(","):
                yield from _packages(inner)
        else:
            yield found["name"], found["versions"].strip()


def _lines() -> list[re.Match[str]]:
    try:
        return list(filter(None, map(_LINE.match, requires(PROJECT) or ())))
    except PackageNotFoundError:  # a source tree on the path alone
        return []
