"""Stars of a scenario, and when each is taken to be reached or tracked."""

import dataclasses
from typing import Any

import pytest

from host.sky.angles import parse_declination, parse_right_ascension
from host.sky.visibility import Unreachable
from scenarios.language import model
from scenarios.language.document import ScenarioError
from scenarios.language.model import Step, check_targets, target_of
from tests.scenarios.language.desk import scenario

PLACE = {"ra": "05h 14m 32s", "dec": "-08 12 06"}
LIMIT = 20_000.0
"""mas/yr: about twice Barnard's star, the fastest there is."""


def test_a_star_is_its_coordinates_and_stands_still_unless_told() -> None:
    found = target_of(PLACE, "x:1")
    assert found.name == "05h 14m 32s -08 12 06" and (found.pm_ra_mas_yr, found.pm_dec_mas_yr) == (0.0, 0.0)
    assert found.right_ascension_rad == parse_right_ascension(PLACE["ra"])
    assert found.declination_rad == parse_declination(PLACE["dec"])


def test_a_star_may_have_a_name_and_a_motion() -> None:
    found = target_of({**PLACE, "name": "mine", "pm_ra": -LIMIT, "pm_dec": LIMIT}, "x:1")
    assert (found.name, found.pm_ra_mas_yr, found.pm_dec_mas_yr) == ("mine", -LIMIT, LIMIT)


@pytest.mark.parametrize("word", ["pm_ra", "pm_dec"])
@pytest.mark.parametrize("motion", [LIMIT + 1.0, -LIMIT - 1.0, float("nan")])
def test_no_star_is_faster(word: str, motion: float) -> None:
    with pytest.raises(ScenarioError) as caught:
        target_of({**PLACE, word: motion}, "x:1")
    assert str(caught.value) == f"x:1: target: {word}: no star moves by more than 20000 mas/yr"


class Desk:
    """Where a target is asked for: (star, at what time, for how long)."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[str, float, float]] = []
        self.steps: list[Step] = []
        self.fails = ""
        self.scenario = scenario("power_on: {}")
        monkeypatch.setattr(model, "check_reachable", self.check)

    def check(self, target: Any, _scenario: Any, t_s: float, stay_s: float) -> None:
        self.asked.append((target.name, t_s, stay_s))
        if target.name == self.fails:
            raise Unreachable(f"{target.name} is down")

    def step(self, action: str, name: str = "", **more: Any) -> None:
        arguments = {"for": more.pop("for_s")} if "for_s" in more else {}
        arguments |= {"stars": more.pop("stars")} if "stars" in more else {}
        if name:
            arguments["target"] = {**PLACE, "name": name}
        where = f"x:{len(self.steps)}"
        self.steps.append(Step(name="", action=action, arguments=arguments, where=where, **more))

    def __call__(self) -> list[tuple[str, float, float]]:
        check_targets(dataclasses.replace(self.scenario, steps=tuple(self.steps)))
        return self.asked


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_a_goto_takes_a_minute_and_a_track_what_it_says(desk: Desk) -> None:
    desk.step("wait", for_s=100.0)
    desk.step("goto", "A", delay_s=5.0)
    desk.step("track", for_s=30.0)
    desk.step("autoguide", for_s=10.0, at_s=500.0)
    desk.step("autoguide", for_s=10.0, at_s=400.0)
    desk.step("wait", for_s=5.0)
    desk.step("goto", "B")
    assert desk() == [
        ("A", 105.0, 0.0), ("A", 165.0, 30.0), ("A", 500.0, 10.0), ("A", 510.0, 10.0), ("B", 525.0, 0.0),
    ]  # fmt: skip


def test_a_park_takes_a_minute_and_a_step_beside_others_none(desk: Desk) -> None:
    desk.step("park")
    desk.step("goto", "A", after="something")
    desk.step("track", for_s=7.0)
    desk.step("goto", "B")
    assert desk() == [("B", 67.0, 0.0)]


@pytest.mark.parametrize(("stars", "minutes"), [({"stars": 3}, 3), ({}, 40)])
def test_a_pointing_run_takes_a_minute_a_star_and_ends_elsewhere(
    stars: dict[str, Any], minutes: int, desk: Desk
) -> None:
    desk.step("goto", "A")
    desk.step("pointing_run", **stars)
    desk.step("track", for_s=1.0)
    desk.step("goto", "B")
    assert desk() == [("A", 0.0, 0.0), ("B", 60.0 + 60.0 * minutes + 1.0, 0.0)]


def test_what_is_out_of_reach_is_said_of_its_goto(desk: Desk) -> None:
    desk.step("goto", "A")
    desk.step("track", for_s=1.0)
    desk.fails = "A"
    with pytest.raises(ScenarioError, match=r"^x:0: A is down$"):
        desk()


def test_times_begin_with_the_run(desk: Desk) -> None:
    desk.step("goto", "A")
    assert desk() == [("A", 0.0, 0.0)]
