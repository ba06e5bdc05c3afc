"""Kinds of options that several commands have."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

from scenarios.doors.table import DoorKind
from scenarios.options import PATH


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


def doors(*kinds: DoorKind[Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
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
