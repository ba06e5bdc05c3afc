"""A step between two fitted runs: its onset is the whole stretch, and the held-out run does not suffer."""

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide.parameters import parameters_of
from calibration.decide.refine import never_begins, unseen
from calibration.decide.select import select

# three runs of 100 s with pauses of 20 s; the middle one is held out
CLOCK = np.concatenate([np.arange(0, 100, 0.03) + 120.0 * k for k in range(3)])
RUN = np.repeat(np.arange(3), len(CLOCK) // 3)
SIZE = 2.0


def problem(onset: float, seed: int = 1) -> Problem:
    """White noise of 0.5 about a step of SIZE at `onset`."""
    y = SIZE * (onset < CLOCK) + 0.5 * np.random.default_rng(seed).standard_normal(len(CLOCK))
    wave = np.sin(CLOCK)[:, None]
    return Problem(
        channel="T",
        unit="N m",
        y=y,
        base=wave,
        base_labels=[("wave", "N m")],
        t=CLOCK,
        run=RUN,
        session=np.zeros_like(RUN),
        valid=CLOCK >= 0,
        held=RUN == 1,
        period_s=0.03,
    )


def step(at: float) -> Candidate:
    """A step of its own time."""

    def shape(p: np.ndarray) -> np.ndarray:
        return np.asarray((p[0] < CLOCK).astype(float))[:, None]

    return Candidate(
        "brake_drag",
        "time",
        shape(np.array([at])),
        (("torque", "N m"),),
        fixed={"start": (at, "s")},
        shape=shape,
        steps=(6.0,),
    )


@pytest.mark.parametrize("onset", [110.0, 225.0])
@pytest.mark.parametrize("tried", [105.0, 150.0, 170.0, 235.0])
def test_any_onset_in_the_pause_is_told_as_the_stretch(onset: float, tried: float) -> None:
    s = select(problem(onset), [step(tried)], np.random.default_rng(0))
    assert [c.candidate.name for c in s.chosen] == ["brake_drag"]
    assert s.held.after == pytest.approx(0.5, rel=0.05)
    told = parameters_of(s, 0)["start"]
    assert told.low == pytest.approx(100.0, abs=0.5) and told.high == pytest.approx(240.0, abs=0.5)


def test_a_step_that_fitted_rows_see_has_no_stretch() -> None:
    p = problem(50.0)
    assert unseen(p, step(50.0)) is None
    s = select(p, [step(48.0)], np.random.default_rng(0))
    told = parameters_of(s, 0)["start"]
    assert told.value == pytest.approx(50.0, abs=1.0) and told.low is not None and told.high is not None
    assert told.low < 50.0 < told.high < 60.0


def test_a_step_that_came_before_the_log_is_no_change() -> None:
    """A constant that the base lacks is what such a step would take: it is not one."""
    p = problem(-50.0)
    s = select(p, [step(-20.0)], np.random.default_rng(0))
    assert s.chosen == [] and any("before the log begins" in r.why for r in s.refused)
    assert never_begins(p, step(-20.0)) and not never_begins(p, step(50.0))


def test_a_change_that_a_declared_term_makes_as_well_is_none() -> None:
    """Every run has a speed of its own: friction from the last one on is what the viscous term does there."""
    p, onset = problem(225.0), step(230.0)
    speeds = np.array([1.0, 1.02, 2.0])[RUN]
    p.add(("viscous", "N m s", speeds), ("offset", "N m", np.ones(len(CLOCK))))
    assert "declared terms" in never_begins(p, onset)
    p.held = np.zeros(len(CLOCK), dtype=bool)  # with the middle run fitted, two runs move alike as well
    assert "declared terms" in never_begins(p, onset)
    assert not never_begins(p, step(50.0))
