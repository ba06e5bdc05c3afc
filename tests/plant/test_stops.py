"""Hard stops: an axis on its buffers against DOP853, no trace while none is reached, plant files."""

import dataclasses
from math import radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plant import model
from plant.grid import TRUTH_COLUMNS
from plant.kernels import layout as at
from plant.kernels.advance import advance, advance_axis
from plant.plant import Plant
from plant.stops import BEYOND_RAD, DAMPING, STIFFNESS, with_stops
from plant.units import ARCSEC
from tests.plant.bench import SECOND, bare
from tests.plant.independent import Floats, rates
from tests.plant.test_energy import energy

RATE = TRUTH_COLUMNS.index("rate")
ANGLE = TRUTH_COLUMNS.index("angle")
NEAR = {name: (-radians(4.0), -radians(4.0) + 0.004) for name in ("ra", "dec")}
"""Soft limits that put the high stop at 0.004 rad + 1 deg, rad."""
PUSHED = ((0.0, 0.75, 0.075), (6.0, 0.3, 0.2))
FAMILIES = ("low_preload", "low_preload_motor_units", "low_preload_bridge", "high_preload")


def recorded(
    plant: Plant, axis: str, seconds: float, manoeuvre: tuple[tuple[float, float, float], ...]
) -> Floats:
    """Truth of an axis every 10 ms."""
    rows: list[Floats] = []
    plant.record(lambda name, part: rows.append(part) if name == axis else None)
    for start_s, duty_a, duty_b in manoeuvre:
        getattr(plant, axis).drive(round(start_s * SECOND), duty_a, duty_b)
    plant.advance(round(seconds * SECOND))
    plant.record(None)
    return np.concatenate(rows)


@pytest.mark.parametrize("axis", ["ra", "dec"])
@pytest.mark.parametrize("name", FAMILIES)
def test_stops_that_are_not_reached_change_no_bit(name: str, axis: str) -> None:
    free = model.load(name)
    stopped = with_stops(free, dict.fromkeys(("ra", "dec"), (-radians(40.0), radians(40.0))))
    manoeuvre = ((0.0, 0.9, 0.09), (1.5, 0.0, 0.0), (2.0, 0.1, 0.8))
    one, two = (recorded(Plant(each, 3), axis, 4.0, manoeuvre) for each in (free, stopped))
    assert one[:, ANGLE].max() > radians(0.1), "it moves"
    assert one.tobytes() == two.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["low_preload", "low_preload_motor_units"])
def test_an_axis_driven_on_its_stop_against_an_independent_solver(name: str) -> None:
    """It arrives, is held, and leans less once its motors pull less."""
    stopped = with_stops(bare(name), NEAR)
    stops = stopped.axes.ra.stops
    assert stops is not None
    grid, solved = recorded(Plant(stopped, 1), "ra", 8.0, PUSHED)[:, RATE], rates(stopped, PUSHED, 8.0)
    top = np.abs(solved).max()
    assert np.abs(solved[500:590]).max() < 1e-3 * top, "it stands before the motors pull less"
    assert np.sqrt(np.mean((grid - solved) ** 2)) < 1e-3 * top


@pytest.mark.parametrize("axis", ["ra", "dec"])
@pytest.mark.parametrize("name", FAMILIES)
def test_a_stalled_axis_leans_on_the_buffer_with_what_its_trains_push(name: str, axis: str) -> None:
    """At rest the buffer carries the trains' torque but for the friction, which is at most the breakaway."""
    stopped = with_stops(model.load(name), NEAR)
    part = getattr(stopped.axes, axis)
    last = recorded(Plant(stopped, 1), axis, 12.0, ((0.0, 1.0, 0.0),))[-1]
    row = dict(zip(TRUTH_COLUMNS, last, strict=True))
    carried = (row["angle"] - part.stops.high.si) * part.stops.stiffness.si
    assert carried > 0.0 and abs(row["rate"]) < ARCSEC
    assert abs(carried - row["gear_torque_a"] - row["gear_torque_b"]) <= part.friction.stiction.si


@given(st.floats(600.0, 12600.0), st.floats(-0.01, 0.01))
@settings(max_examples=25, deadline=None)
def test_an_unpowered_axis_gains_nothing_from_its_stop(rate: float, before: float) -> None:
    """rate: up to 3.5 deg/s, arcsec/s. before: where it starts from the stop, rad; inside the buffer, too."""
    plant = Plant(with_stops(bare(), NEAR), 1)
    w = plant.world[0]
    high = w[at.STOP_MIDDLE] + w[at.STOP_REACH]
    w[at.ANGLE] = high - before
    w[at.RATE] = w[at.RATE_BEFORE] = rate * ARCSEC
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o + at.M_RATE] = w[o + at.M_RATE_BEFORE] = rate * ARCSEC * w[at.RATIO]
        w[o + at.M_ANGLE] = w[at.ANGLE] * w[at.RATIO]

    def held() -> float:
        return energy(w) + float(0.5 * w[at.STOP_STIFFNESS] * max(0.0, w[at.ANGLE] - high) ** 2)

    start = held()
    for k in range(1, 40):
        plant.advance(k * 25_000_000)
        assert held() <= start * 1.01 + 1e-9
        assert w[at.ANGLE] - high <= np.sqrt(2.0 * start / w[at.STOP_STIFFNESS]) * 1.01
    assert 0.5 * w[at.INERTIA] * w[at.RATE] ** 2 < 0.01 * start


@pytest.mark.parametrize("side", [1, -1])
def test_compiled_and_plain_python_meet_the_stop_alike(side: int) -> None:
    stopped = with_stops(model.load(), {"ra": (-0.1, 0.1)})
    compiled, plain = Plant(stopped, 1).world[0], Plant(stopped, 1).world[0]
    for w in (compiled, plain):
        w[at.ANGLE] = w[at.STOP_MIDDLE] + side * (w[at.STOP_REACH] - 2e-3)
        w[at.RATE] = w[at.RATE_BEFORE] = side * 0.05
        for m in range(2):
            o = at.MOTORS + m * at.MOTOR_SIZE
            w[o + at.M_ANGLE], w[o + at.M_RATE] = w[at.ANGLE] * w[at.RATIO], w[at.RATE] * w[at.RATIO]
            w[o + at.M_RATE_BEFORE] = w[o + at.M_RATE]
    advance(compiled.reshape(1, -1), 400)
    advance_axis(plain, 400)
    assert side * (compiled[at.ANGLE] - compiled[at.STOP_MIDDLE]) > 0.9 * compiled[at.STOP_REACH]
    assert side * compiled[at.RATE] < 0.01, "it was stopped"
    assert np.allclose(compiled[: at.DUTY], plain[: at.DUTY], rtol=1e-9, atol=1e-12)


def test_a_plant_file_declares_its_own_stops_and_they_stay() -> None:
    text = model.dumps(with_stops(model.load(), {"dec": (1.0, 2.0)}))
    read = model.loads(text)
    assert read.axes.ra.stops is None and "stops" not in model.dumps(model.load())
    assert read.axes.dec.stops == with_stops(model.load(), {"dec": (1.0, 2.0)}).axes.dec.stops
    again = with_stops(read, {"ra": (0.5, 1.5), "dec": (0.0, 3.0)})
    assert again.axes.dec == read.axes.dec
    assert again.axes.ra.stops is not None
    assert again.axes.ra.stops.low.si == pytest.approx(0.5 - BEYOND_RAD)
    assert model.get(again, "axes.ra.stops.stiffness").si == STIFFNESS.si
    moved = model.with_value(again, "axes.ra.stops.high", 1.25)
    row = Plant(moved, 1).world[0]
    assert row[at.STOP_MIDDLE] + row[at.STOP_REACH] == pytest.approx(1.25)


def test_stops_the_wrong_way_round_are_refused_in_one_line() -> None:
    made = with_stops(model.load(), {"ra": (1.0, 2.0)})
    with pytest.raises(model.ModelError, match=r"axes\.ra\.stops: low must lie below high"):
        model.loads(model.dumps(model.with_value(made, "axes.ra.stops.low", 3.0)))


def test_the_buffers_numbers_are_those_of_their_reasons() -> None:
    """Stiffness: J (rate / way)^2. Damping: 0.3 of critical. To two digits, as they are written."""
    stiffness = 1760.0 * (3.0 / 0.2) ** 2
    assert STIFFNESS.si == pytest.approx(stiffness, rel=0.05)
    assert DAMPING.si == pytest.approx(0.3 * 2.0 * np.sqrt(stiffness * 1760.0), rel=0.05)
    assert dataclasses.astuple(STIFFNESS)[2].startswith("ASSUMPTION")
