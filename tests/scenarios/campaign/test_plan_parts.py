"""A campaign's file and its cases over inputs that are written down: keys, defaults, what is looked at."""

import hashlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from scenarios.campaign import inputs
from scenarios.campaign import plan as plans
from scenarios.campaign.inputs import Input
from scenarios.campaign.plan import Plan, load, sample
from scenarios.language.document import ScenarioError

pytest.importorskip("scipy.stats.qmc")  # takes a second


def varied(name: str, *values: int, place: str = "") -> Input:
    """An input whose share is its value."""

    def put(document: dict[str, Any], value: Any) -> None:
        document[name] = value

    return Input(name, place or name, lambda share: share, put, values, values[:1])


def made(*given: Input, **more: Any) -> Plan:
    usual: dict[str, Any] = {
        "file": Path("m.yaml"), "name": "many", "description": "", "scenario": Path("s.yaml"),
        "base": {"b": 1, "_folder": "there", "a": 2}, "shares": np.array([[0.25, 0.5]]), "way": "random",
        "metrics": ("error",), "keep": "failed", "time_s": None,
    }  # fmt: skip
    return Plan(inputs=given, **usual | more)


def test_a_case_is_known_by_its_scenario_and_where_that_is() -> None:
    """Sixteen digits of SHA-256 over its JSON, names in order."""
    (found,) = made(varied("y"), varied("x")).cases()
    text = '[{"a": 2, "b": 1, "x": 0.5, "y": 0.25}, "there"]'
    assert found.key == hashlib.sha256(text.encode()).hexdigest()[:16]
    assert found.values == {"y": 0.25, "x": 0.5} and found.document == {"a": 2, "b": 1, "x": 0.5, "y": 0.25}
    assert (found.index, found.beside, found.metrics, found.keep) == (0, "there", ("error",), "failed")


def test_a_grids_last_input_changes_fastest() -> None:
    grid = made(varied("x", 1, 2), varied("y", 5, 6, 7), way="grid", shares=np.zeros((0, 0)))
    assert [tuple(each.values.values()) for each in grid.cases()] == [
        (1, 5), (1, 6), (1, 7), (2, 5), (2, 6), (2, 7)
    ]  # fmt: skip
    assert grid.count == 6 and made(varied("x"), varied("y")).count == 1


class Desk:
    """Files that are what a test says; looked: at what is looked before anything runs."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.data: dict[str, Any] = {"name": "many", "scenario": "s.yaml", "inputs": [0, 1]}
        self.inputs = [varied("x", 1, 2), varied("y", 5, 6)]
        self.looked: list[Any] = []
        self.sampled: tuple[Any, ...] = ()
        for name, part in (
            ("located", lambda file, folder: file), ("read", self.read), ("check", lambda *_: None),
            ("load_scenario", self.look), ("prepare", self.look), ("sample", self.sample),
        ):  # fmt: skip
            monkeypatch.setattr(plans, name, part)
        monkeypatch.setattr(inputs, "read", lambda given, where, base: self.inputs[given])

    def read(self, file: Path) -> Any:
        data = self.data if file.name == "m.yaml" else {"name": "s", "seed": 4}
        return SimpleNamespace(data=data, where=lambda place: "here")

    def look(self, document: Any) -> None:
        self.looked.append(document.data)
        if document.data.get("x") == 13:
            raise ScenarioError("unlucky")

    def sample(self, *given: Any) -> Any:
        self.sampled = given
        return np.zeros((given[1], given[2]))

    def __call__(self, **more: Any) -> Plan:
        self.data |= more
        return load(Path("m.yaml"))


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_by_itself_a_campaign_is_a_hundred_runs_of_a_hypercube(desk: Desk) -> None:
    found = desk()
    assert desk.sampled == ("latin hypercube", 100, 2, 1) and found.count == 100
    assert (found.metrics, found.keep, found.time_s) == (("expectations",), "nothing", None)
    assert found.description == ""
    assert found.base == {"name": "s", "seed": 4, "_folder": str(Path.cwd())}


def test_what_is_said_is_taken(desk: Desk) -> None:
    found = desk(sample="sobol", budget={"runs": 8, "time": "2 h"}, seed=7, keep="all", metrics=["error"])
    assert desk.sampled == ("sobol", 8, 2, 7)
    assert (found.metrics, found.keep, found.time_s) == (("error",), "all", 7200.0)


def test_the_scenario_a_case_and_the_ends_of_inputs_are_looked_at(desk: Desk) -> None:
    desk(sample="random")
    plain = {"name": "s", "seed": 4}
    assert desk.looked == [plain, {**plain, "x": 0.0, "y": 0.0}, {**plain, "x": 1}, {**plain, "y": 5}]


def test_an_end_that_cannot_be_names_its_input(desk: Desk) -> None:
    desk.inputs[0] = varied("x", 13)
    with pytest.raises(ScenarioError, match=r"^m\.yaml: input 'x', value 13: unlucky$"):
        desk()


@pytest.mark.parametrize(("way", "more", "hint"), [
    ("grid", {}, "fewer values or `levels`"), ("random", {"budget": {"runs": 4}}, "a lower budget.runs"),
])  # fmt: skip
def test_a_campaign_has_a_size(
    way: str, more: dict[str, Any], hint: str, desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plans, "MOST", 4)
    found = desk(sample=way, **more)
    assert found.count == 4 and (way != "grid" or found.shares.shape == (0, 0))
    monkeypatch.setattr(plans, "MOST", 3)
    words = f"m.yaml: 4 runs are planned, one campaign has at most 3: give it {hint}, or make several"
    with pytest.raises(ScenarioError) as caught:
        desk()
    assert str(caught.value) == words


def test_names_and_places_are_each_for_one_input(desk: Desk) -> None:
    """But for faults, of which there may be several."""
    desk.inputs = [varied("x", 1, place="fault"), varied("y", 1, place="fault")]
    assert desk().count == 100
    desk.inputs = [varied("x", 1), varied("x", 1, place="z")]
    with pytest.raises(ScenarioError, match="two inputs have one name; give one a `name`"):
        desk()
    desk.inputs = [varied("x", 1, place="z"), varied("y", 1, place="z")]
    with pytest.raises(ScenarioError, match="two inputs change z, and the later one would win"):
        desk()


def test_a_hypercube_has_a_run_in_every_layer_of_every_input() -> None:
    found = sample("latin hypercube", 20, 3, 5)
    assert all(sorted(np.floor(column * 20)) == list(range(20)) for column in found.T)


@pytest.mark.parametrize("way", ["random", "latin hypercube", "sobol"])
@pytest.mark.parametrize("runs", [1, 2, 3, 4, 5, 9])
def test_samples_are_shares_and_always_the_same(way: str, runs: int) -> None:
    found = sample(way, runs, 3, 5)
    assert found.shape == (runs, 3) and ((found >= 0.0) & (found < 1.0)).all()
    assert np.array_equal(found, sample(way, runs, 3, 5))
    assert not np.array_equal(found, sample(way, runs, 3, 6))
