"""Targets of a scenario: found and checked before anything is built, let alone moved."""

from typing import Any

from host.sky.angles import parse_declination, parse_right_ascension
from host.sky.catalogue import Star, star
from host.sky.visibility import Unreachable, check_reachable
from scenarios.language.document import ScenarioError
from scenarios.language.model import Scenario

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
