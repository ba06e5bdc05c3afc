"""`schmidt serve --record`: what is written when, and what the digest of a rest is of."""

import hashlib
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bus.can import Frame
from bus.can.candump import CandumpWriter
from host.logs.files import LogError
from plant.kernels import layout
from scenarios.doors import recording
from scenarios.doors.recording import Recording, Rest, state_of
from scenarios.lab.networks import SERIAL
from tests.scenarios.doors.served import stub

WIDTH = max(layout.DELAYS, layout.RECORD_EVERY, layout.RECORDED) + 2


def plant(**more: Any) -> Any:
    """Two axes whose numbers all differ from nothing."""
    world = np.arange(1.0, 1.0 + 2 * WIDTH).reshape(2, WIDTH)
    return stub(world=world, focus=stub(position=lambda t_ns: 0.5 * t_ns), now_ns=7, **more)


def test_the_plants_state_is_all_but_what_is_recorded() -> None:
    made = plant()
    text = state_of(made)
    found = np.frombuffer(text[:-8]).reshape(2, WIDTH)
    recorded = np.zeros(WIDTH, dtype=bool)
    recorded[layout.TRUTH : layout.DELAYS] = True
    recorded[[layout.RECORD_EVERY, layout.RECORDED]] = True
    assert np.array_equal(found, np.where(recorded, 0.0, made.world)) and made.world.all()
    assert text[-8:] == struct.pack("<d", 3.5)


def test_the_digest_of_a_rest_is_of_its_frames_and_of_the_plant_at_its_end() -> None:
    taps: list[Any] = []
    ended: list[int] = []
    made = plant(advance=ended.append)
    rest = Rest(stub(network=stub(wire=stub(tap=taps.append), plant=made), now_ns=9))
    log = CandumpWriter(None)
    for take in (taps[0], log.take):
        take(5, Frame(0x11, b"\x11"))
    expected = hashlib.sha256(log.hexdigest().encode() + state_of(made)).hexdigest()
    assert rest.digest() == expected and ended == [9]


class Desk:
    """A recording of a served network that is a stand-in."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.told: list[str] = []
        self.failures: list[str] = []
        self.taps: list[Any] = []
        self.folder = folder / "a" / "b"
        recorder = stub(
            can=stub(take="take"), link=lambda device: stub(receive=f"to {device.name}"),
            flush=lambda: self.told.append("flush"), close=lambda: self.failures, digest=lambda: "d" * 64,
        )  # fmt: skip
        monkeypatch.setattr(recording, "Recorder", lambda *_: recorder)
        monkeypatch.setattr(recording, "log_headers", lambda *_: {})
        monkeypatch.setattr(recording, "version", lambda name: f"{name} 1")
        monkeypatch.setattr(recording, "dump", lambda model, file: file.write_text(model))
        rest = "rest from {}".format
        monkeypatch.setattr(recording, "Rest", lambda served: stub(digest=lambda: rest(served.now_ns)))
        file = folder / "night.yaml"
        file.write_text("name: night")
        self.uarts = {device.name: stub(sink=None) for device in SERIAL}
        self.served = stub(
            scenario=stub(file=file, seed=3, network={"name": "serial"}), model="the plant", now_ns=5,
            network=stub(plant="plant", wire=stub(tap=self.taps.append), uarts=self.uarts),
            entry=stub(kinds=lambda: ["usb", "can0"], count=4),
        )  # fmt: skip

    def facts(self) -> Any:
        return json.loads((self.folder / "session.json").read_text())


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(tmp_path, monkeypatch)


def test_a_session_says_what_it_is_made_of(desk: Desk) -> None:
    Recording(desk.folder).attach(desk.served)
    assert desk.taps == ["take"] and all(uart.sink == f"to {name}" for name, uart in desk.uarts.items())
    assert (desk.folder / "plant.yaml").read_text() == "the plant"
    assert (desk.folder / "scenario.yaml").read_text() == "name: night"
    assert desk.facts() == {
        "scenario": True, "seed": 3, "network": "serial", "kinds": ["usb", "can0"], "version": "schmidt 1",
        "begun": False, "snapshots": {},
    }  # fmt: skip
    text = (desk.folder / "session.json").read_text()
    assert text.startswith('{\n "') and text.endswith("}\n")


def test_without_a_file_there_is_no_scenario_to_keep(desk: Desk) -> None:
    desk.served.scenario = stub(file=Path("lab"), seed=3, network={})
    Recording(desk.folder).attach(desk.served)
    assert not (desk.folder / "scenario.yaml").exists()
    assert (desk.facts()["scenario"], desk.facts()["network"]) == (False, "lab")


def test_a_session_that_goes_on_keeps_its_snapshot(desk: Desk, tmp_path: Path) -> None:
    begun = tmp_path / "kept"
    begun.write_bytes(b"stood")
    Recording(desk.folder, begun).attach(desk.served)
    assert (desk.folder / "begun.snapshot").read_bytes() == b"stood" and desk.facts()["begun"] is True
    with pytest.raises(LogError, match=r"b: cannot be made: No such file"):
        Recording(desk.folder, tmp_path / "none")


def test_entries_are_lines_in_hexadecimal(desk: Desk) -> None:
    kept = Recording(desk.folder)
    kept.write(5, "can0", b"\x01\xff")
    kept.flush()
    assert (desk.folder / "entered.log").read_text() == "5 can0 01ff\n" and not desk.told
    kept.write(6, "usb", b"")
    assert kept.close(9) == "" and not (desk.folder / "session.json").exists()
    assert (desk.folder / "entered.log").read_text() == "5 can0 01ff\n6 usb \n"


def test_its_end_has_the_digests(desk: Desk) -> None:
    kept = Recording(desk.folder)
    kept.attach(desk.served)
    kept.mark("one", desk.served)
    assert desk.facts()["snapshots"] == {"one": {"t_ns": 5, "entries": 4}}
    kept.flush()
    assert desk.told == ["flush"]
    assert kept.close(9) == "d" * 64
    assert desk.facts()["snapshots"]["one"]["rest"] == "rest from 5"
    assert (desk.facts()["end_ns"], desk.facts()["digest"]) == (9, "d" * 64)


def test_a_disk_that_took_not_all_is_told(desk: Desk) -> None:
    kept = Recording(desk.folder)
    kept.attach(desk.served)
    desk.failures += ["can.log: full", "more"]
    with pytest.raises(LogError, match=r"^can\.log: full$"):
        kept.close(9)
    assert "digest" not in desk.facts()
