"""Scenarios and campaigns that come along, by name."""

from pathlib import Path

import pytest

from scenarios.campaign import plan
from scenarios.lab.prepare import CAMPAIGNS, SCENARIOS, load, located
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
