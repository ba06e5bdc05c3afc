"""What a name is to the finder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from calibration.candidates.candidate import Candidate
from calibration.names.scene import Scene

FORCE, SENSORS = "force", "sensors"


def _nothing_lacks(_: Scene) -> str:
    return ""


@dataclass(frozen=True)
class Name:
    """One name of the catalogue.

    channels: kinds of balance it can be seen in ("force", "sensors"). columns: its candidates along a motion;
    lacks: what a log would need to show it, empty when it has all. twins: names that look alike; experiment:
    what tells them apart.
    """

    name: str
    channels: tuple[str, ...]
    columns: Callable[[Scene], list[Candidate]]
    twins: tuple[str, ...]
    experiment: str
    lacks: Callable[[Scene], str] = _nothing_lacks
