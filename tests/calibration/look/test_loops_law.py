"""An effort that is a loop's law: how exactly it must hold, and what a moving reference must save."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.inputs.declaration import Response
from calibration.look import loopslaw
from tests.calibration.names.made import PERIOD_S, drive

loops: Any = loopslaw
ROWS = 2000
T = PERIOD_S * np.arange(0.0, ROWS)
X = np.sin(2 * np.pi * T / 3.0) + 0.3 * np.sin(2 * np.pi * T / 0.7)
RATE = np.gradient(X, PERIOD_S)
EVEN = np.resize([1.0, -1.0], ROWS)  # noise that no law has


def commanded(
    slope: float = -4.0, left: float = 1e-3, channel: str = "effort", force: float = 1.0, **more: Any
) -> Any:
    """A law of 5 V less 4 V/m of the place, with an rms left; the declared forces leave another."""
    y = 5.0 + slope * X + 0.2 * RATE + left * EVEN
    base = (y - force * np.sign(np.sin(7 * T)))[:, None]  # leaves about so much of a force
    return drive(X, response=Response(channel, "V"), y=y, base=base, **more)


@pytest.mark.parametrize(
    ("given", "floor", "told"),
    [
        ({}, 1e-3, True),
        ({}, None, False),
        ({}, 0.0, False),
        ({}, 0.4e-3, False),  # two floors are less than what it leaves
        ({}, 0.6e-3, True),
        ({"slope": 4.0}, 1e-3, False),  # a spring
        ({"left": 0.027}, 1.0, True),  # a hundredth of the variation, 2.9
        ({"left": 0.032}, 1.0, False),
        ({"channel": "force"}, 1e-3, False),
        ({"channel": "current"}, 1e-3, True),
        ({"dynamic": False}, 1e-3, False),
        ({"force": 0.0}, 1e-3, False),  # forces say as much
    ],
)
def test_an_effort_holds_a_law_to_its_noise(given: dict[str, Any], floor: float | None, told: bool) -> None:
    s = commanded(**given)
    text = loops.law_of_its_loop(s.view, s.problem, floor)
    assert bool(text) == told
    if told:
        numbers = text.split(" is ")[1].split()
        assert float(numbers[0]) == pytest.approx(5.0, abs=0.01)
        assert float(numbers[3]) == pytest.approx(4.0, abs=0.01) and numbers[4] == "V/m"


def following(
    gain: float = 8.0, damping: float = -0.5, left: float = 1.0, channel: str = "effort", noise: float = 0.1,
    **more: Any,
) -> list[str]:  # fmt: skip
    """What is said of an effort of a gain on the reference's error, beside which forces leave so much."""
    reference = X + np.sin(2 * np.pi * T / 1.1)
    y = 1.0 + gain * (reference - X) + damping * RATE + noise * EVEN
    columns = more.pop("columns", {"reference": reference})
    held = more.pop("held", np.arange(ROWS) % 400 > 300)
    rig = more.pop("rig", {})
    s = drive(X, response=Response(channel, "V"), y=y, columns=columns, held=held, rig=rig, **more)
    found: list[str] = loops.follows(s.view, s.problem, left)
    return found


def test_an_effort_that_follows_the_reference_is_told_with_its_law() -> None:
    (text,) = following()
    assert (
        "8 V/m x (reference - position) - 0.5 V s/m x velocity leaves 0.1 V where the forces leave 1. "
        in text
    )
    assert "+ 0.5 V s/m" in following(damping=0.5)[0] and "- 0.5 V s/m" in text


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"left": 0.21}, True),  # half of it
        ({"left": 0.19}, False),
        ({"gain": -8.0}, False),
        ({"gain": 0.6, "noise": 0.01}, True),
        ({"channel": "force"}, False),
        ({"channel": "current"}, True),
        ({"columns": {}}, False),
        ({"dynamic": False}, False),
        ({"held": np.zeros(ROWS, dtype=bool)}, False),
        ({"rig": {"controller": "a law"}}, False),  # declared
    ],
)
def test_a_law_is_told_where_it_leaves_half_of_what_the_forces_leave(
    given: dict[str, Any], told: bool
) -> None:
    assert bool(following(**given)) == told


def test_files_in_turn_are_judged_once() -> None:
    s = drive(X, response=Response("effort", "V"), y=8 * np.cos(T), columns={"reference": X + np.cos(T)},
              held=np.arange(ROWS) > 1500)  # fmt: skip
    turned = replace(s.problem, turned=np.ones(ROWS, dtype=bool))
    assert bool(loops.follows(s.view, turned, 1.0))
