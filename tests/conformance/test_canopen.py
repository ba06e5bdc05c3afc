"""The CANopen part: the boards' own voice passes, and each way of being wrong is found."""

from collections.abc import Callable
from pathlib import Path

import pytest
from canopen.objectdictionary import ObjectDictionary

import boards.canopen.voice as voice
from boards.canopen.server import Server
from bus.conformance import CheckResult, Settings, board_of, run
from bus.kit import CANOPEN
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import Device
from plant.model import load
from plant.plant import Plant
from scenarios.lab.network import build
from scenarios.lab.networks import NetworkConfig
from tests.conformance.kit import run_kit

PDO = "boards.canopen.pdo"
Patch = pytest.MonkeyPatch
BOARDS = (Device.DISPLAY, Device.MOTOR_RA_A)


def found(devices: tuple[Device, ...] = BOARDS) -> list[CheckResult]:
    made = build(NetworkConfig(canopen=True), Plant(load(), 1), 1)
    with SchmidtBus(made.wire) as bus:
        settings = Settings(canopen=True, stamps_s=0.0, period_tolerance=0.002)
        results = run(bus, devices=[board_of(device) for device in devices], settings=settings)
    assert len(results) > 30 * len(devices)
    return results


def wrong() -> list[CheckResult]:
    return [result for result in found() if not result.passed]


def test_all_boards_are_what_a_master_expects() -> None:
    results = found(tuple(Device))
    assert [result for result in results if not result.passed] == []
    assert {result.check for result in results} == set(CANOPEN)


KIT = """
from bus.registry import publish
from plant.model import load
from plant.plant import Plant
from scenarios.lab.network import build
from scenarios.lab.networks import NetworkConfig
made = build(NetworkConfig(canopen=True), Plant(load(), 1), 1)
publish("kit", made.wire)
"""


@pytest.mark.slow
def test_the_kit_runs_them_with_its_option(tmp_path: Path) -> None:
    done = run_kit(KIT, tmp_path, "--can-canopen")
    assert f"{len(CANOPEN)} passed" in done.stdout, done.stdout + done.stderr


def without(patch: Patch, index: int) -> None:
    made: Callable[..., ObjectDictionary] = voice.dictionary

    def dictionary(board: object) -> ObjectDictionary:
        found = made(board)
        del found[index]
        return found

    patch.setattr(voice, "dictionary", dictionary)


def slower(patch: Patch) -> None:
    task = voice._Task
    patch.setattr(voice, "_Task", lambda v, i, data, period: task(v, i, data, period * 103 // 100))


def operational(patch: Patch) -> None:
    patch.setattr(voice.Voice, "operational", True)


def another_code(patch: Patch) -> None:
    sound = Server.abort
    patch.setattr(Server, "abort", lambda self, code=0: sound(self, code & ~0xF))


BROKEN: list[tuple[str, Callable[[Patch], None], set[str]]] = [
    ("its heartbeat is slow", slower, {"heartbeat"}),
    ("is operational always", operational, {"pre-operational", "stopped"}),
    ("has no device name", lambda p: without(p, 0x1008), {"object"}),
    ("has no error history", lambda p: without(p, 0x1003), {"object"}),
    ("knows no SYNC", lambda p: p.setattr(voice.Voice, "_sync", lambda *_: None), {"SYNC"}),
    ("takes any transmission type", lambda p: p.setattr(f"{PDO}._CYCLIC", 250), {"abort"}),
    ("another abort code", another_code, {"abort"}),
    ("saves at any word", lambda p: p.setattr(voice.Voice, "_store", lambda *_: None), {"abort"}),
    ("knows reset alone", lambda p: p.setattr(voice, "_NMT", {0x82}), {"state", "operational", "SYNC"}),
    ("deaf to reset", lambda p: p.setattr(voice, "_NMT", {1, 2, 0x80}), {"boot-up"}),
    ("all types are by event", lambda p: p.setattr(f"{PDO}._EVENT", range(256)), {"SYNC", "abort"}),
]  # fmt: skip


@pytest.mark.parametrize(("what", "change", "checks"), BROKEN, ids=[each[0] for each in BROKEN])
def test_what_is_wrong_is_found(
    what: str, change: Callable[[Patch], None], checks: set[str], monkeypatch: Patch
) -> None:
    change(monkeypatch)
    assert {result.check for result in wrong()} == checks
