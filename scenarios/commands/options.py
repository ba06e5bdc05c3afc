"""Kinds of options that several commands have."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

from scenarios.doors.table import DoorKind

PATH = click.Path(path_type=Path)


class Number(click.FloatRange):
    """A range that nan is not in: it passes every comparison of click's."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or click's own error."""
        number = super().convert(value, param, ctx)
        if number != number:
            self.fail(f"{value} is no number", param, ctx)
        return number


SPEED = Number(0.01, 1000)
"""`bus.outside.pacer` has the same bounds; not imported here, so that the command starts at once."""
SEED = click.IntRange(0, 2**63 - 1)
SECONDS = Number(min=0, min_open=True, max=1e7)
NETWORK = click.Choice(["lab", "serial", "final"])
"""`scenarios/lab/networks.py` has the same; not imported here, for the same reason."""
network = click.option(
    "--network", type=NETWORK, help="Which boards: the lab's 11, the 5 with RS232, or all 18."
)
jobs = click.option(
    "--jobs", type=click.IntRange(1, 1024), help="Processes on this machine (default: one per core)."
)
runs = click.option(
    "--runs", type=PATH, default=Path("out/console"), help="Folder of the runs recorded on the console."
)


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
