"""From a scenario file to a `Scenario`; everything wrong with it is found here, before anything is built."""

from __future__ import annotations

import copy
import dataclasses
import datetime as dt
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from host.sky.angles import ARCSEC_PER_RAD
from host.sky.mount import limits_mount
from host.sky.observed import Clock
from host.sky.site import NAINITAL, Site, standard_pressure_hpa
from scenarios import model
from scenarios.document import Document, ScenarioError, read
from scenarios.faults.kind import FaultError
from scenarios.faults.place import WORDS
from scenarios.faults.table import BY_NAME
from scenarios.units import parse
from scenarios.validate import check, check_finite, nearest, schema

DEFAULT_PLANT = "low-preload"
_YEARS = (1960, 2100)
"""UTC begins in 1960 (ERFA's table of leap seconds); beyond 2100 the sun's place is nobody's plan."""
_STEP_FIELDS = {"name", "at", "after", "delay", "when", "timeout"}


def load(file: Path) -> model.Scenario:
    """Read, check and convert a scenario file; raises `ScenarioError` with one line of what and where."""
    return convert(read(file))


def convert(document: Document) -> model.Scenario:
    """Check and convert a parsed document."""
    language = with_boards(document)
    check(document, language)
    check_finite(document)
    data: dict[str, Any] = in_base_units(document.data, language)
    steps = tuple(_step(document, index, each) for index, each in enumerate(data["steps"]))
    _check_names(document, steps)
    plant = data.get("plant", DEFAULT_PLANT)
    speed = data.get("speed", "max")
    logs = _logs(document, {word: each for word, each in data.get("logs", {}).items() if word in _PERIODS})
    site = _site(document, data.get("site", {}))
    scenario = model.Scenario(
        file=document.file,
        name=data["name"],
        description=data.get("description", ""),
        clock=_clock(document, str(data["start_utc"])),
        steps=steps,
        faults=tuple(_fault(document, index, each) for index, each in enumerate(data.get("faults", []))),
        expectations=tuple(
            _expectation(document, index, each) for index, each in enumerate(data.get("expect", []))
        ),
        network=data.get("network", {}),
        plant={"file": plant} if isinstance(plant, str) else plant,
        site=site,
        start_rad={axis: angle / ARCSEC_PER_RAD for axis, angle in data.get("start", {}).items()},
        seed=data.get("seed", 1),
        speed=None if speed == "max" else float(speed),
        time_limit_s=data.get("time_limit", 12 * 3600.0),
        status_period_s=logs.get("status", 0.25),
        trace_period_s=logs.get("traces", 0.01),
        can_log=data.get("logs", {}).get("can", "text"),
    )
    scenario = _with_mount(document, scenario, data)
    _check_windows(document, scenario)
    return scenario


def with_boards(document: Document) -> dict[str, Any]:
    """The language, with the names of the boards that the document brings along; raises `ScenarioError`."""
    network = document.data.get("network") if isinstance(document.data, Mapping) else None
    files = network.get("boards") if isinstance(network, Mapping) else None
    if not isinstance(files, list) or not all(isinstance(file, str) for file in files):
        return schema()
    from scenarios.nodes import load_board

    names: list[str] = []
    for index, file in enumerate(files):
        try:
            names += load_board(document.file.parent / file).KIND.nodes
        except ValueError as error:
            where = document.where(("network", "boards", index))
            raise ScenarioError(f"{where}: network.boards: {error}") from None
    language = copy.deepcopy(schema())
    nodes = language["properties"]["network"]["properties"]["nodes"]["properties"]
    language["$defs"]["node"]["enum"] += [name for name in names if name not in nodes]
    nodes |= {name: {"$ref": "#/$defs/settings"} for name in names}
    return language


def in_base_units(value: Any, rule: Mapping[str, Any]) -> Any:
    """A value with every quantity the schema marks turned into a number in its base unit."""
    if "$ref" in rule:
        rule = schema()["$defs"][str(rule["$ref"]).rsplit("/", 1)[1]]
    if "x-quantity" in rule:
        return parse(value, rule["x-quantity"])
    if isinstance(value, Mapping):
        properties: Mapping[str, Any] = _part(rule, "properties")
        others = rule.get("additionalProperties") or {}
        return {key: in_base_units(each, properties.get(key, others)) for key, each in value.items()}
    if isinstance(value, list):
        return [in_base_units(each, _part(rule, "items")) for each in value]
    return value


def _part(rule: Mapping[str, Any], part: str) -> Mapping[str, Any]:
    """What a rule, or the first of its alternatives that has it, says of its `part`."""
    own: Mapping[str, Any] = rule.get(part) or {}
    return own or next((each[part] for each in rule.get("oneOf", []) if part in each), {})


def _step(document: Document, index: int, data: dict[str, Any]) -> model.Step:
    action = next(key for key in data if key not in _STEP_FIELDS)
    arguments = data[action]
    target = arguments.get("target")
    name = data.get("name") or (f"{action} {_target_name(target)}" if target else f"{action} {index + 1}")
    return model.Step(
        name=name,
        action=action,
        arguments=arguments,
        where=document.where(("steps", index)),
        at_s=data.get("at"),
        after=data.get("after"),
        delay_s=data.get("delay", 0.0),
        when=data.get("when"),
        timeout_s=data.get("timeout"),
    )


_PERIODS = {"status": (0.05, 100.0), "traces": (0.001, 10.0)}
"""Shortest and longest period of the logs, s: the boards answer in milliseconds, the plant in 0.5 ms."""


def _logs(document: Document, logs: dict[str, float]) -> dict[str, float]:
    for name, period_s in logs.items():
        low, high = _PERIODS[name]
        if not low <= period_s <= high:
            where = document.where(("logs", name))
            raise ScenarioError(f"{where}: logs.{name}: {period_s:g} s is not within {low:g}..{high:g} s")
    return logs


def _target_name(target: Any) -> str:
    return target if isinstance(target, str) else str(target.get("name") or f"{target['ra']} {target['dec']}")


def _fault(document: Document, index: int, data: dict[str, Any]) -> model.Fault:
    kind = next(key for key in data if key not in ("name", "at", "until"))
    where = document.where(("faults", index))
    at_s, until_s = data.get("at", 0.0), data.get("until")
    if until_s is not None and until_s <= at_s:
        raise ScenarioError(f"{where}: the fault ends at {until_s:g} s, before it starts at {at_s:g} s")
    if kind == "frame_loss" and not data[kind].keys() & {"node", "identifier"}:
        raise ScenarioError(f"{where}: frame_loss needs a node or an identifier")
    probability = data[kind].get("probability", 1.0)
    if not 0.0 <= probability <= 1.0:
        raise ScenarioError(f"{where}: a probability lies between 0 % and 100 %, not at {probability:.0%}")
    try:
        BY_NAME[kind].arguments(data[kind], {"node": tuple(schema()["$defs"]["node"]["enum"]), **WORDS})
    except FaultError as error:
        raise ScenarioError(f"{where}: {error}") from None
    return model.Fault(kind, data[kind], where, at_s, until_s)


def _expectation(document: Document, index: int, data: dict[str, Any]) -> model.Expectation:
    kind = next(key for key in data if key != "name")
    arguments = dict(data[kind])
    upper = "at_most" in arguments
    limit = float(arguments.pop("at_most" if upper else "at_least"))
    words = [kind.replace("_", " "), *(str(arguments[key]) for key in ("axis", "source") if key in arguments)]
    if "during" in arguments:
        words.append(f"during {arguments['during']}")
    name = data.get("name", " ".join(words))
    return model.Expectation(name, kind, arguments, limit, upper, document.where(("expect", index)))


def _check_names(document: Document, steps: tuple[model.Step, ...]) -> None:
    known: list[str] = []
    for index, step in enumerate(steps):
        if step.name in known and "name" in document.data["steps"][index]:
            raise ScenarioError(f"{step.where}: there is already a step called {step.name!r}")
        if step.after is not None and step.after not in known:
            where = document.where(("steps", index, "after"))
            raise ScenarioError(
                f"{where}: no earlier step is called {step.after!r}; {nearest(step.after, known)}"
            )
        known.append(step.name)


def _check_windows(document: Document, scenario: model.Scenario) -> None:
    names = [step.name for step in scenario.steps]
    for expectation in scenario.expectations:
        during = expectation.arguments.get("during")
        if during is not None and during not in names:
            raise ScenarioError(
                f"{expectation.where}: no step is called {during!r}; {nearest(during, names)}"
            )


def _clock(document: Document, text: str) -> Clock:
    where = document.where(("start_utc",))
    try:
        start = dt.datetime.fromisoformat(text.replace(" ", "T", 1))
        if not _YEARS[0] <= start.year <= _YEARS[1]:
            raise ScenarioError(f"{where}: start_utc: the year must lie within {_YEARS[0]}..{_YEARS[1]}")
        return Clock(start)
    except ScenarioError:
        raise
    except ValueError as error:
        reason = (
            str(error) if "time zone" in str(error) else f"{text!r} is not a time like 2026-02-10T14:00:00Z"
        )
        raise ScenarioError(f"{where}: start_utc: {reason}") from None


def _site(document: Document, data: dict[str, Any]) -> Site:
    height = data.get("height", NAINITAL.height_m)
    temperature = data.get("temperature", NAINITAL.temperature_c)
    try:
        return dataclasses.replace(
            NAINITAL,
            latitude_rad=data.get("latitude", NAINITAL.latitude_rad * ARCSEC_PER_RAD) / ARCSEC_PER_RAD,
            longitude_rad=data.get("longitude", NAINITAL.longitude_rad * ARCSEC_PER_RAD) / ARCSEC_PER_RAD,
            height_m=height,
            temperature_c=temperature,
            pressure_hpa=data.get("pressure", standard_pressure_hpa(height, temperature)),
            humidity=data.get("humidity", NAINITAL.humidity),
        )
    except (ValueError, ArithmeticError) as error:
        raise ScenarioError(f"{document.where(('site',))}: site: {error}") from None


def _with_mount(document: Document, scenario: model.Scenario, data: dict[str, Any]) -> model.Scenario:
    given = {key: value / ARCSEC_PER_RAD for key, value in data.get("mount", {}).items()}
    low = given.get("declination_low", model.DECLINATION_LOW_RAD)
    high = given.get("declination_high", model.DECLINATION_HIGH_RAD)
    park = min(max(scenario.site.latitude_rad, low), high)
    horizon = data.get("site", {}).get("horizon")
    try:
        mount = limits_mount(given.get("hour_angle_limit", model.HOUR_ANGLE_LIMIT_RAD), low, high, park)
    except ValueError as error:
        raise ScenarioError(f"{document.where(('mount',))}: mount: {error}") from None
    for axis, scale in (("hour_angle", mount.ra), ("declination", mount.dec)):
        angle = scenario.start_rad.get(axis)
        if angle is not None and not scale.within(angle):
            where = document.where(("start", axis))
            raise ScenarioError(f"{where}: start.{axis}: {math.degrees(angle):g}° is beyond the soft limits")
    return dataclasses.replace(
        scenario,
        mount=mount,
        horizon_rad=scenario.horizon_rad if horizon is None else math.radians(horizon / 3600),
    )
