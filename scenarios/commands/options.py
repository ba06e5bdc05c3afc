"""Kinds of options that several commands have."""

from __future__ import annotations

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
