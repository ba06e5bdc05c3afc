"""A guess at a function of the place keeps its name only where the place has no more of it."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.decide.residual import Left, beside, of_one_domain
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Finding, Parameter
from tests.calibration.decide.made import line, problem

SIZE = {"amplitude": Parameter(2.0, "deg")}
RUNOUT = [
    Finding("encoder_eccentricity", "K", "axis_angle", stage="output", harmonic=h, parameters=SIZE)
    for h in (1, 2)
]
CABLE = Finding("cable_wrap", "T", "axis_angle", parameters={"stiffness": Parameter(1.0, "N m/deg")})
WEIGHT = Finding("gravity_imbalance", "T", "axis_angle", stage="axis", harmonic=1, parameters=SIZE)
SMOOTH = Finding(UNKNOWN, "T", "axis_angle")


def told(findings: list[Finding], left: Left | None = None) -> list[tuple[str, tuple[str, ...]]]:
    return [(f.name, tuple(f.equivalent)) for f in of_one_domain(findings, left)]


def test_alone_it_keeps_its_name() -> None:
    assert told(RUNOUT) == [("encoder_eccentricity", ())] * 2
    assert told([CABLE]) == [("cable_wrap", ())]


def test_beside_a_function_of_the_place_it_is_a_class_of_that() -> None:
    assert told([CABLE, SMOOTH]) == [(UNKNOWN, ("cable_wrap",)), (UNKNOWN, ())]
    assert told([*RUNOUT, SMOOTH]) == [(UNKNOWN, ("encoder_eccentricity",)), (UNKNOWN, ())]


def test_guesses_at_two_places_are_two_and_each_says_what_has_more_of_it() -> None:
    found = of_one_domain([*RUNOUT, CABLE, SMOOTH], None)
    assert [f.equivalent for f in found] == [["encoder_eccentricity"], ["cable_wrap"], ()]
    assert [f.note for f in found] == ["the place has more of it than this form"] * 2 + [""]
    (disturbed,) = of_one_domain([DISTURBED], Left(8.0, 0.4, "time", "over time alone", 0.9))
    assert disturbed.note == "time has more of it than this form"


def test_a_weight_is_no_guess() -> None:
    assert told([WEIGHT, SMOOTH]) == [("gravity_imbalance", ()), (UNKNOWN, ())]


@pytest.mark.parametrize(
    ("where", "share", "named"),
    [
        ("over the turn of output", 0.7, False),
        ("over the turn of output", 0.3, True),
        ("over the turn of output, in size", 0.7, False),
        ("over the turn of output2", 0.7, True),
        ("over time", 0.7, True),
    ],
)
def test_what_lives_over_its_own_turn_speaks_against_it(where: str, share: float, named: bool) -> None:
    left = Left(2.5, 0.4, "axis_angle", where, share)
    assert (told(RUNOUT, left)[0][0] == "encoder_eccentricity") is named


@pytest.mark.parametrize("domain", ["axis_angle", "time"])
def test_a_second_function_of_a_domain_is_what_the_first_lacks(domain: str) -> None:
    turns = 0.3 * (1 - np.cos(2 * np.pi * np.arange(2000) / 500.0))  # over 0.6 of a turn
    p = problem(np.sin(9 * turns) + 0.01 * np.random.default_rng(2).standard_normal(2000))
    harmonics = np.hstack([line(UNKNOWN, turns, h).columns for h in (1, 2, 3)])
    first = replace(line(UNKNOWN, turns, 1.0), columns=harmonics, domain="axis_angle")
    found = fit_with(p, p.base, first)
    assert found is not None
    s = Selection.of(p, [found])
    powers = np.column_stack([turns**k for k in range(1, 5)])
    second = beside(replace(first, columns=powers, domain=domain), s)
    if domain == "time":
        assert second.columns is powers
        return
    assert np.abs(s.columns[p.train].T @ second.columns[p.train]).max() < 1e-6
    both = np.hstack([s.columns, powers]), np.hstack([s.columns, second.columns])
    one, other = (x @ np.linalg.lstsq(x[p.train], p.y[p.train], rcond=None)[0] for x in both)
    assert other == pytest.approx(one, abs=1e-6)


DISTURBED = Finding("command_disturbance", "T", "time", frequency=0.35, parameters=SIZE, equivalent=["play"])


@pytest.mark.parametrize(
    ("where", "share", "named"),
    [("over time alone", 0.9, False), ("over time alone", 0.5, True), ("over time", 0.9, True)],
)
def test_a_line_in_time_is_part_of_what_time_alone_has(where: str, share: float, named: bool) -> None:
    """A wave beside a slow drift is a wave; beside quick motions of something else it is one of these."""
    first = told([DISTURBED], Left(8.0, 0.4, "time", where, share))[0]
    assert first == (
        ("command_disturbance", ("play",)) if named else (UNKNOWN, ("command_disturbance", "play"))
    )
