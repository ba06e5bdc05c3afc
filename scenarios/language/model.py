"""A scenario as the runner uses it: plain values in base units, every name checked."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from host.sky.mount import Mount, limits_mount
from host.sky.observed import Clock
from host.sky.site import NAINITAL, Site
from host.sky.visibility import HORIZON_RAD

HOUR_ANGLE_LIMIT_RAD = math.radians(100.0)
"""ASSUMPTION: the yoke lets the tube reach somewhat under the pole either side of the meridian."""
DECLINATION_LOW_RAD = math.radians(-45.0)
"""ASSUMPTION: the southern horizon of the site is at −60.6°; objects are useful to about −45°."""
DECLINATION_HIGH_RAD = math.radians(92.0)
"""ASSUMPTION: two degrees beyond the pole, so that the pole itself can be reached."""


@dataclass(frozen=True, kw_only=True)
class Step:
    """One action and when it starts, in seconds of simulated time; without conditions it follows the last."""

    name: str
    action: str
    arguments: dict[str, Any]
    where: str
    at_s: float | None = None
    after: str | None = None
    delay_s: float = 0.0
    when: str | None = None
    timeout_s: float | None = None


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Something that goes wrong from `at_s` until `until_s`. may_not_act: or never does."""

    kind: str
    arguments: dict[str, Any]
    where: str
    at_s: float = 0.0
    until_s: float | None = None
    may_not_act: bool = False


@dataclass(frozen=True, kw_only=True)
class Expectation:
    """Something that must hold: a figure of the run against a limit, in base units."""

    name: str
    kind: str
    arguments: dict[str, Any]
    limit: float
    upper: bool
    where: str


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """Everything a run needs."""

    file: Path
    name: str
    description: str = ""
    clock: Clock
    steps: tuple[Step, ...] = ()
    faults: tuple[Fault, ...] = ()
    expectations: tuple[Expectation, ...] = ()
    network: dict[str, Any] = field(default_factory=dict)
    plant: dict[str, Any] = field(default_factory=dict)
    site: Site = NAINITAL
    mount: Mount = field(
        default_factory=lambda: limits_mount(
            HOUR_ANGLE_LIMIT_RAD, DECLINATION_LOW_RAD, DECLINATION_HIGH_RAD, NAINITAL.latitude_rad
        )
    )
    start_rad: dict[str, float] = field(default_factory=dict)
    """Where the telescope stands at first, `hour_angle` and `declination`; what is missing is parked."""
    horizon_rad: float = HORIZON_RAD
    seed: int = 1
    speed: float | None = None
    """Times real time; None: as fast as possible."""
    time_limit_s: float = 12 * 3600.0
    status_period_s: float = 0.25
    """Period of the status and sensor logs; the paper's consoles refresh every 250 ms."""
    can_log: str = "text"
    """`text` or `candump` (can.log), `zstd` (can.log.zst, the same text packed; the digest is that of the
    text). `mf4`, `blf`, `asc`: the same frames once more, in can.ENDING beside can.log."""
    trace_period_s: float = 0.01
    """Period of the Parquet traces; the boards log at 10 ms."""
