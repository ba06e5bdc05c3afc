"""A line next to a stage's harmonic: one of no stage, or two, by what either leaves."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.twins import beside_a_stage
from calibration.names.lines import movable
from calibration.names.scene import Scene
from tests.calibration.names.made import drive

STAGE, SPAN = 5.0, 3.0  # cycles per m, and the travel, m: a cell is a third of a cycle per m
ROWS = 3000
X = SPAN * np.abs((np.arange(ROWS) / 600) % 2 - 1)
CELL = 1.0 / SPAN
SIDES = [(STAGE - 0.35 * CELL, STAGE - 0.05 * CELL), (STAGE + 0.05 * CELL, STAGE + 0.35 * CELL)]
OWN = {"stage": "gear", "harmonic": 1, "fixed": {}, "steps": (), "shape": None, "name": "gear_mesh"}
NOISE = 0.02 * np.random.default_rng(5).standard_normal(ROWS)
HELD = np.arange(ROWS) > 2200


def waves(**sizes: float) -> np.ndarray:
    """A wave of a size at each rate, `r5_1` is 5.1 cycles per m."""
    rates = {name: float(name[1:].replace("_", ".")) for name in sizes}
    return sum((size * np.cos(2 * np.pi * rates[n] * X + rates[n]) for n, size in sizes.items()), NOISE)


def of_stage(scene: Scene, **more: object) -> Candidate:
    """A stage's line, with lines of no stage on either side of it."""
    beside = [c for side in SIDES for c in movable(scene, sum(side) / 2, side)]
    return replace(movable(scene, STAGE, (STAGE, STAGE))[0], **{**OWN, "neighbours": tuple(beside), **more})


def looked_at(y: np.ndarray, other: float, **stage: object) -> Selection:
    """A stage's line and a free one at `other`, as chosen, looked at again."""
    scene: Scene = drive(X, y=y, base=np.ones((ROWS, 1)), held=HELD)
    lines = [of_stage(scene, **stage), movable(scene, other, (other - 0.05, other + 0.05))[0]]
    s = Selection.of(scene.problem)
    for c in lines:
        found = fit_with(s.problem, s.columns, c)
        assert found is not None
        s = s.keep([*s.chosen, found])
    return beside_a_stage(s, scene)


@pytest.mark.parametrize("true", [4.89, 5.02, 5.1])
def test_a_line_within_a_stages_cell_that_leaves_a_remainder_is_of_no_stage(true: float) -> None:
    s = looked_at(waves(**{f"r{true}".replace(".", "_"): 1.0}), 5.5)
    assert [(c.name, c.stage) for c in s.candidates] == [("bearing_pass", None)]
    order, unit = s.candidates[0].fixed["order"]
    assert (order, unit) == (pytest.approx(true, abs=0.01), "1/m")
    assert s.candidates[0].at_order == s.candidates[0].repeats == order
    assert np.hypot(*s.sizes(0)) == pytest.approx(1.0, rel=0.01)
    assert s.refused[-1].what.startswith("gear_mesh") and "bearing_pass" in s.refused[-1].what
    assert s.refused[-1].why == "a single line of no stage leaves less"


def test_the_share_that_is_told_is_what_the_line_takes_beside_the_others() -> None:
    """A wave of 1 beside one of 2 elsewhere: alone it takes all but the noise of what the other leaves."""
    y = waves(r5_1=1.0, r8_0=2.0)
    scene: Scene = drive(X, y=y, base=np.ones((ROWS, 1)), held=HELD)
    s = Selection.of(scene.problem)
    far, free = (movable(scene, rate, (rate, rate))[0] for rate in (8.0, 5.5))
    for c in (far, of_stage(scene), free):
        found = fit_with(s.problem, s.columns, c)
        assert found is not None
        s = s.keep([*s.chosen, found])
    first, found = beside_a_stage(s, scene).chosen
    assert first.candidate.order == 8.0 and found.held.share == pytest.approx(1.0, abs=0.01)
    assert found.held.before == pytest.approx(np.sqrt(0.5), rel=0.05)


@pytest.mark.parametrize(
    ("other", "stage"),
    [(5.5, {}), (5.7, {}), (5.5, {"stage": None}), (5.5, {"harmonic": None}), (5.5, {"order": None})],
)
def test_two_lines_that_are_there_stay(other: float, stage: dict[str, object]) -> None:
    s = looked_at(waves(**{"r5_0": 1.0, f"r{other}".replace(".", "_"): 0.5}), other, **stage)
    assert len(s.chosen) == 2 and s.refused == []


@pytest.mark.parametrize(("stage", "other"), [({}, 5.7), ({"harmonic": None}, 5.5), ({"stage": None}, 5.5)])
def test_lines_that_share_no_lobe_and_bundles_of_harmonics_are_left(
    stage: dict[str, object], other: float
) -> None:
    """Two cells apart, or where the pick is no single harmonic of a stage."""
    s = looked_at(waves(r5_1=1.0), other, **stage)
    assert len(s.chosen) == 2 and s.refused == []
