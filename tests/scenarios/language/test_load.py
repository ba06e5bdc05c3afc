"""From a document to a scenario: defaults, units, names, and limits at their ends."""

import math
from pathlib import Path
from typing import Any

import pytest

from scenarios.language.document import Document, ScenarioError, parse
from scenarios.language.load import convert, in_base_units
from scenarios.language.model import Scenario

BASE = "name: x\nstart_utc: {utc}\nsteps:\n  - power_on: {{}}\n"
UTC = "2026-02-10T14:00:00Z"
FILE = Path("night.yaml")


def loaded(more: str = "", utc: str = UTC, file: Path = FILE) -> Scenario:
    return convert(parse(BASE.format(utc=utc) + more, file))


def refused(more: str, utc: str = UTC, file: Path = FILE) -> str:
    with pytest.raises(ScenarioError) as caught:
        loaded(more, utc, file)
    return str(caught.value)


@pytest.mark.parametrize(("step", "name"), [
    ("wait: {for: 1 s}", "wait 2"), ("goto: {target: Pollux}", "goto Pollux"),
    ("goto: {target: {ra: '5:0:0', dec: '+40:0:0'}}", "goto 5:0:0 +40:0:0"),
    ("goto: {target: {name: mine, ra: '5:0:0', dec: '+40:0:0'}}", "goto mine"),
    ("wait: {for: 1 s}\n    name: rest", "rest"),
])  # fmt: skip
def test_a_step_is_called_by_its_target_or_number(step: str, name: str) -> None:
    assert loaded(f"  - {step}\n").steps[1].name == name


def test_words_of_a_step_are_its_conditions() -> None:
    more = "  - {wait: {for: 1 min}, at: 2 s, after: power_on 1, delay: 3 s, when: stopped, timeout: 4 s}\n"
    step = loaded(more).steps[1]
    assert (step.at_s, step.after, step.delay_s) == (2.0, "power_on 1", 3.0)
    assert (step.when, step.timeout_s, step.arguments) == ("stopped", 4.0, {"for": 60.0})
    plain = loaded().steps[0]
    assert (plain.at_s, plain.after, plain.delay_s, plain.when, plain.timeout_s) == (
        None,
        None,
        0,
        None,
        None,
    )


def test_a_name_may_come_twice_only_where_nobody_gave_it() -> None:
    goto = "  - goto: {target: Pollux}\n"
    assert [each.name for each in loaded(goto * 2).steps[1:]] == ["goto Pollux"] * 2
    again = "  - {name: power_on 1, wait: {for: 1 s}}\n"
    assert refused(again) == "night.yaml:5: there is already a step called 'power_on 1'"
    lost = "  - {wait: {for: 1 s}, after: powr_on 1}\n"
    assert "no earlier step is called 'powr_on 1'; did you mean 'power_on 1'?" in refused(lost)


def test_a_fault_lasts_from_the_start_for_ever_unless_told() -> None:
    (fault,) = loaded("faults: [{node_off: {node: DISPLAY}}]\n").faults
    assert (fault.kind, fault.at_s, fault.until_s, fault.may_not_act) == ("node_off", 0.0, None, False)
    said = "faults: [{name: n, may_not_act: true, at: 1 s, until: 2 s, node_off: {node: DISPLAY}}]\n"
    (fault,) = loaded(said).faults
    assert (fault.kind, fault.at_s, fault.until_s, fault.may_not_act) == ("node_off", 1.0, 2.0, True)
    none = "faults: [{node_off: {node: DISPLAY}, at: 2 s, until: 2 s}]\n"
    assert refused(none) == "night.yaml:5: the fault ends at 2 s, before it starts at 2 s"


def test_an_expectation_is_called_by_what_it_measures() -> None:
    expect = (
        "{pointing_error: {axis: ra, during: power_on 1, at_most: 0 arcsec}}, {bus_load: {at_least: 1 %}}"
    )
    first, second = loaded(f"expect: [{expect}]\n").expectations
    assert (first.name, first.limit, first.upper) == ("pointing error ra during power_on 1", 0.0, True)
    assert (second.name, second.limit, second.upper) == ("bus load", 0.01, False)
    assert loaded("expect: [{name: n, overruns: {at_most: 0}}]\n").expectations[0].name == "n"


@pytest.mark.parametrize(("utc", "good"), [
    ("1960-01-01T00:00:00Z", True), ("1959-12-31T23:59:59Z", False), ("2100-12-31T00:00:00Z", True),
    ("2101-01-01T00:00:00Z", False), ("2026-02-10 14:00:00Z", True), ("2026 02 10T14:00:00Z", False),
])  # fmt: skip
def test_years_of_utc(utc: str, good: bool) -> None:
    if good:
        loaded(utc=utc)
    else:
        assert "start_utc: " in (said := refused("", utc=utc))
        assert ("within 1960..2100" in said) is (utc[0:4] in ("1959", "2101"))


def test_angles_of_site_mount_and_start_are_radians() -> None:
    found = loaded(
        "site: {latitude: 30 deg, longitude: 80 deg, height: 5 m, horizon: 10 deg, pressure: 900 hPa}\n"
        "mount: {declination_low: -20 deg, declination_high: 25 deg, hour_angle_limit: 50 deg}\n"
        "start: {hour_angle: -50 deg, declination: 25 deg}\n"
    )
    site = found.site
    assert (site.latitude_rad, site.longitude_rad) == pytest.approx((math.radians(30), math.radians(80)))
    assert (site.height_m, site.pressure_hpa) == (5.0, 900.0)
    assert found.horizon_rad == pytest.approx(math.radians(10), rel=1e-12)
    assert found.start_rad == pytest.approx(
        {"hour_angle": math.radians(-50), "declination": math.radians(25)}
    )
    ra, dec = found.mount.ra, found.mount.dec
    assert ra.within(math.radians(50)) and not ra.within(math.radians(50.01))
    assert dec.within(math.radians(-20)) and not dec.within(math.radians(-20.01))
    assert not dec.within(math.radians(25.01))


@pytest.mark.parametrize(("axis", "good", "bad"), [
    ("hour_angle", 100, 100.1), ("declination", 92, 92.1), ("declination", -45, -45.1)
])  # fmt: skip
def test_a_start_beyond_the_soft_limits_is_refused(axis: str, good: float, bad: float) -> None:
    """100 degrees either side of the meridian, -45 to 92 in declination."""
    loaded(f"start: {{{axis}: {good} deg}}\n")
    said = f"night.yaml:5: start.{axis}: {bad:g}° is beyond the soft limits"
    assert refused(f"start: {{{axis}: {bad} deg}}\n") == said


@pytest.mark.parametrize(("more", "speed", "plant"), [
    ("", None, {"file": "low-preload-bridge"}), ("speed: max\n", None, {"file": "low-preload-bridge"}),
    ("speed: 2\nplant: mine\n", 2.0, {"file": "mine"}),
    ("plant: {file: mine, effects: [play]}\n", None, {"file": "mine", "effects": ["play"]}),
])  # fmt: skip
def test_speed_and_plant(more: str, speed: float | None, plant: dict[str, object]) -> None:
    found = loaded(more)
    assert (found.speed, found.plant) == (speed, plant)


def test_words_of_the_logs_are_fields() -> None:
    found = loaded("logs: {status: 1 s, traces: 2 s, can: candump}\ntime_limit: 1 h\nseed: 7\n")
    assert (found.status_period_s, found.trace_period_s, found.can_log) == (1.0, 2.0, "candump")
    assert (found.time_limit_s, found.seed) == (3600.0, 7)
    usual = loaded()
    assert (usual.status_period_s, usual.trace_period_s, usual.can_log) == (0.25, 0.01, "text")
    assert (usual.time_limit_s, usual.seed) == (43200.0, 1)


def test_a_pointing_model_is_looked_for_beside_the_scenario(tmp_path: Path) -> None:
    more, file = "mount: {pointing_model: model.txt}\n", tmp_path / "night.yaml"
    path = tmp_path / "model.txt"
    assert refused(more, file=file) == f"{file}:5: mount: {path}: there is no such file"
    path.mkdir()
    assert "no such file" not in refused(more, file=file)
    path.rmdir()
    path.write_text("nonsense")
    assert str(path) in refused(more, file=file)
    assert refused(f"mount: {{pointing_model: {path}}}\n").startswith(f"night.yaml:5: mount: {path}")


def test_a_place_is_its_line_or_that_of_what_holds_it() -> None:
    document = Document(FILE, None, {(): 3, ("a",): 7, ("a", 0, "b"): 9})
    places = {("a", 0, "b"): 9, ("a", 0): 7, ("a", 0, "c", "d"): 7, ("z",): 3, (): 3}
    assert {path: document.where(path) for path in places} == {
        path: f"night.yaml:{line}" for path, line in places.items()
    }
    assert Document(FILE, None, {}).where(("a",)) == "night.yaml:1"
    found = parse("a:\n  - 1\n  - b: 2\n\nc: 3\n", FILE).lines
    assert found == {(): 1, ("a",): 1, ("a", 0): 2, ("a", 1): 3, ("a", 1, "b"): 3, ("c",): 5}


@pytest.mark.parametrize(("text", "said"), [
    ("a: 1\nb: [\n", "night.yaml:3: is not YAML: "),
    ("a: *b\n", "night.yaml:1: not YAML: found undefined alias"),
    ("a: 1\nb: .inf\n", "night.yaml:2: inf is no number to work with"),
    ("a: 1\n? [x]\n: 2\n", "night.yaml:2: a field name must be a word"),
    ("", "night.yaml:1: the file is empty"),
    ("a: 1\nb: !!int x\n", "night.yaml:2: not YAML: "),
])  # fmt: skip
def test_text_that_is_no_document_names_its_line(text: str, said: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse(text, FILE)
    assert str(caught.value).startswith(said)


@pytest.mark.parametrize(("value", "rule", "found"), [
    ({"a": "1 min"}, {"additionalProperties": {"x-quantity": "time"}}, {"a": 60.0}),
    ({"a": "1 min", "b": "x"}, {"properties": {"a": {"x-quantity": "time"}}}, {"a": 60.0, "b": "x"}),
    (["1 h"], {"oneOf": [{"type": "string"}, {"items": {"x-quantity": "time"}}]}, [3600.0]),
    (2.5, {"type": "number"}, 2.5), ("2", {"type": "integer"}, "2"), (2.0, {"type": "integer"}, 2),
])  # fmt: skip
def test_quantities_of_a_schema_are_base_units(value: object, rule: dict[str, Any], found: object) -> None:
    assert in_base_units(value, rule) == found


def test_a_document_is_checked_first() -> None:
    assert refused("seed: -1\n").endswith("seed: -1 is out of range; it must be at least 0")
