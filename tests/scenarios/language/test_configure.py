"""Loaded into an axis board: numbers in its units, in an order that is safe, and refusals."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from plant.model import load
from scenarios.language import configure
from scenarios.language.configure import Compensation, Line, load_compensation, observer, parameters_of
from scenarios.language.document import ScenarioError, parse
from scenarios.language.load import convert
from scenarios.language.model import Scenario

WAVES = Compensation("ra", (Line(2.0, 1.5, -0.25), Line(0.5, -3.0, 4.0)), 10.25, 1.0)
MODEL = load("low_preload_bridge")
SECTION = (0.5, 0.25, 0.125, 0.0625, 3.0, -2.0)
"""Of gain 0.1875 / 0.75, a quarter; the angle's numerators are whole."""
TEXT = "name: x\nstart_utc: 2026-02-10T14:00:00Z\nsteps: [power_on: {}]\n"


def scenario_in(folder: Path, text: str = TEXT) -> Scenario:
    return convert(parse(text, folder / "night.yaml"))


def table(**changes: Any) -> dict[str, Any]:
    """A compensation file's data."""
    rows = [{"order": 3, "cosine_steps": 1, "sine_steps": -2}]
    return {"format": "schmidt-compensation 1", "axis": "dec", "lines": rows,
            "friction": {"steps": 5, "travel_arcsec": 9}} | changes  # fmt: skip


def test_a_table_is_off_while_it_is_loaded_and_unused_lines_are_nothing() -> None:
    """Numbers of bus/protocol/names.py; orders in Q16, steps in Q8; an arcsecond is 87.1 counts."""
    lines = {16: 131072, 17: 384, 18: -64, 19: 32768, 20: -768, 21: 1024} | dict.fromkeys(range(22, 40), 0)
    assert WAVES.parameters() == [(13, 0), *lines.items(), (15, 87), (14, 2624), (13, 1)]


@pytest.mark.parametrize(("travel", "counts"), [(1e-6, 1), (0.0172, 1), (0.0173, 2), (1296000.0, 112896000)])
def test_friction_turns_over_a_count_at_least(travel: float, counts: int) -> None:
    assert (15, counts) in Compensation("ra", (), 1.0, travel).parameters()


def test_a_table_that_is_wrong_is_larger_and_turned() -> None:
    """A wave a cos x + b sin x that leads by a quarter is b cos x - a sin x."""
    off = WAVES.wrong(2.0, math.pi / 2)
    assert [each.order for each in off.lines] == [2.0, 0.5]
    assert [(each.cosine, each.sine) for each in off.lines] == [
        pytest.approx((-0.5, -3.0)), pytest.approx((8.0, 6.0))
    ]  # fmt: skip
    assert (off.friction_steps, off.travel_arcsec, off.axis) == (20.5, 1.0, "ra")


@given(st.floats(-3, 3), st.floats(0.1, 3.0))
def test_turning_keeps_a_waves_size(turn: float, scale: float) -> None:
    (line,) = Compensation("ra", (Line(1.0, 3.0, 4.0),), 0.0, 1.0).wrong(scale, turn).lines
    assert math.hypot(line.cosine, line.sine) == pytest.approx(5.0 * scale)
    assert line.cosine == pytest.approx(scale * (3 * math.cos(turn) + 4 * math.sin(turn)))


def test_a_compensation_file_is_read_as_written(tmp_path: Path) -> None:
    file = tmp_path / "compensation.yaml"
    file.write_text(yaml.safe_dump(table()))
    assert load_compensation(file) == Compensation("dec", (Line(3.0, 1.0, -2.0),), 5.0, 9.0)


@pytest.mark.parametrize("data", [table(format="schmidt-compensation 2"), [1], "text", {"axis": "ra"}])
def test_another_file_is_no_compensation(tmp_path: Path, data: object) -> None:
    file = tmp_path / "compensation.yaml"
    file.write_text(yaml.safe_dump(data))
    with pytest.raises(ScenarioError) as caught:
        load_compensation(file)
    said = "is not a compensation file, 'format: schmidt-compensation 1' is missing"
    assert str(caught.value) == f"{file}: {said}"


@pytest.mark.parametrize("changes", [{"axis": "up"}, {"friction": {"steps": 1, "travel_arcsec": 0}}])
def test_a_compensation_beyond_its_bounds_is_refused(tmp_path: Path, changes: dict[str, Any]) -> None:
    file = tmp_path / "compensation.yaml"
    file.write_text(yaml.safe_dump(table(**changes)))
    with pytest.raises(ScenarioError):
        load_compensation(file)


@pytest.mark.parametrize(("name", "axis", "watches"), [
    ("paper", "ra", False), ("fine", "ra", False), ("observer", "ra", True), ("observer", "dec", False),
])  # fmt: skip
def test_parameters_of_each_firmware(
    name: str, axis: str, watches: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Duty fraction, bias in Q8, rate lock and a blend of 2^11 ticks, 10.2 s; see docs of one-arcsecond."""
    monkeypatch.setattr(configure, "bias_steps", lambda model, motor: 7)
    monkeypatch.setattr(configure, "sections", lambda model, part: ([SECTION] * 4, 0.75))
    found = dict(parameters_of(name, MODEL, axis))
    assert (found.pop(43, None) == 1) is watches
    assert sum(number >= 44 for number in found) == 25 * watches
    own = {number: value for number, value in found.items() if number < 43}
    assert own == ({} if name == "paper" else {12: 1, 40: 7 * 256, 41: 1, 42: 11})


def test_an_observer_has_its_sections_in_order_and_on_comes_last(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(configure, "sections", lambda model, part: ([SECTION] * 4, 0.75))
    found = observer(MODEL, MODEL.axes.ra)
    assert list(found) == [*range(44, 69), 43]
    effort = [round(each * 2**28) for each in SECTION[:4]]
    assert list(found.values()) == [*[*effort, 3 * 2**24, -2 * 2**24] * 4, 0.75 * 2**24, 1]


@pytest.mark.parametrize(("section", "through"), [
    ((0.5, 0.25, 0.125, 0.0625, 128.0, 0.0), 0.0), ((0.5, 0.25, 0.125, 0.0625, 0.0, -128.0), 0.0),
    (SECTION, 128.0), ((0.5, 0.25, 0.25, 0.0625, 0.0, 0.0), 0.0), ((0.0, 1.0, 0.25, 0.25, 0.0, 0.0), 0.0),
])  # fmt: skip
def test_coefficients_beyond_a_board_or_unsound_are_refused(
    section: tuple[float, ...], through: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A number of 32 bits ends below 2^31, which is 128 in Q24; a gain of two is no observer's."""
    monkeypatch.setattr(configure, "sections", lambda model, part: ([section] * 4, through))
    with pytest.raises(ScenarioError, match="firmware observer: there is none for this plant's drive"):
        observer(MODEL, MODEL.axes.ra)


def test_the_last_number_of_32_bits_is_a_coefficient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(configure, "sections", lambda model, part: ([SECTION] * 4, 128 - 2**-24))
    assert observer(MODEL, MODEL.axes.ra)[68] == 2**31 - 1


def test_a_drive_without_a_solution_has_no_observer(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise np.linalg.LinAlgError

    monkeypatch.setattr(configure, "sections", none)
    with pytest.raises(ScenarioError, match="take fine, or a softer or damped gear"):
        observer(MODEL, MODEL.axes.ra)


def test_a_firmware_comes_first_and_a_compensation_behind_it(tmp_path: Path) -> None:
    plain = scenario_in(tmp_path)
    both = configure.with_compensation(configure.with_firmware(plain, "fine"), WAVES)
    assert [each.name for each in both.steps] == ["firmware fine", "compensation", "power_on 1"]
    assert [each.where for each in both.steps[:2]] == ["command line"] * 2
    assert [each.arguments for each in both.steps[:2]] == [{"use": "fine"}, {"table": WAVES}]
    alone = configure.with_compensation(plain, WAVES)
    assert [each.action for each in alone.steps] == ["compensation", "power_on"]


def test_a_step_finds_its_file_beside_the_scenario(tmp_path: Path) -> None:
    (tmp_path / "found.yaml").write_text(yaml.safe_dump(table()))
    text = TEXT.replace("[power_on: {}]", "[firmware: {use: paper}, compensation: {file: found.yaml}]")
    first, second = configure.completed(scenario_in(tmp_path, text), MODEL).steps
    assert first.arguments == {"use": "paper", "of_axes": {"ra": {}, "dec": {}}}
    assert second.arguments["table"].axis == "dec" and second.arguments["file"] == "found.yaml"


def test_a_file_that_is_not_there_is_told_with_its_step(tmp_path: Path) -> None:
    text = TEXT.replace("[power_on: {}]", "[compensation: {file: lost.yaml}]")
    with pytest.raises(ScenarioError) as caught:
        configure.completed(scenario_in(tmp_path, text), MODEL)
    assert str(caught.value) == f"{tmp_path}/night.yaml:3: compensation: lost.yaml: no such file"


def test_a_table_of_the_command_line_needs_no_file(tmp_path: Path) -> None:
    ready = configure.with_compensation(scenario_in(tmp_path), WAVES)
    assert configure.completed(ready, MODEL) == ready
