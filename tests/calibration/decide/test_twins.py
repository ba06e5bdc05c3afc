"""A line over the place and one on the clock, closer than a log at one speed tells two lines apart."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.twins import one_line
from calibration.names.scene import Scene
from tests.calibration.decide.made import PERIOD_S, line, problem, term

ROWS = 4000
T = PERIOD_S * np.arange(ROWS)
SPAN = float(T[-1])  # turns, at one turn a second
ORDER = 0.83  # cycles per turn


def clock(hertz: float) -> Candidate:
    """A line of a fixed frequency."""

    def shape(p: np.ndarray) -> np.ndarray:
        return line("", T, float(p[0])).columns

    more = {"kind": "line", "shape": shape, "steps": (0.1 / SPAN,), "fixed": {"frequency": (hertz, "Hz")}}
    return term("command_disturbance", shape(np.array([hertz])), **more)


def chosen(y: np.ndarray, *candidates: Candidate) -> Selection:
    """`candidates` fitted to `y` (n,) in noise."""
    p = problem(y + 0.2 * np.random.default_rng(1).standard_normal(ROWS))
    return Selection.of(p, [x for c in candidates if (x := fit_with(p, p.base, c)) is not None])


def scene(slip: float = 0.0) -> Scene:
    """At one turn a second, which the position leaves by `slip` turns rms."""
    return cast(Scene, cast(Any, SimpleNamespace(one_speed=(1.0, slip), turn=1.0, span=SPAN)))


GROWING = np.exp(3.0 * (T / SPAN - 1.0)) * np.cos(2 * np.pi * ORDER * T)


def names(s: Selection) -> list[str]:
    return [c.name for c in s.candidates]


@pytest.mark.parametrize(("place", "other"), [(-0.6, 0.0), (0.0, 0.6)])
def test_a_line_that_fades_in_is_one_on_the_clock_whichever_was_found_first(
    place: float, other: float
) -> None:
    s = chosen(GROWING, line("bearing_pass", T, ORDER + place / SPAN), clock(ORDER + other / SPAN))
    one = one_line(s, scene())
    assert names(one) == ["command_disturbance"]
    assert one.candidates[0].point[0] == pytest.approx(ORDER)
    assert "does not tell its line from that of command_disturbance" in one.refused[-1].why


def test_held_out_rows_may_have_the_place_rather() -> None:
    wobbling = T + 0.4 * np.sin(2 * np.pi * T / 60.0)
    s = chosen(np.cos(2 * np.pi * ORDER * wobbling), line("bearing_pass", wobbling, ORDER), clock(ORDER))
    assert names(one_line(s, scene(0.1))) == ["bearing_pass"]


@pytest.mark.parametrize(("slip", "stage", "off"), [(0.3, None, 0.6), (0.0, "motor", 0.6), (0.0, None, 1.5)])
def test_another_speed_a_declared_stage_and_a_whole_cycle_tell_two(
    slip: float, stage: str | None, off: float
) -> None:
    s = chosen(GROWING, line("bearing_pass", T, ORDER - off / SPAN, stage=stage), clock(ORDER))
    assert len(one_line(s, scene(slip)).chosen) == 2
