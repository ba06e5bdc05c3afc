"""A scenario with CANopen runs as the same scenario without: the host starts the network."""

from dataclasses import replace
from pathlib import Path

import pytest

from bus.protocol import Device
from plant.model import load
from scenarios.lab.session import Session
from scenarios.language.document import read
from scenarios.language.load import convert
from scenarios.run.run import run

FILE = Path(__file__).parents[3] / "scenarios" / "quick-look.yaml"


@pytest.fixture
def session(tmp_path: Path) -> Session:
    scenario = convert(read(FILE))
    scenario = replace(scenario, network={**scenario.network, "canopen": True})
    return Session(scenario, load(), tmp_path)


def test_every_step_of_a_night_is_done(session: Session) -> None:
    while not session.programme.finished and session.network.queue.now_ns < 60_000_000_000:
        session.advance(session.network.queue.now_ns + 1_000_000_000)
    assert session.programme.finished
    assert not session.programme.failed
    assert all(record.end_s is not None and not record.failed for record in session.programme.records)
    assert {voice.node.nmt.state for voice in session.network.voices.values()} == {"OPERATIONAL"}
    session.recorder.close()


@pytest.mark.slow
def test_verdicts_are_those_of_the_run_without(tmp_path: Path) -> None:
    scenario = convert(read(FILE))
    master = replace(scenario, network={**scenario.network, "canopen": True})
    plain, started = (
        run(each, load(), tmp_path / name, lambda *_: None).verdicts
        for name, each in (("plain", scenario), ("canopen", master))
    )
    assert [(v.name, v.passed) for v in started] == [(v.name, v.passed) for v in plain]
    assert all(v.passed for v in plain)


def test_a_board_that_boots_again_is_started_again(session: Session) -> None:
    session.advance(1_000_000_000)
    board = session.network.boards["MOTOR_RA_A"]
    board.power_off(1_000_000_000)
    session.advance(1_200_000_000)
    before = session.link.measured_ns[Device.MOTOR_RA_A]
    board.power_on(1_200_000_000)
    session.advance(2_500_000_000)
    assert session.network.voices["MOTOR_RA_A"].operational
    assert session.link.measured_ns[Device.MOTOR_RA_A] > before + 1_000_000_000
    session.recorder.close()
