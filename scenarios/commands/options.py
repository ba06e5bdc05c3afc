"""Kinds of options that several commands have."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click


class Number(click.FloatRange):
    """A range that nan is not in: it passes every comparison of click's."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or click's own error."""
        number = super().convert(value, param, ctx)
        if number != number:
            self.fail(f"{value} is no number", param, ctx)
        return number


SPEED = Number(0.01, 1000)
"""`bus.pacer` has the same bounds; not imported here, so that the command starts at once."""
SEED = click.IntRange(0, 2**63 - 1)
SECONDS = Number(min=0, min_open=True, max=1e7)
NETWORK = click.Choice(["lab", "serial", "final"])
"""`scenarios/networks.py` has the same; not imported here, for the same reason."""


def feeding(mute: str | None, feed: Path | None) -> tuple[str, Path] | None:
    """A board and the log its frames come from; raises UsageError for one without the other."""
    if (mute is None) != (feed is None):
        raise click.UsageError("--mute BOARD and --feed LOG go together")
    return None if mute is None or feed is None else (mute, feed)


def host_doors(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of the doors that a host opens, beside emulated boards or alone."""
    for option in reversed(
        (
            click.option(
                "--lx200",
                multiple=True,
                metavar="[HOST:]PORT|pty:NAME",
                help="LX200, for Stellarium and INDI; repeatable.",
            ),
            click.option(
                "--alpaca", metavar="[HOST:]PORT", help="ASCOM Alpaca telescope and focuser, with discovery."
            ),
            click.option("--console", metavar="[HOST:]PORT", help="The consoles, for a browser."),
            click.option(
                "--runs",
                type=click.Path(path_type=Path),
                default=Path("out/console"),
                show_default=True,
                help="Folder of the runs recorded on the console.",
            ),
        )
    ):
        command = option(command)
    return command
