"""Scenarios and campaigns that come along, by name."""

from pathlib import Path

import pytest

from scenarios.campaign import plan
from scenarios.lab.prepare import CAMPAIGNS, SCENARIOS, load, located, prepare
from scenarios.language.document import ScenarioError


@pytest.mark.parametrize("file", sorted(SCENARIOS.glob("*.yaml")), ids=lambda file: file.stem)
def test_every_scenario_has_its_name(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert load(Path(file.stem)).file == file
    assert located(Path(file.stem.replace("-", "_"))) == file


def test_a_campaign_has_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert plan.load(Path("what-fails-first")).file == CAMPAIGNS / "what-fails-first.yaml"


def test_what_stands_here_is_meant_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("quick-look").write_text("name: x")
    assert located(Path("quick-look")) == Path("quick-look")
    for path in (Path("quick-look.yaml"), Path("other/quick-look")):
        assert located(path) == path
    with pytest.raises(ScenarioError, match="did you mean 'frame-loss'"):
        located(Path("frame-los"))


@pytest.mark.parametrize(
    "step", ["dome: {shutter: closed}", "set_parameter: {node: DOME, parameter: 1, value: 3}"]
)
def test_a_step_for_a_board_that_is_not_there_is_refused_before_the_run(tmp_path: Path, step: str) -> None:
    file = tmp_path / "a.yaml"
    file.write_text(f"name: x\nstart_utc: 2026-02-10T14:00:00Z\nsteps:\n  - power_on: {{}}\n  - {step}\n")
    with pytest.raises(ScenarioError, match=r"a.yaml:5: the network 'lab' has no board DOME"):
        prepare(file)
