"""Options of commands as fields of records, extras that they need, and their ends that are errors."""

import re
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import MISSING, field, fields
from functools import wraps
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

import click

PATH = click.Path(path_type=Path)


class Number(click.FloatRange):
    """A range that nan is not in: it passes every comparison of click's."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or click's own error."""
        number = super().convert(value, param, ctx)
        if number != number:
            self.fail(f"{value} is no number", param, ctx)
        return number


def _word(_ctx: click.Context, _param: click.Parameter, value: str | None) -> str | None:
    if value is not None and value.split() != [value]:  # nobody could say it to a door
        raise click.BadParameter("it is one word, without blanks")
    return value


WORD: dict[str, Any] = {"callback": _word}
"""Settings of a token."""
SPEED = Number(0.01, 1000)
"""`bus.outside.pacer` has the same bounds; not imported here, so that the command starts at once."""
SEED = click.IntRange(0, 2**63 - 1)
SECONDS = Number(min=0, min_open=True, max=1e7)
NETWORK: dict[str, Any] = {
    "type": click.Choice(["lab", "serial", "final"]),
    "help": "Which boards: the lab's 11, the 5 with RS232, or all 18.",
}
"""`scenarios/lab/networks.py` has the same; not imported here, for the same reason."""
network = click.option("--network", **NETWORK)


def option(help: str | None = None, *flags: str, default: Any = None, **settings: Any) -> Any:
    """A field that `--its-name`, or other flags, give; default MISSING: it has to be given."""
    return field(default=default, metadata={"flags": flags, "settings": {"help": help, **settings}})


def argument(default: Any = None, **settings: Any) -> Any:
    """A field that stands on the command line without a flag."""
    return field(default=default, metadata={"settings": {"required": default is MISSING, **settings}})


def filled(record: Callable[..., Any]) -> Callable[[Callable[[Any], Any]], Callable[..., Any]]:
    """The command gets a record: a dataclass with these fields; others come with further decorators."""

    def with_options(command: Callable[[Any], Any]) -> Callable[..., Any]:
        @wraps(command)
        def call(**given: Any) -> Any:
            return command(record(**given))

        for each in reversed(fields(record)):  # type: ignore[arg-type]
            settings = dict(each.metadata.get("settings", {}))
            if "flags" in each.metadata:
                settings |= {"required": True} if each.default is MISSING else {"default": each.default}
                flags = each.metadata["flags"] or (f"--{each.name.replace('_', '-')}",)
                call = click.option(*flags, each.name, **settings)(call)
            elif settings:
                call = click.argument(each.name, **settings)(call)
        return call

    return with_options


def jobs_option() -> Any:
    """Processes."""
    return option("Processes on this machine (default: one per core).", type=click.IntRange(1, 1024))


def scheduler_option() -> Any:
    """A cluster's."""
    return option("A Dask scheduler instead (the extra cluster).", metavar="tcp://HOST:PORT")


def muting(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options `--mute` and `--feed`: the command gets board and log as `muted`, or None."""

    @wraps(command)
    def call(mute: str | None, feed: Path | None, **given: Any) -> Any:
        if (mute is None) != (feed is None):
            raise click.UsageError("--mute BOARD and --feed LOG go together")
        return command(muted=None if mute is None else (mute, feed), **given)

    call = click.option("--feed", type=PATH, metavar="LOG", help="Log to take them from (candump -L).")(call)
    return click.option(
        "--mute", metavar="BOARD", help="This board sends nothing; its frames come from --feed."
    )(call)


def doors(*kinds: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """An option for each of these doors; the command gets their values as `asked`, by the doors' names."""

    def with_options(command: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(command)
        def call(**given: Any) -> Any:
            specs = {kind.name: given.pop(kind.name) for kind in kinds}
            asked = {
                name: spec if isinstance(spec, tuple) else (spec,)
                for name, spec in specs.items()
                if spec is not None
            }
            return command(asked=asked, **given)

        for kind in reversed(kinds):
            option = click.option(
                f"--{kind.name}", multiple=kind.repeatable, metavar=kind.form, help=kind.help
            )
            call = option(call)
        return call

    return with_options


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
