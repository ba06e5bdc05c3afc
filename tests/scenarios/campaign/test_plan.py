"""What a campaign plans: inputs, samples, keys, and what it refuses."""

from collections import Counter
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.stats import kstest

from scenarios.campaign.plan import Case, load
from scenarios.campaign.run_campaign import _Waiting
from scenarios.language.document import Document, ScenarioError

SCENARIO = """\
name: short
start_utc: 2026-02-10T14:00:00Z
plant: low-preload
steps:
  - power_on: {}
  - name: go
    set_rate: {axis: ra, rate: 100 arcsec/s, for: 1 s}
expect:
  - name: nothing is lost
    overruns: {at_most: 0}
"""
FRICTION = "axes.ra.friction.coulomb"


@pytest.fixture
def campaign(tmp_path: Path) -> Any:
    (tmp_path / "short.yaml").write_text(SCENARIO)

    def write(inputs: list[dict[str, Any]], **more: Any) -> Path:
        path = tmp_path / "many.yaml"
        path.write_text(yaml.safe_dump({"name": "many", "scenario": "short.yaml", "inputs": inputs, **more}))
        return path

    return write


def cases(path: Path) -> list[Case]:
    return list(load(path).cases())


def test_a_factor_is_on_the_plant_files_own_number(campaign: Any) -> None:
    from plant.model import get
    from plant.model import load as plant

    (case,) = cases(campaign([{"plant": FRICTION, "times": [1.5]}], budget={"runs": 1}))
    declared = get(plant("low_preload"), FRICTION).value
    assert case.document["plant"]["overrides"][FRICTION] == pytest.approx(1.5 * declared)
    assert case.values == {FRICTION: 1.5}


def test_every_kind_of_input_changes_its_own_place(campaign: Any) -> None:
    fault = {"node_off": {"node": "DISPLAY"}, "at": "1 s"}
    inputs = [
        {"parameter": {"node": "AXIS_RA", "number": 2}, "is": [4000]},
        {"seed": True, "is": [17]},
        {"fault": True, "is": [fault]},
        {"field": "steps.1.set_rate.rate", "is": ["50 arcsec/s"]},
    ]
    (case,) = cases(campaign(inputs, sample="grid"))
    assert case.document["network"]["nodes"]["AXIS_RA"]["parameters"] == {"2": 4000}
    assert case.document["seed"] == 17
    assert case.document["faults"] == [fault]
    assert case.document["steps"][1]["set_rate"]["rate"] == "50 arcsec/s"


def test_no_fault_is_one_of_the_faults(campaign: Any) -> None:
    (case,) = cases(campaign([{"fault": True, "is": ["none"]}], sample="grid"))
    assert "faults" not in case.document


def test_a_grid_has_every_value_with_every_other(campaign: Any) -> None:
    inputs = [{"seed": True, "is": [1, 2, 3]}, {"plant": FRICTION, "times": {"between": [0, 1], "levels": 4}}]
    found = cases(campaign(inputs, sample="grid"))
    assert len(found) == len({case.key for case in found}) == 12
    factors = sorted({case.values[FRICTION] for case in found})
    assert factors == pytest.approx([0.125, 0.375, 0.625, 0.875])


@pytest.mark.parametrize("way", ["latin hypercube", "random", "sobol"])
def test_samples_follow_their_distribution(campaign: Any, way: str) -> None:
    spread = {"distribution": "norm", "with": {"loc": 1.0, "scale": 0.1}}
    inputs = [{"plant": FRICTION, "times": spread}, {"seed": True, "is": [1, 2]}]
    found = cases(campaign(inputs, sample=way, budget={"runs": 256}))
    values = np.array([case.values[FRICTION] for case in found])
    assert kstest(values, "norm", (1.0, 0.1)).pvalue > 1e-3
    seeds = Counter(case.values["seed"] for case in found)
    assert abs(seeds[1] - 128) < 50


def test_a_latin_hypercube_has_one_run_in_every_stripe(campaign: Any) -> None:
    inputs = [{"plant": FRICTION, "times": {"between": [0.0, 1.0]}}]
    found = cases(campaign(inputs, budget={"runs": 40}))
    assert sorted(int(case.values[FRICTION] * 40) for case in found) == list(range(40))


def test_between_is_scipys_uniform_distribution(campaign: Any) -> None:
    between, uniform = (
        [case.values["x"] for case in cases(campaign([{"name": "x", "plant": FRICTION, "times": spread}]))]
        for spread in (
            {"between": [0.8, 1.2]},
            {"distribution": "uniform", "with": {"loc": 0.8, "scale": 1.2 - 0.8}},
        )
    )
    assert between == uniform


def test_a_case_alone_is_the_one_among_all(campaign: Any) -> None:
    two = [{"seed": True, "is": [1, 2, 3]}, {"plant": FRICTION, "times": {"between": [0, 1], "levels": 4}}]
    for way in ("grid", "random"):
        planned = load(campaign(two, sample=way, budget={"runs": 12}))
        assert [planned.case(k) for k in range(12)] == list(planned.cases())
    assert [case.values["seed"] for case in cases(campaign(two, sample="grid"))] == [1] * 4 + [2] * 4 + [
        3
    ] * 4


@pytest.mark.parametrize(
    ("way", "given", "words"),
    [
        ("latin hypercube", [1], "100000000 runs"),
        ("grid", {"between": [0, 1], "levels": 100_000}, "10000000000 runs"),
    ],
)
def test_more_runs_than_a_campaign_can_have_are_refused_at_once(
    campaign: Any, way: str, given: Any, words: str
) -> None:
    inputs = [{"name": str(k), "plant": FRICTION, "times": given} for k in range(2)]
    path = campaign(inputs, sample=way, budget={"runs": 100_000_000})
    with pytest.raises(ScenarioError, match="at most 1000000") as error:
        load(path)
    assert words in str(error.value)
    assert "make several" in str(error.value)


def test_keys_are_those_of_the_input_and_of_nothing_else(campaign: Any) -> None:
    inputs = [{"plant": FRICTION, "times": {"between": [0.5, 1.0]}}]
    once = [case.key for case in cases(campaign(inputs, budget={"runs": 5}))]
    again = [case.key for case in cases(campaign(inputs, budget={"runs": 5}, description="another"))]
    other = [case.key for case in cases(campaign(inputs, budget={"runs": 5}, seed=2))]
    assert once == again
    assert len({*once, *other}) == 10


def test_a_hundred_thousand_runs_are_planned_without_being_held(campaign: Any) -> None:
    import tracemalloc

    inputs = [
        {"plant": FRICTION, "times": {"between": [0.5, 1.0]}},
        {"seed": True, "is": {"between": [0, 1e6]}},
    ]
    path = campaign(inputs, budget={"runs": 100_000}, sample="random")
    load(path)
    tracemalloc.start()
    plan = load(path)
    assert plan.count == 100_000
    assert sum(1 for _ in islice(plan.cases(), 2000)) == 2000
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 50e6


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"plant": "axes.ra.friction.colomb", "times": [1]}, "coulomb"),
        ({"plant": FRICTION, "times": {"distribution": "nrm"}}, "did you mean 'norm'"),
        ({"plant": FRICTION, "times": {"distribution": "norm", "with": {"scale": -1}}}, "norm"),
        ({"plant": FRICTION, "times": {"between": [2, 1]}}, "nothing"),
        ({"seed": True, "is": {"between": [1, float("inf")], "whole": True}}, "inf is no number"),
        ({"seed": True, "is": {"distribution": "norm", "with": {"scale": float("nan")}}}, "nan is no number"),
        ({"plant": FRICTION}, "`is` or `times`"),
        ({"plant": FRICTION, "is": [200], "times": [1.0]}, "`is` or `times`"),
        (
            {"seed": True, "is": {"distribution": "beta", "with": {"loc": 0}}},
            "beta: takes loc, scale and a, b",
        ),
        ({"seed": True, "times": [2]}, "use `is`"),
        ({"field": "steps.9.wait", "is": [1]}, "no field"),
        ({"field": "steps.².wait", "is": [1]}, "no field"),
        ({"field": "steps." + "9" * 5000, "is": [1]}, "no field"),
        ({"seed": True, "is": {"between": [0, 9], "levels": 1_000_000_000}}, "at most 1000"),
        ({"weather": 1, "is": [1]}, "unknown field"),
        (
            {"parameter": {"node": "AXIS_RA", "number": 2}, "is": ["1e30"]},
            "expected a whole number, found '1e30'",
        ),
        ({"start": "hour_angle", "is": ["west"]}, "expected a number, found 'west'"),
        ({"parameter": {"node": "AXIS_XY", "number": 1}, "is": [1]}, "AXIS_XY"),
    ],
)
def test_what_cannot_be_is_one_line_with_the_place(campaign: Any, given: dict[str, Any], words: str) -> None:
    with pytest.raises(ScenarioError) as error:
        load(campaign([given]))
    assert words in str(error.value)
    assert "many.yaml" in str(error.value)
    assert "\n" not in str(error.value)


def test_runs_that_are_alike_are_made_once(campaign: Any, tmp_path: Path) -> None:
    """The journal may hold runs of another plan, too."""
    waiting = _Waiting(load(campaign([{"seed": True, "is": [5]}], budget={"runs": 3})), {"foreign"}, tmp_path)
    assert [key for key, _ in waiting] == list(waiting.keys) and len(waiting.keys) == 1
    assert waiting.alike == 2


def test_start_angles_are_an_axis_and_the_telescope_stands_there(campaign: Any) -> None:
    from scenarios.lab.wiring import start_steps
    from scenarios.language.load import convert

    path = campaign([{"start": "hour_angle", "is": [-30, 0, 30]}], sample="grid")
    starts = [start_steps(convert(Document(path, case.document, {})))["ra"] for case in cases(path)]
    turn = 1 << 29
    assert starts[2] - starts[0] == pytest.approx(turn * 60 / 360, abs=1)
    with pytest.raises(ScenarioError, match="beyond the soft limits"):
        load(campaign([{"start": "declination", "is": [-80]}], sample="grid"))


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        ([{"plant": FRICTION, "times": {"between": [-1, 1]}}], rf"value -0.998.*{FRICTION}"),
        ([{"seed": True, "is": [1, 1.5]}], "expected a whole number, found 1.5"),
        (
            [{"plant": FRICTION, "times": [1, 2]}, {"plant": FRICTION, "is": [3], "name": "b"}],
            "the later one",
        ),
    ],
)
def test_what_no_run_could_use_is_refused_before_the_first_run(
    campaign: Any, inputs: list[dict[str, Any]], says: str
) -> None:
    with pytest.raises(ScenarioError, match=says):
        load(campaign(inputs))


def test_a_plant_beside_the_scenario_is_found_from_another_folder(campaign: Any, tmp_path: Path) -> None:
    from plant.model import FILES

    own = (FILES / "low_preload.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(own, encoding="utf-8")
    (tmp_path / "short.yaml").write_text(SCENARIO.replace("plant: low-preload", "plant: mine.yaml"))
    path = campaign([{"seed": True, "is": [1, 2]}], sample="grid")
    (tmp_path / "elsewhere").mkdir()
    moved = tmp_path / "elsewhere" / path.name
    moved.write_text(path.read_text().replace("short.yaml", "../short.yaml"))
    assert {case.values["seed"] for case in cases(moved)} == {1, 2}
