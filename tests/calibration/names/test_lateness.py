"""A late effort: its own delay is found beside friction and noise, and what is sound or unsure is told."""

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Response
from calibration.names.channel_delay import late_column
from calibration.names.lateness import effort_delay, is_hold
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 1000
T = PERIOD_S * np.arange(ROWS)
NONE = np.zeros((ROWS, 0))


def place(t: np.ndarray) -> np.ndarray:
    """Three tones that do not repeat within the log, m."""
    return np.asarray(sum(np.sin(2 * np.pi * f * t + p) for f, p in ((0.31, 0.0), (0.83, 1.0), (1.7, 2.0))))


def terms(t: np.ndarray) -> np.ndarray:
    """Acceleration, speed and its direction (n, 3)."""
    h = 1e-4
    v = (place(t + h) - place(t - h)) / (2 * h)
    a = (place(t + h) - 2 * place(t) + place(t - h)) / h**2
    return np.column_stack([a, v, np.sign(v)])


def late(
    delay: float | np.ndarray, noise: float = 1.0, gain: float = 1.0, rows: int = ROWS, **response: str
) -> Scene:
    """A force of 2 kg, 5 N s/m and 3 N whose column is late by `delay` s; `noise` in N."""
    t = PERIOD_S * np.arange(rows)
    true = terms(t - delay) @ np.array([2.0, 5.0, 3.0])
    seen = true + noise * np.random.default_rng(5).standard_normal(rows)
    return drive(
        place(t),
        response=Response("force", "N", gain=gain, **response),
        columns={"force": seen / gain},
        y=seen,
        base=terms(t),
        held=(t > 0.7 * t[-1]) & (t < 0.9 * t[-1]),
    )


@pytest.mark.parametrize(("delay", "within"), [(0.008, 0.01), (0.03, 0.011), (0.05, 0.002), (-0.02, 0.011)])
def test_the_delay_is_found_within_its_error(delay: float, within: float) -> None:
    f, said = effort_delay(late(delay), NONE)
    assert f is not None and said == ""
    p = f.parameters["delay"]
    assert p.value == pytest.approx(delay, abs=0.0005) and p.unit == "s"
    assert p.low is not None and p.high is not None
    assert p.low < delay < p.high and p.high - p.low < within
    assert f.note == f"the force column is {'late' if delay > 0 else 'early'} against the position"


def test_the_share_is_what_of_the_held_out_mean_square_goes() -> None:
    s = late(0.05)
    f, _ = effort_delay(s, NONE)
    rows = s.problem.test
    fit = np.linalg.lstsq(s.problem.base[~rows], s.problem.y[~rows], rcond=None)[0]
    left = np.mean((s.problem.y - s.problem.base @ fit)[rows] ** 2)
    assert f is not None and f.share == pytest.approx(1 - 1.0 / left, abs=0.02)


@pytest.mark.parametrize("delay", [0.0, 0.0015])
def test_a_delay_within_the_hold_of_the_output_is_none(delay: float) -> None:
    assert effort_delay(late(delay, noise=0.02), NONE) == (None, "")


def test_what_is_divided_or_too_short_has_none() -> None:
    assert effort_delay(late(0.03, divide_by="load"), NONE) == (None, "")
    s = late(0.03)
    assert effort_delay(s, NONE)[0] is not None
    s.problem.valid = np.arange(ROWS) < 50
    assert effort_delay(s, NONE) == (None, "")


def test_a_gain_and_what_constants_took_off_change_nothing() -> None:
    """A force whose size is known: the column has it late, what is explained has it not at all."""
    s = late(0.03, gain=-4.0)
    s.view.columns["force"] = s.view.columns["force"] - 30.0 * np.sin(5.0 * (T - 0.03)) / 4.0
    s.problem.y = -4.0 * s.view.columns["force"] - 30.0 * np.sin(5.0 * T)
    f, _ = effort_delay(s, NONE)
    assert f is not None and f.share > 0.95
    assert f.parameters["delay"].value == pytest.approx(0.03, abs=0.0005)


@pytest.mark.parametrize("other", [0.0, 0.02])
def test_a_clock_is_late_in_every_part_of_the_log(other: float) -> None:
    """Late in a half, and less or not in the other one, is no clock."""
    assert effort_delay(late(np.where(T < 5.0, 0.06, other)), NONE) == (None, "")


def test_a_delay_that_changes_next_to_nothing_is_told_as_close() -> None:
    """60 ms in a half and 30 ms in the other: no one delay puts the held-out rows right."""
    f, said = effort_delay(late(np.where(T < 5.0, 0.06, 0.03)), NONE)
    assert f is None
    what, _, took = said.partition(" ms, was close (it takes ")
    assert what.startswith("channel_delay of force, ") and took.endswith(
        " % of the held-out mean square): quicker turns and a quieter effort"
    )
    assert 30.0 < float(what.split()[3]) < 60.0 and 0.5 <= float(took.split()[0]) < 2.0


@pytest.mark.parametrize(("delay", "error", "sound"), [
    (0.005, 0.0002, True), (0.0064, 0.0002, True), (0.0068, 0.0002, False), (-0.0064, 0.0002, True),
    (-0.0068, 0.0002, False), (0.02, 0.005, True),
])  # fmt: skip
def test_a_sound_loop_shows_half_a_period_and_what_frictions_memory_adds(
    delay: float, error: float, sound: bool
) -> None:
    """0.6 periods and three standard errors."""
    assert is_hold(late_column("", delay, error), PERIOD_S) is sound


@pytest.mark.parametrize(("low", "high"), [(None, 0.006), (0.004, None)])
def test_a_delay_without_an_interval_is_no_hold(low: float | None, high: float | None) -> None:
    f = Finding("channel_delay", "S", "clock", parameters={"delay": Parameter(0.001, "s", low, high)})
    assert is_hold(f, PERIOD_S) is False
