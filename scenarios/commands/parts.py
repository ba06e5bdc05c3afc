"""How a command ends that does not end well; extras of the installation, and what installs them."""

import re
import sys
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from typing import NoReturn

import click

UNUSABLE = 2
INTERRUPTED = 130
_LONGEST = 600
"""Longer messages quote somebody's megabyte."""
_LINE = re.compile(
    r"(?P<name>[\w-]+)(?:\[(?P<extras>[\w,-]+)\])?(?P<versions>[^;]*).*extra == ['\"](?P<of>[\w-]+)"
)


def fail(text: str, status: int, more: Iterable[str] = ()) -> NoReturn:
    """Say `schmidt: text` on stderr, in one line, and a line for each of `more`; leave with `status`."""
    for each in (text, *more):
        said = " ".join(each.split())
        if len(said) > _LONGEST:
            said = said[: _LONGEST // 2] + " … " + said[-_LONGEST // 2 :]
        click.echo(f"schmidt: {said}".encode(errors="backslashreplace").replace(b"\0", b"\\0"), err=True)
    sys.exit(status)


def need(*extras: str) -> None:
    """Raise ValueError unless all packages of these extras are installed."""
    for extra in extras:
        packages = dict(_packages(extra))
        missing = [name for name in packages if find_spec(name.replace("-", "_")) is None]
        if missing:
            raise ValueError(_advice(missing, extra, packages))


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
        if found["name"] == "schmidt":
            for inner in found["extras"].split(","):
                yield from _packages(inner)
        else:
            yield found["name"], found["versions"].strip()


def _lines() -> list[re.Match[str]]:
    try:
        return list(filter(None, map(_LINE.match, requires("schmidt") or ())))
    except PackageNotFoundError:  # a source tree on the path alone
        return []
