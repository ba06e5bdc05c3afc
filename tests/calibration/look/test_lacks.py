"""What a log of an axis lacks, and what its motion cannot tell."""

from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Finding
from calibration.inputs.run import Run
from calibration.look import lacks as lack
from calibration.look.axis import too_little
from calibration.look.lacks import COLUMNS, lacks, motion_lacks, not_identifiable
from calibration.look.torque import _of_a_gear, beside_wind
from calibration.look.volts import reading_error, volts_deny, weakened
from tests.calibration.decide import made

FAST, SLOW = 1e-3, 1e-4


def both(*sizes: float) -> np.ndarray:
    """As many rows of every speed, either way."""
    return np.concatenate([np.full(100, s * way) for s in sizes for way in (1, -1)])


def test_a_motion_has_two_speeds_in_both_directions() -> None:
    assert motion_lacks(both(FAST, SLOW)) == []
    assert motion_lacks(both(FAST)) == ["a second speed"]
    assert motion_lacks(np.abs(both(FAST, SLOW))) == ["the other direction"]
    assert motion_lacks(np.full(50, FAST)) == ["a second speed", "the other direction"]
    assert motion_lacks(np.full(50, 5e-6)) == ["a motion"] and motion_lacks(np.full(50, -6e-6)) != [
        "a motion"
    ]


def test_two_speeds_are_three_times_apart_and_one_way_has_a_fiftieth_of_the_rows() -> None:
    assert lack._one_speed(both(FAST, FAST / 2.9)) and not lack._one_speed(both(FAST, FAST / 3.1))
    assert lack._one_speed(np.zeros(9)) and lack._one_speed(np.full(9, 5e-6))
    assert lack._one_way(np.repeat([FAST, -FAST], [981, 19])) and not lack._one_way(
        np.repeat([FAST, -FAST], [98, 2])
    )


def balance(key: str, short: list[str], looked_at: int = 5) -> Any:
    return Some(key=key, short=short, selection=Some(looked_at=looked_at))


def result(rate: np.ndarray, **more: Any) -> Any:
    rows = np.arange(len(rate))
    motion = Some(
        speed=rate, rows=rows, ok=np.ones(len(rate), dtype=bool), acceleration=more.pop("acceleration", rate),
        since=more.pop("since", rate),
    )  # fmt: skip
    given = {"motion": motion, "calibrated": {}, "declared": Some(stribeck_rate=SLOW), "electrical": None}
    return Some(**{**given, **more})


def test_reasons_are_asked_in_the_order_of_the_channels() -> None:
    one = result(both(FAST))
    full = [balance("S", ["s"]), balance("T", ["t"])]
    assert lacks(one, full) == ["t", "s", "a second speed"]
    assert lacks(one, [balance("T", [])]) == []
    none = "channel T: too little sliding to tell a torque from the bristles' history"
    assert lacks(one, [balance("T", ["t"], 0)]) == [none, "t", "a second speed"]
    assert lacks(one, [balance("K", [])]) == [COLUMNS["T"], "a second speed"]


def unsure(rate: np.ndarray, **more: Any) -> list[str]:
    return not_identifiable(result(rate, **more))


def test_parameters_need_their_own_motion() -> None:
    """Speeds on Stribeck's falling branch and far beyond it, both ways; accelerations; reversals."""
    falling, sliding = both(0.5 * SLOW), both(3 * SLOW, 9 * SLOW)
    every = np.concatenate([falling, sliding])
    quick = {"acceleration": np.full(600, 3e-4), "since": np.full(600, 1e-5)}
    always = ["sigma_1", "torque_constant", "resistance"]
    assert unsure(every, **quick) == always
    assert unsure(sliding, **quick) == ["stiction", "stribeck_speed", *always]
    assert unsure(np.concatenate([falling, both(2 * SLOW)]), **quick)[:2] == ["stiction", "stribeck_speed"]
    assert unsure(both(3 * SLOW), **quick)[2] == "viscous"
    assert unsure(np.abs(every), **quick)[0] == "friction_asymmetry (one direction only)"
    assert unsure(every, **{**quick, "acceleration": np.full(600, 1.9e-4)})[0] == "inertia"
    assert unsure(every, **{**quick, "since": np.full(600, 1.1e-4)})[0] == "sigma_0"


@pytest.mark.parametrize(("error", "told"), [(0.029, True), (0.031, False)])
def test_volts_tell_a_torque_constant_to_three_hundredths(error: float, told: bool) -> None:
    electric = Some(constant_error=error, windings=Some(constant=-1.0))
    names = unsure(both(0.5 * SLOW, 3 * SLOW, 9 * SLOW), electrical=electric)
    assert ("torque_constant" in names) == (not told) and "resistance" not in names


def run(rows: int, seconds: float, travel: float = 1.0) -> Run:
    columns = {"t": np.linspace(0, seconds, rows), "position": np.linspace(0, travel, rows)}
    return Run("log", Path("log"), "a", columns, scales={"sample_period_s": 0.01})


def test_logs_that_say_nothing_say_why() -> None:
    assert too_little([run(599, 6.0)]) == "599 rows (6.0 s) are too few to say anything (at least 600)"
    assert too_little([run(600, 6.0)]) == "" == too_little([run(300, 3.0), run(300, 3.0)])
    assert too_little([run(600, 24.0)]) == ""
    lost = "75 % of the samples are missing: what is left is not a motion"
    assert too_little([run(600, 24.1)]) == lost
    assert too_little([run(600, 6.0, 0.9e-5)]) == "the axis does not move in these logs"
    assert too_little([run(600, 6.0, 1.1e-5)]) == ""


def candidate(name: str, **more: Any) -> Any:
    return made.term(name, np.ones((5, 1)), **more)


CLOCK = np.arange(100.0)


def test_what_a_motor_keeps_of_its_torque() -> None:
    size = np.array([0.2])
    assert weakened([], CLOCK)["a"].tolist() == [1.0] * 100
    one = candidate("magnet_weakening", fixed={"motor": (2.0, "")})
    kept = weakened([(one, size), (candidate("brake_drag"), size)], CLOCK, 1.5)
    assert kept["a"] == pytest.approx(np.ones(100)) and kept["b"] == pytest.approx(np.full(100, 0.7))
    all_of = weakened([(candidate("magnet_weakening"), size)], CLOCK)
    assert all_of["a"] == pytest.approx(np.full(100, 0.8))
    assert all_of["b"].tolist() == all_of["a"].tolist()
    first = weakened([(candidate("adc_gain", fixed={"motor": (1.0, "")}), size), (one, size)], CLOCK)
    assert first["a"] == pytest.approx(np.full(100, 0.8)) and first["b"] == pytest.approx(np.full(100, 0.8))


def test_a_gain_of_a_reading_is_half_known() -> None:
    assert reading_error([]) == 0.0
    chosen = [(candidate("adc_gain"), np.array([-0.2])), (candidate("brake_drag"), np.array([9.0]))]
    assert reading_error(chosen) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("name", "size", "error", "denied"),
    [
        ("magnet_weakening", 0.26, 0.01, True), ("magnet_weakening", 0.24, 0.01, False),
        ("magnet_weakening", 0.26, 0.0, False), ("adc_gain", 0.9, 0.01, False),
        ("brake_drag", 0.9, 0.01, False),
    ],
)  # fmt: skip
def test_volts_deny_a_loss_of_twenty_five_errors(name: str, size: float, error: float, denied: bool) -> None:
    told: Any = Some(constant_error=error, frame=Some(one_clock=CLOCK))
    assert volts_deny(told, candidate(name), size) == denied


def test_a_motor_s_line_at_a_gear_s_order_is_the_gear_s() -> None:
    gear = Finding("gear_mesh", "K", "axis_angle", order=100.0)
    for order, same in ((100.00005, True), (100.0002, False)):
        assert _of_a_gear(candidate("motor_cogging", order=order), [gear]) == same
    assert not _of_a_gear(candidate("gear_mesh", order=100.0), [gear])
    assert not _of_a_gear(candidate("motor_cogging"), [gear])
    others = [
        Finding("gear_mesh", "T", "axis_angle", order=100.0),
        Finding("play", "K", "reversal", order=100.0),
    ]
    assert not _of_a_gear(candidate("motor_cogging", order=100.0), others)


def test_beside_a_wind_stands_what_has_a_period_or_is_sure() -> None:
    assert beside_wind(Finding(UNKNOWN, "T", "time")) and not beside_wind(Finding(UNKNOWN, "T", "velocity"))
    assert not beside_wind(Finding("brake_drag", "T", "time", evidence=120.0))
    assert beside_wind(Finding("brake_drag", "T", "time", evidence=120.1))
