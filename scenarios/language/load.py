"""From a scenario file to a `Scenario`; everything wrong with it is found here, before anything is built."""

import dataclasses
import datetime as dt
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bus.units import ARCSEC_PER_RAD
from host.sky import pointmodel
from host.sky.mount import limits_mount
from host.sky.observed import Clock
from host.sky.site import NAINITAL, Site, standard_pressure_hpa
from plant.yamltext import nearest, read_text
from scenarios.language import model
from scenarios.language.document import Document, ScenarioError
from scenarios.language.units import parse
from scenarios.language.validate import check, schema

DEFAULT_PLANT = "low-preload-bridge"
BESIDE = ("name", "at", "until", "may_not_act")
"""What stands beside a fault's own name."""
_YEARS = (1960, 2100)
"""UTC begins in 1960 (ERFA's table of leap seconds); beyond 2100 the sun's place is nobody's plan."""
_AS_SAID = {
    "name": "name",
    "description": "description",
    "network": "network",
    "seed": "seed",
    "time_limit": "time_limit_s",
    "status": "status_period_s",
    "traces": "trace_period_s",
    "can": "can_log",
}
"""Words of a file, and of its `logs`, to fields of `Scenario`; what is not said is as the record has it."""
_STEP_FIELDS = {"at": "at_s", "after": "after", "delay": "delay_s", "when": "when", "timeout": "timeout_s"}


def convert(document: Document, language: dict[str, Any] | None = None) -> model.Scenario:
    """Check and convert a parsed document; raises `ScenarioError` with one line of what and where.

    language: the schema, when it knows more boards than the published one.
    """
    language = language or schema()
    check(document, language)
    data: dict[str, Any] = in_base_units(document.data, language)
    steps = tuple(_step(document, index, each) for index, each in enumerate(data["steps"]))
    expected = tuple(_expectation(document, index, each) for index, each in enumerate(data.get("expect", [])))
    _check_names(document, steps, expected)
    plant = data.get("plant", DEFAULT_PLANT)
    said = {**data, **data.get("logs", {})}
    scenario = model.Scenario(
        file=document.file,
        clock=_clock(document, str(data["start_utc"])),
        steps=steps,
        faults=tuple(_fault(document, index, each) for index, each in enumerate(data.get("faults", []))),
        expectations=expected,
        plant={"file": plant} if isinstance(plant, str) else plant,
        site=_site(document, data.get("site", {})),
        start_rad={axis: angle / ARCSEC_PER_RAD for axis, angle in data.get("start", {}).items()},
        speed=None if data.get("speed", "max") == "max" else float(data["speed"]),
        **{field: said[word] for word, field in _AS_SAID.items() if word in said},
    )
    return _with_mount(document, scenario, data)


def in_base_units(value: Any, rule: Mapping[str, Any]) -> Any:
    """A value with every quantity the schema marks turned into a number in its base unit."""
    if "$ref" in rule:
        rule = schema()["$defs"][str(rule["$ref"]).rsplit("/", 1)[1]]
    if "x-quantity" in rule:
        return parse(value, rule["x-quantity"])
    if rule.get("type") == "integer" and isinstance(value, float):
        return int(value)  # 5.0 is a whole number to a schema
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
    action = next(key for key in data if key not in _STEP_FIELDS and key != "name")
    arguments = data[action]
    target = arguments.get("target") or index + 1
    if isinstance(target, dict):
        target = target.get("name") or f"{target['ra']} {target['dec']}"
    return model.Step(
        name=data.get("name") or f"{action} {target}",
        action=action,
        arguments=arguments,
        where=document.where(("steps", index)),
        **{field: data[word] for word, field in _STEP_FIELDS.items() if word in data},
    )


def _fault(document: Document, index: int, data: dict[str, Any]) -> model.Fault:
    kind = next(key for key in data if key not in BESIDE)
    where = document.where(("faults", index))
    at_s, until_s = data.get("at", 0.0), data.get("until")
    if until_s is not None and until_s <= at_s:
        raise ScenarioError(f"{where}: the fault ends at {until_s:g} s, before it starts at {at_s:g} s")
    silent = data.get("may_not_act", False)
    return model.Fault(
        kind=kind, arguments=data[kind], where=where, at_s=at_s, until_s=until_s, may_not_act=silent
    )


def _expectation(document: Document, index: int, data: dict[str, Any]) -> model.Expectation:
    kind = next(key for key in data if key != "name")
    arguments = dict(data[kind])
    upper = "at_most" in arguments
    limit = float(arguments.pop("at_most" if upper else "at_least"))
    if upper and limit < 0:
        where = document.where(("expect", index, kind, "at_most"))
        raise ScenarioError(f"{where}: no figure is below zero; give 0 or more")
    words = [kind.replace("_", " "), *(str(arguments[key]) for key in ("axis", "source") if key in arguments)]
    if "during" in arguments:
        words.append(f"during {arguments['during']}")
    name = data.get("name", " ".join(words))
    return model.Expectation(
        name=name,
        kind=kind,
        arguments=arguments,
        limit=limit,
        upper=upper,
        where=document.where(("expect", index)),
    )


def _check_names(
    document: Document, steps: tuple[model.Step, ...], expected: tuple[model.Expectation, ...]
) -> None:
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
    for each in expected:
        during = each.arguments.get("during")
        if during is not None and during not in known:
            raise ScenarioError(f"{each.where}: no step is called {during!r}; {nearest(during, known)}")


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
    words = {"height": "height_m", "temperature": "temperature_c", "humidity": "humidity"}
    said = {field: data[word] for word, field in words.items() if word in data}
    said |= {f"{word}_rad": data[word] / ARCSEC_PER_RAD for word in ("latitude", "longitude") if word in data}
    try:
        site = dataclasses.replace(NAINITAL, **said)
        usual = standard_pressure_hpa(site.height_m, site.temperature_c)
        return dataclasses.replace(site, pressure_hpa=data.get("pressure", usual))
    except (ValueError, ArithmeticError) as error:
        raise ScenarioError(f"{document.where(('site',))}: site: {error}") from None


def _with_mount(document: Document, scenario: model.Scenario, data: dict[str, Any]) -> model.Scenario:
    said = data.get("mount", {})
    given = {key: value / ARCSEC_PER_RAD for key, value in said.items() if key != "pointing_model"}
    low = given.get("declination_low", model.DECLINATION_LOW_RAD)
    high = given.get("declination_high", model.DECLINATION_HIGH_RAD)
    park, where = min(max(scenario.site.latitude_rad, low), high), document.where(("mount",))
    horizon = data.get("site", {}).get("horizon")
    path, text = Path(said.get("pointing_model", "")), ""
    if "pointing_model" in said:
        path = path if path.exists() else document.file.parent / path
        try:
            text = read_text(path)
        except (OSError, ValueError) as error:
            reason = "there is no such file" if isinstance(error, FileNotFoundError) else error
            raise ScenarioError(f"{where}: mount: {path}: {reason}") from None
    try:
        mount = limits_mount(given.get("hour_angle_limit", model.HOUR_ANGLE_LIMIT_RAD), low, high, park)
        if "pointing_model" in said:
            mount = dataclasses.replace(mount, model=pointmodel.parsed(text, path))
    except ValueError as error:
        raise ScenarioError(f"{where}: mount: {error}") from None
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
