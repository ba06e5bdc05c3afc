"""The network as it stands before anybody commands it: where the telescope is, and what is put around it."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.lab import wiring
from scenarios.lab.chain import SWITCHES
from scenarios.language.document import ScenarioError

STEP_RAD = 2.0 * 3.141592653589793 / (1 << 29)
"""Of the absolute encoder: 29 bits a turn."""


def axis(low: int, high: int) -> Any:
    return SimpleNamespace(low_steps=low, high_steps=high, steps=lambda angle_rad: 1000.0 * angle_rad)


def scenario(**more: Any) -> Any:
    mount = SimpleNamespace(
        ra=axis(1, 2), dec=axis(3, 4), park_hour_angle_rad=0.5, park_declination_rad=0.25
    )  # fmt: skip
    usual: dict[str, Any] = {
        "mount": mount, "network": {}, "seed": 3, "file": Path("there/x.yaml"), "start_rad": {}, "faults": (),
        "site": SimpleNamespace(temperature_c=-3.0, humidity=0.75),
    }  # fmt: skip
    return SimpleNamespace(**usual | more)


def test_a_telescope_is_parked_unless_it_is_told_where_it_is() -> None:
    found = wiring.start_steps(scenario())
    assert (found["ra"], found["dec"]) == (500.0, 250.0)
    moved = wiring.start_steps(scenario(start_rad={"hour_angle": 2.0, "declination": 3.0}))
    assert (moved["ra"], moved["dec"], moved["focus"]) == (2000.0, 3000.0, found["focus"])


def test_a_focus_rests_a_few_electrical_periods_from_the_middle() -> None:
    """Eight half steps are one; by the seed it is five of them at most, to either side."""
    found = {wiring.start_steps(scenario(seed=seed))["focus"] for seed in range(200)}
    assert found == {8.0 * periods for periods in range(-5, 6)}


class Desk:
    """Parts that are only called; told: with what."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.told: dict[str, Any] = {}
        self.made = SimpleNamespace(chain=None, blowing=None)
        for name, answer in (
            ("in_the_wind", "windy"), ("with_stops", "stopped"), ("with_air", "aired"), ("Plant", "plant"),
            ("config_from", "config"), ("build", self.made), ("chained", "chain"), ("Blowing", "blowing"),
        ):  # fmt: skip
            monkeypatch.setattr(wiring, name, self.call(name, answer))

    def call(self, name: str, answer: Any) -> Any:
        def part(*given: Any) -> Any:
            self.told[name] = given
            return answer

        return part


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_a_plant_has_stops_air_and_a_chain(desk: Desk) -> None:
    model: Any = "model"
    made = wiring.powered(scenario(), model)
    limits = {"ra": (1, 2), "dec": (3, 4)}
    soft = {name: tuple(pytest.approx(each * STEP_RAD) for each in pair) for name, pair in limits.items()}
    assert desk.told["with_stops"] == ("model", soft) and desk.told["with_air"] == ("stopped", -3.0)
    assert desk.told["Plant"] == ("aired", 3, wiring.start_steps(scenario()))
    assert desk.told["config_from"] == ({}, limits, Path("there"))
    assert desk.told["build"] == ("config", "plant", 3, 0.75)
    assert desk.told["chained"] == (made, soft, SWITCHES) and made.chain == "chain"  # type: ignore[comparison-overlap]
    assert made.blowing is None and "in_the_wind" not in desk.told


def test_wind_blows_where_the_scenario_says_from_where(desk: Desk) -> None:
    model: Any = "model"
    given = {"wind_from": 206_264.806, "chain": ["x"]}
    made = wiring.powered(scenario(network=given), model)
    assert desk.told["in_the_wind"] == ("model",) and desk.told["with_stops"][0] == "windy"
    assert desk.told["Blowing"] == (made, pytest.approx(1.0)) and made.blowing == "blowing"  # type: ignore[comparison-overlap]
    assert desk.told["chained"][2] == ["x"]


def test_a_network_that_cannot_be_names_the_scenario(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any) -> None:
        raise ValueError("network: no")

    monkeypatch.setattr(wiring, "build", broken)
    model: Any = "model"
    with pytest.raises(ScenarioError, match=r"^there/x\.yaml: network: no$"):
        wiring.powered(scenario(), model)


def test_faults_come_at_their_times(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    scheduled: list[Any] = []
    faults = SimpleNamespace(schedule=scheduled.append)
    monkeypatch.setattr(wiring, "Faults", lambda made, seed: faults if seed == 3 else None)
    model: Any = "model"
    made, found = wiring.wired(scenario(faults=("one",)), model)
    other: Any = found
    assert scheduled == [("one",)] and other is faults
    assert wiring.wire(scenario(), model) is made
    monkeypatch.setattr(wiring, "chosen", lambda file, network_name: (scenario(), (file, network_name)))
    assert wiring.network(Path("x"), "lab") is made and desk.told["with_stops"][0] == (Path("x"), "lab")
