"""A second mass on a spring: its transfer at resonance, and the frequencies at which a log can show it."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.declaration import Response
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from calibration.names.structural_mode import NAME, another_body, columns, lacks, rings, second_mass, to_plant
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ONE = np.zeros(60_000, dtype=np.int64)


@pytest.mark.parametrize(
    ("hertz", "damping", "dt"), [(3.0, 0.02, 0.01), (12.0, 0.05, 0.01), (1.0, 0.1, 0.05)]
)
@pytest.mark.parametrize("part", [0.5, 1.0, 1.4])
def test_a_mass_on_a_spring_answers_its_foot_by_the_textbook(
    hertz: float, damping: float, dt: float, part: float
) -> None:
    """(1 + 2 z i r) / (1 - r^2 + 2 z i r) at r times its frequency; near it exactly, elsewhere about."""
    t = dt * np.arange(20_000)
    foot = np.exp(2j * np.pi * part * hertz * t)
    got = [second_mass(x, ONE[: len(t)], dt, hertz, damping)[-4000:] for x in (foot.real, foot.imag)]
    gain = np.mean((got[0] + 1j * got[1]) / foot[-4000:])
    z = 2j * damping * part
    assert abs(gain / ((1 + z) / (1 - part**2 + z)) - 1) < (0.02 if part == 1.0 else 0.2)


def test_the_second_mass_is_at_rest_where_a_file_starts() -> None:
    foot = np.sin(0.2 * np.arange(1000))
    files = np.repeat([0, 1], 500)
    both = second_mass(np.tile(foot[:500], 2), files, PERIOD_S, 4.0, 0.02)
    assert both[:500] == pytest.approx(both[500:]) and both[0] != both[499]


def sine(hertz: float = 0.5, rows: int = 6000) -> np.ndarray:
    return np.asarray(0.1 * np.sin(2 * np.pi * hertz * PERIOD_S * np.arange(rows)))


def test_a_driven_mass_takes_what_the_second_one_is_off_its_foot() -> None:
    s = drive(sine())
    c = columns(s)[10]
    f, z = (c.fixed[k][0] for k in ("frequency", "damping"))
    a = np.pad(np.diff(s.view.x, 2), 1) / PERIOD_S**2
    assert c.columns[:, 0] == pytest.approx(second_mass(a, s.view.file, PERIOD_S, f, z) - a)
    assert z == 0.05 and c.frequency == f and c.sign == 1 and c.searched == 2
    assert c.steps == (pytest.approx(0.05 * f), 0.02)
    assert c.labels == (("inertia", "N s2/m"),)
    assert (c.fixed["frequency"][1], c.fixed["damping"][1]) == ("Hz", "1")


def test_a_mode_is_looked_for_from_half_a_period_per_move_to_half_the_filters_corner() -> None:
    """Moves of 1 s hold half a period of 0.5 Hz. A filter of a row has its corner at 1 / (2 pi row)."""
    x = sine(0.5)
    tried = [c.fixed["frequency"][0] for c in columns(drive(x))]
    top = 0.5 / (2 * np.pi * PERIOD_S)
    assert tried[0] == pytest.approx(0.5) and tried[-1] == pytest.approx(top)
    assert len(tried) == 1 + np.ceil(np.log(top / tried[0]) / 0.1)
    assert np.diff(np.log(tried)) == pytest.approx(np.log(tried[1] / tried[0]))
    wide = [c.fixed["frequency"][0] for c in columns(drive(x, rates=4.0))]
    assert wide[-1] == pytest.approx(top / 4)
    narrow = [c.fixed["frequency"][0] for c in columns(drive(x, rates=0.3))]
    assert narrow[-1] == pytest.approx(top)
    low = [c.fixed["frequency"][0] for c in columns(drive(x, rates=100.0))]
    assert (low[0], low[-1]) == pytest.approx((0.5, 1.0))


def lowest(x: np.ndarray, **more: np.ndarray) -> float:
    return float(columns(drive(x, **more))[0].fixed["frequency"][0])


def test_the_lowest_mode_is_seen_in_a_move_and_often_and_is_a_structures() -> None:
    assert lowest(sine(5.0)) == pytest.approx(5.0, rel=0.1)  # moves of 0.1 s hold half a period of 5 Hz
    assert lowest(sine(0.1)) == 0.5  # those of 5 s one of 0.1 Hz, which no structure has
    assert lowest(sine(0.5, 400)) == pytest.approx(2.0)  # eight periods in 4 s
    assert lowest(sine(0.5, 8)) == pytest.approx(40.0)  # 0.4 per row, in 0.08 s
    assert lowest(back_and_forth(strokes=120, rows=50)) == pytest.approx(1.0)  # of 0.5 s


@pytest.mark.parametrize(("begin", "hertz"), [(3, 2.0), (8, 0.625)])
def test_a_sweep_begins_with_moves_that_are_not_the_usual_ones(begin: int, hertz: float) -> None:
    """Moves of 0.8 s, for a tenth of the time or less, before those of 0.25 s."""
    slow = np.tile(sine(0.625, 160), begin)
    quick = np.tile(sine(2.0, 50), 112)
    assert lowest(np.concatenate([slow, quick])) == pytest.approx(hertz, rel=0.03)


@pytest.mark.parametrize("faded", [0.0, 0.5, -0.5])
def test_rows_that_stand_are_no_part_of_a_move(faded: float) -> None:
    """Moves of 0.25 s one way and the other, with a rest of 0.25 s after each."""
    rows = np.arange(6000)
    way = np.where(rows % 50 < 25, np.where(rows % 100 < 50, 1.0, -1.0), faded)
    assert lowest(np.cumsum(way) * PERIOD_S, direction=way) == pytest.approx(2.0)


def test_a_mode_stays_within_what_is_sampled_and_what_rings() -> None:
    s = drive(sine())
    shape = columns(s)[0].shape
    assert shape is not None
    a = np.pad(np.diff(s.view.x, 2), 1) / PERIOD_S**2
    for asked, taken in (
        ((0.01, 0.05), (0.5, 0.05)), ((99.0, 0.05), (45.0, 0.05)),
        ((5.0, 0.0), (5.0, 0.001)), ((5.0, 0.9), (5.0, 0.2)),
    ):  # fmt: skip
        expected = second_mass(a, s.view.file, PERIOD_S, *taken) - a
        assert shape(np.array(asked))[:, 0] == pytest.approx(expected)


def test_a_mode_needs_a_driven_balance_with_accelerations() -> None:
    assert not lacks(drive(sine()))
    undriven = drive(sine(), response=Response("acceleration", "m/s2"))
    for s in drive(sine(), dynamic=False), undriven:
        assert lacks(s).startswith("a balance with accelerations") and columns(s) == []


@pytest.mark.parametrize(("value", "high", "structure"), [
    (0.02, 0.03, True), (0.1, None, True), (0.11, None, False), (0.05, 0.2, False), (0.05, 0.19, True),
    (-0.05, -0.01, False), (-0.01, 0.0, True),
])  # fmt: skip
def test_a_damping_that_structures_have(value: float, high: float | None, structure: bool) -> None:
    damping = Parameter(value, "1", None, high)
    assert rings(damping) is structure
    assert NAME.beside.plausible(
        Finding("structural_mode", "T", "time", parameters={"damping": damping})
    ) is (structure)


def test_the_second_mass_is_part_of_the_plants_inertia() -> None:
    sizes = {"inertia": Parameter(30.0, "kg m2"), "frequency": Parameter(4.0, "Hz")}
    made = to_plant(Finding("structural_mode", "T", "time", parameters=sizes), Facts("a.log"))
    assert made.numbers == {"inertia": 30.0} and made.effects[0].parameters["frequency"].value == 4.0


def axis(cell_s: float) -> Scene:
    """Of two motors: the axis' acceleration, which is not sound in every row."""
    rows = np.arange(3000)
    motion = SimpleNamespace(
        ok=rows % 100 > 9, acceleration=np.sin(rows / 7.0) + 0.3 * np.cos(rows / 2.9), cell_s=cell_s
    )
    view = SimpleNamespace(file=0 * rows, period_s=PERIOD_S, rows=rows[1::3])
    parts = {"pair": SimpleNamespace(motion=motion), "view": view, "unit": "N m"}
    return cast(Scene, cast(Any, SimpleNamespace(**parts)))


def test_two_motors_move_the_whole_second_mass_and_a_row_that_is_not_sound_excites_none() -> None:
    s = axis(0.01)
    found = columns(s)
    first = found[0]
    foot = np.where(
        np.arange(3000) % 100 > 9, np.sin(np.arange(3000) / 7.0) + 0.3 * np.cos(np.arange(3000) / 2.9), 0
    )
    for asked, hertz in ((5.0, 5.0), (0.01, 0.3)):
        assert first.shape is not None
        expected = second_mass(foot, ONE[:3000], PERIOD_S, hertz, 0.02)[1::3]
        assert first.shape(np.array([asked, 0.02]))[:, 0] == pytest.approx(expected)
    assert first.labels[0][0] == "inertia" and NAME.beside.single
    hertz, damping = first.point
    assert first.steps == pytest.approx((0.01 * hertz, 0.3 * damping))


def test_an_axis_has_modes_a_width_apart_and_two_dampings_each() -> None:
    """Of 2 % damping a mode is 4 % wide: 1.8 to 14.2 Hz, and no more than 0.4 per row that is analysed."""
    points = np.array([c.point for c in columns(axis(0.01))])
    hertz = points[::2, 0]
    assert (hertz[0], hertz[-1]) == pytest.approx((1.8, 14.2)) and len(points) == 2 * len(hertz)
    assert hertz[1:] / hertz[:-1] == pytest.approx(1.045, rel=3e-4)
    low, high = points[:2, 1]
    assert 0.001 < low < 0.01 < 0.02 < high < 0.1  # either side of what structures have
    assert max(c.point[0] for c in columns(axis(0.05))) == pytest.approx(8.0, rel=0.045)
    assert all(c.point[0] < 8.0 for c in columns(axis(0.05)))


@pytest.mark.parametrize(("size_rad", "name"), [(0.05, NAME.name), (0.2, UNKNOWN)])
def test_a_second_mass_that_turns_by_degrees_is_another_body(size_rad: float, name: str) -> None:
    """At half its frequency it is a third of the motion off its foot: 0.7 or 2.7 degrees rms."""
    s = drive(size_rad * 10 * sine(0.5), unit="rad", turn=2 * np.pi)
    told = {"frequency": Parameter(1.0, "Hz"), "damping": Parameter(0.03, "1")}
    found = another_body(Finding(NAME.name, "T", "time", parameters=told, frequency=1.0), s)
    assert (found.name, bool(found.parameters)) == (name, name == NAME.name)
    linear = drive(size_rad * 10 * sine(0.5), turn=None)
    assert another_body(Finding(NAME.name, "T", "time", parameters=told), linear).name == NAME.name
