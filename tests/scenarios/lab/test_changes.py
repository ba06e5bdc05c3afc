"""What a command line changes of a scenario, and which boards a scenario brings along."""

from pathlib import Path
from typing import Any

import pytest

from scenarios.lab import prepare as prepared
from scenarios.lab.prepare import UNDATED, Changes, chosen, language_of, load, located, prepare
from scenarios.language.document import Document, ScenarioError, parse
from scenarios.language.validate import schema

TEXT = """\
name: x
start_utc: 2026-02-10T14:00:00Z
seed: 4
plant: {file: low-preload, overrides: {axes.ra.friction.coulomb: 9.0}}
network: {name: final, nodes: {DOME: {ppm: 3.0}}}
steps:
  - power_on: {}
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "x.yaml"
    path.write_text(TEXT)
    return path


def test_nothing_is_changed_that_is_not_said(file: Path) -> None:
    before = load(file)
    assert Changes().to(before) == before


@pytest.mark.parametrize(("changes", "field", "value"), [
    ({"seed": 0}, "seed", 0), ({"speed": 2.0}, "speed", 2.0),
    ({"status_period_s": 0.5}, "status_period_s", 0.5),
])  # fmt: skip
def test_a_number_is_replaced(changes: dict[str, Any], field: str, value: float, file: Path) -> None:
    before = load(file)
    after = Changes(**changes).to(before)
    assert getattr(after, field) == value != getattr(before, field)
    assert (after.plant, after.network) == (before.plant, before.network)


def test_a_plant_and_a_network_keep_what_else_is_said_of_them(file: Path) -> None:
    before = load(file)
    after = Changes(plant="high-preload", network="lab", isolated=True).to(before)
    assert after.plant == {**before.plant, "file": "high-preload"} and "overrides" in before.plant
    assert after.network == {**before.network, "name": "lab", "isolated": True}
    assert "isolated" not in before.network


def test_an_error_names_the_scenario_or_the_command_line(file: Path) -> None:
    file.write_text(TEXT.replace("low-preload", "low-prelod"))
    with pytest.raises(ScenarioError, match=r"x\.yaml: .*low-prelod"):
        prepare(file)
    with pytest.raises(ScenarioError) as caught:
        prepare(file, Changes(plant="hihg-preload"))
    assert "hihg-preload" in str(caught.value) and "x.yaml" not in str(caught.value)


def test_a_firmware_is_set_where_it_is_asked_for(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def with_firmware(scenario: Any, name: str) -> Any:
        asked.append(name)
        return scenario

    monkeypatch.setattr(prepared, "with_firmware", with_firmware)
    prepare(file)
    prepare(file, Changes(firmware="fine"))
    assert asked == ["fine"]


def test_a_path_that_no_system_takes_is_left_to_who_reads_it() -> None:
    assert located(Path("x" * 5000)) == Path("x" * 5000)


@pytest.mark.parametrize("network", ["[1]", "3", "{boards: 3}", "{boards: [3]}", "{name: lab}"])
def test_boards_that_are_no_files_are_left_to_the_check(network: str) -> None:
    document = parse(f"name: x\nnetwork: {network}\n", Path("x.yaml"))
    assert language_of(document) is schema()
    nothing: Any = []
    assert language_of(Document(Path("x.yaml"), nothing, {})) is schema()


def test_a_board_that_is_none_is_told_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("X = 1\n")
    document = parse("name: x\nnetwork:\n  boards:\n    - mine.py\n", tmp_path / "x.yaml")
    with pytest.raises(ScenarioError, match=r"x\.yaml:4: network\.boards: .*holds 0 classes"):
        language_of(document)


def test_a_network_has_a_name_or_is_the_labs() -> None:
    """It has no date: nobody looks at the sky."""
    scenario, model = chosen()
    assert (scenario.name, scenario.network, scenario.clock) == ("lab", {"name": "lab"}, UNDATED)
    assert scenario.file == Path("lab") and scenario.steps == ()
    named, other = chosen(seed=9, plant="high-preload", network_name="serial")
    assert (named.name, named.network["name"], named.seed) == ("serial", "serial", 9)
    assert other.name != model.name


def test_a_scenario_may_be_put_on_another_network(file: Path) -> None:
    assert chosen(file)[0].network["name"] == "final"
    scenario, _ = chosen(file, seed=9)
    assert scenario.seed == 9 and scenario.file == file
    assert chosen(file, network_name="lab")[0].network["name"] == "lab"


def test_targets_and_boards_are_looked_at_before_the_plant(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    for name in ("check_targets", "check_boards"):
        told = f"{name} {{}}".format
        monkeypatch.setattr(prepared, name, lambda scenario, told=told: asked.append(told(scenario.seed)))
    prepare(file, Changes(seed=6))
    assert asked == ["check_targets 6", "check_boards 6"]
