"""A scenario as the runner uses it: plain values in base units, every name checked, targets within reach."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from host.sky.angles import parse_declination, parse_right_ascension
from host.sky.catalogue import Star, star
from host.sky.mount import Mount, limits_mount
from host.sky.observed import Clock
from host.sky.site import NAINITAL, Site
from host.sky.visibility import HORIZON_RAD, Unreachable, check_reachable
from scenarios.language.document import ScenarioError

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


_GOTO_S = 60.0
"""What a goto is taken to last when the time of later steps is estimated."""
STARS = 40
"""Of a pointing run that says no number: twice the 20 coordinates of ten terms. ASSUMPTION."""


_PROPER_MOTION = 20_000.0
"""mas/yr; Barnard's star, the fastest known, moves by 10 390 (SIMBAD)."""


def target_of(given: Any, where: str) -> Star:
    """The star of a `target` field: a name of the catalogue, or coordinates."""
    try:
        if isinstance(given, str):
            return star(given)
        for key in ("pm_ra", "pm_dec"):
            if not abs(float(given.get(key, 0.0))) <= _PROPER_MOTION:
                raise ValueError(f"{key}: no star moves by more than {_PROPER_MOTION:g} mas/yr")
        return Star(
            name=str(given.get("name") or f"{given['ra']} {given['dec']}"),
            right_ascension_rad=parse_right_ascension(given["ra"]),
            declination_rad=parse_declination(given["dec"]),
            pm_ra_mas_yr=float(given.get("pm_ra", 0.0)),
            pm_dec_mas_yr=float(given.get("pm_dec", 0.0)),
        )
    except ValueError as error:
        raise ScenarioError(f"{where}: target: {error}") from None


def check_targets(scenario: Scenario) -> None:
    """Refuse a scenario with a target that is out of reach when it is to be reached or while it is tracked.

    Times are estimated: waiting and tracking as stated, a minute for every goto and star of a pointing run.
    """
    t_s = 0.0
    aim: tuple[Star, str] | None = None
    for step in scenario.steps:
        if step.after is not None:
            continue
        t_s = max(t_s, step.at_s or 0.0) + step.delay_s
        stay_s = float(step.arguments.get("for", 0.0))
        if step.action == "goto":
            aim = (target_of(step.arguments["target"], step.where), step.where)
        if step.action in ("goto", "track", "autoguide") and aim is not None:
            target, where = aim
            try:
                check_reachable(target, scenario, t_s, stay_s)
            except Unreachable as error:
                raise ScenarioError(f"{where}: {error}") from None
        if step.action == "pointing_run":
            stay_s = _GOTO_S * step.arguments.get("stars", STARS)
            aim = None
        t_s += _GOTO_S if step.action in ("goto", "park") else stay_s
