"""What a name is to the finder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from calibration.candidates.candidate import Candidate
from calibration.names.scene import Scene

FORCE, SENSORS, VOLTS = "force", "sensors", "volts"


def _nothing_lacks(_: Scene) -> str:
    return ""


@dataclass(frozen=True)
class OwnFormula:
    """A torque that is `size` (a parameter of the effect) times the effect's own formula (plant/effects).

    `tried` are first values of the formula's other parameters, each in its unit; the best is refined. What is
    not tried keeps its default.
    """

    size: str
    tried: Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class Name:
    """One name of the catalogue.

    channels: kinds of balance it can be seen in ("force", "sensors", "volts"). columns: its candidates along
    a motion; lacks: what a log would need to show it, empty when it has all. twins: names that look alike;
    experiment: what tells them apart. own: its columns are the effect's formula; the telescope's axis and the
    plant file need nothing else.
    """

    name: str
    channels: tuple[str, ...]
    columns: Callable[[Scene], list[Candidate]]
    twins: tuple[str, ...]
    experiment: str
    lacks: Callable[[Scene], str] = _nothing_lacks
    own: OwnFormula | None = None
