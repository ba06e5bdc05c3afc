"""The table of faults is language, schema, page and call at once."""

import dataclasses
from pathlib import Path
from typing import Any

import pytest
import yaml

from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.recording import Recording
from scenarios.doors.replay import replay
from scenarios.lab.faults.table import KINDS
from scenarios.lab.prepare import chosen
from scenarios.language.document import ScenarioError, parse
from scenarios.language.load import convert
from tests.scenarios.conftest import SHORT
from tests.scenarios.lab.faults.lab import EXAMPLES, Lab

WRONG: dict[str, Any] = {
    "node": "AXIS_RE", "nodes": ["DOME"], "sensor": "ra.speed", "axis": "x", "motor": "c", "identifier": 4096,
    "number": "much", "whole": 0.5, 
}  # fmt: skip


def test_every_fault_has_an_example() -> None:
    assert list(EXAMPLES) == [kind.name for kind in KINDS]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_fault_is_understood_in_a_scenario_and_by_a_call(kind: Any, tmp_path: Path) -> None:
    given = {
        name: f"{value:.0%}" if name == "probability" and isinstance(value, float) else value
        for name, value in EXAMPLES[kind.name].items()
    }
    text = SHORT + yaml.safe_dump({"faults": [{kind.name: given, "at": "1 s", "until": "2 s"}]})
    fault = convert(parse(text, tmp_path / "a.yaml")).faults[0]
    assert (fault.kind, fault.at_s, fault.until_s) == (kind.name, 1.0, 2.0)
    lab = Lab()
    number = lab.faults.start(kind.name, **EXAMPLES[kind.name])
    assert [each.name for each in lab.faults.running] == [kind.name]
    lab.faults.clear(number)
    assert lab.faults.running == []


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_what_cannot_be_is_refused_in_one_line_and_changes_nothing(kind: Any) -> None:
    lab = Lab()
    ports = len(lab.network.wire.ports)
    cases: list[dict[str, Any]] = [{**EXAMPLES[kind.name], "colour": 1}]
    for each in kind.parameters:
        if each.default is None:
            cases.append({key: value for key, value in EXAMPLES[kind.name].items() if key != each.name})
        cases.append({**EXAMPLES[kind.name], each.name: WRONG.get(each.type, "5 parsec")})
        if each.low is not None:
            cases.append({**EXAMPLES[kind.name], each.name: each.low - 1})
        if each.quantity or each.type == "number":
            cases += [
                {**EXAMPLES[kind.name], each.name: value} for value in (float("nan"), None, True, 1e300)
            ]
    for case in cases:
        with pytest.raises(ValueError) as caught:
            lab.faults.start(kind.name, **case)
        assert "\n" not in str(caught.value)
        assert lab.faults.running == []
    assert len(lab.network.wire.ports) == ports


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("- babler: {}", "babbler"),
        ("- wrong_bitrate: {node: DISPLAY}", "bitrate"),
        ("- sensor_scale: {sensor: ra.absolute, factor: 50}", "10"),
        ("- weak_supply: {factor: 400 %}", "150 %"),
        ("- late_interrupts: {node: DISPLAY, masked: 5 kg}", "kg"),
    ],
)
def test_a_scenario_says_what_is_wrong_with_a_fault(text: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError) as caught:
        convert(parse(SHORT + "faults:\n  " + text + "\n", tmp_path / "a.yaml"))
    assert reason in str(caught.value)
    assert "a.yaml:" in str(caught.value)


def test_clearing_what_is_not_on_says_what_is() -> None:
    lab = Lab()
    lab.faults.start("babbler")
    with pytest.raises(ValueError, match="on: 0 babbler"):
        lab.faults.clear(7)


def test_a_session_with_live_faults_replays_to_the_same_digest(tmp_path: Path) -> None:
    scenario, model = chosen()
    recording = Recording(tmp_path / "one")
    served = LiveNetwork(scenario, dataclasses.replace(model), journal=recording)
    recording.attach(served)
    served.run_until(50_000_000)
    number = served.start_fault("bit_errors", probability="30 %")
    served.run_until(150_000_000)
    served.clear_fault(number)
    served.start_fault("node_off", node="DISPLAY")
    served.run_until(300_000_000)
    digest = recording.close(served.now_ns)
    assert replay(tmp_path / "one", tmp_path / "two") == (digest, digest)
    assert served.network.wire.errors


def test_without_faults_nothing_lies_in_the_way() -> None:
    lab = Lab()
    boards = lab.network.boards
    assert boards["POSITION_RA"].endat.encoder.pin is lab.network.plant.ra.absolute
    assert boards["AXIS_RA"].port.on_receive == boards["AXIS_RA"]._receive
    assert not lab.network.wire._near
