"""A whole served session: what breaks and comes back, what is recorded and run again, how it ends."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from random import Random

import pytest

from bus.can import Frame
from bus.protocol import COMMAND_BASE, Device, Opcode, pack_command
from bus.protocol.report import pack_report
from scenarios.doors.can import CanDoor
from scenarios.doors.door import Keeper
from scenarios.doors.livenetwork import LiveNetwork, frame_of, frame_text
from scenarios.doors.parking import park
from scenarios.doors.recording import Recording
from scenarios.doors.replay import replay
from scenarios.lab.prepare import chosen
from tests.doors.conftest import MS, Bench
from tests.fuzz import inputs

ROOT = Path(__file__).parents[2]


def record(folder: Path, seed: int = 3) -> str:
    """A session with commands over CAN and USB and hostile frames, in slices of odd lengths."""
    scenario, model = chosen()
    recording = Recording(folder)
    served = LiveNetwork(scenario, model, journal=recording)
    door = CanDoor("virtual:session", 0, served)
    recording.attach(served)
    plug = served.usb.plug("pc")
    random = Random(seed)
    for number in range(400):
        served.run_until(served.now_ns + random.randrange(1, 5 * MS))
        if number == 40:
            plug.write(0, pack_report([pack_command(axis, Opcode.POWER, 1) for axis in (0x11, 0x12)]))
        elif number == 60:
            plug.write(0, pack_report([pack_command(Device.AXIS_RA, Opcode.SET_CLASS, 2, 1)]))
        elif number % 3 == 0:
            frame = inputs.frame(random)
            if frame.identifier & 0x780 != COMMAND_BASE:
                door._enter(frame)
        if number == 300:
            served.switch("FOCUS", False)
    park(served)
    return recording.close(served.now_ns)


def test_a_recorded_session_replays_to_the_same_digest(tmp_path: Path) -> None:
    digest = record(tmp_path / "one")
    again, before = replay(tmp_path / "one", tmp_path / "two")
    assert again == before == digest
    for name in ("can.log", "axis-ra.csv", "entered.log"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_one_entry_more_is_another_digest(tmp_path: Path) -> None:
    digest = record(tmp_path / "one")
    with (tmp_path / "one" / "entered.log").open("a") as file:
        end = (tmp_path / "one" / "entered.log").read_text().splitlines()[-1].split()[0]
        file.write(f"{end} can0 {frame_text(Frame(0x0C1, b'')).encode().hex()}\n")
    again, before = replay(tmp_path / "one", tmp_path / "two")
    assert before == digest != again


@pytest.mark.parametrize(
    "line",
    [
        "nonsense",
        "5 can9 00",
        "5 usb zz",
        "x usb 00",
        "5 command FF",
        "5 can0 ",
        "5 can0 00",
        "9 usb\n5 usb",
        "5 command 78",
    ],
)
def test_a_journal_that_was_tampered_with_is_one_line(tmp_path: Path, line: str) -> None:
    record(tmp_path / "one")
    (tmp_path / "one" / "entered.log").write_text(line + "\n")
    with pytest.raises(ValueError):
        replay(tmp_path / "one", tmp_path / "two")


@pytest.mark.parametrize(
    "changed",
    [
        {"kinds": [1]}, {"kinds": {}}, {"end_ns": "soon"}, {"snapshots": [1]}, {"snapshots": {"a": {}}},
        {"network": 3}, {"seed": "1"},
    ],
)  # fmt: skip
def test_a_session_file_that_was_tampered_with_is_one_line(
    tmp_path: Path, changed: dict[str, object]
) -> None:
    LiveNetwork(*chosen())
    facts = {"scenario": False, "seed": 1, "kinds": ["usb"], "network": "lab"}
    (tmp_path / "session.json").write_text(json.dumps(facts | changed))
    with pytest.raises(ValueError, match="no recorded session"):
        replay(tmp_path, tmp_path / "two")


def test_frames_keep_their_shape_in_the_journal() -> None:
    random = Random(5)
    for _ in range(500):
        frame = inputs.frame(random)
        body = bytes(len(frame.data)) if frame.remote else frame.data  # a remote frame has a length only
        expected = Frame(frame.identifier, body, frame.extended, frame.remote)
        assert frame_of(frame_text(frame)) == expected


class Fickle:
    """A door that breaks when told to."""

    name = "fickle"

    def __init__(self) -> None:
        self.error: Exception | None = None
        self.shut = False
        self.polls = self.opens = self.closes = 0

    def open(self) -> None:
        if self.shut:
            raise OSError("no such device")
        self.opens += 1

    def poll(self, _now_ns: int) -> None:
        self.polls += 1
        if self.error is not None:
            raise self.error

    def close(self) -> None:
        self.closes += 1

    def state(self) -> str:
        return "fickle"


def test_a_door_that_breaks_is_reported_and_opened_again_while_the_others_go_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now_s = 100.0
    monkeypatch.setattr("scenarios.doors.door.monotonic", lambda: now_s)
    said: list[str] = []
    doors = [Fickle(), Fickle()]
    keepers = [Keeper(door, said.append) for door in doors]
    for keeper in keepers:
        keeper.open()
    doors[0].error, doors[0].shut = OSError("cable pulled"), True
    for _ in range(5):
        for keeper in keepers:
            keeper.poll(0)
    assert doors[0].polls == 1 and doors[1].polls == 5
    assert len(said) == 1 and "cable pulled" in said[0]
    for _ in range(3):  # still away: said once more, with the new reason, and not every second
        now_s += 1.5
        keepers[0].poll(0)
    assert len(said) == 2 and "no such device" in said[1]
    doors[0].error, doors[0].shut = None, False
    now_s += 1.5
    keepers[0].poll(0)
    keepers[0].poll(0)
    assert said[-1] == "fickle: open again" and doors[0].polls == 2


def test_a_bug_in_a_door_closes_that_door_and_says_so() -> None:
    said: list[str] = []
    door = Fickle()
    keeper = Keeper(door, said.append)
    keeper.open()
    door.error = IndexError("oops")
    keeper.poll(0)
    assert keeper.bugs == 1 and "please report" in said[0] and door.closes == 1


def test_frames_that_come_while_it_is_paused_are_kept_in_order(bench: Bench) -> None:
    import can

    with can.Bus(interface="virtual", channel="paused") as outside:
        bench.open(CanDoor("virtual:paused", 0, bench.served))
        bench.run(5)
        heard: list[int] = []
        bench.served.network.wire.tap(
            lambda _t, frame, _s: heard.append(frame.data[0]) if frame.identifier == 0x6F0 else None
        )
        for number in range(200):
            outside.send(can.Message(arbitration_id=0x6F0, is_extended_id=False, data=bytes([number])))
        for _ in range(10):  # paused: doors are looked at, time stands still
            bench.keepers[0].poll(bench.served.now_ns)
        assert heard == []
        bench.run(100)
        assert heard == list(range(200))


def queued(process: int) -> float:
    """Seconds that a process was ready to run and another one ran (Linux, Documentation/scheduler); the last
    known when it has gone or the system does not say."""
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) * 1e-9
    except (OSError, IndexError):
        return 0.0


@pytest.mark.slow
@pytest.mark.timeout(120)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_parks_flushes_and_ends(tmp_path: Path, number: signal.Signals) -> None:
    command = [sys.executable, "-c", "from scenarios.cli import main; main()", "serve", "--hid",
               f"unix:{tmp_path}/s", "--record", str(tmp_path / "rec")]  # fmt: skip
    with subprocess.Popen(
        command, cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE, text=True
    ) as server:
        deadline = time.monotonic() + 60
        while not (tmp_path / "s").exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        time.sleep(1.0)
        start, queued_s = time.monotonic(), queued(server.pid)
        before_s = queued_s
        server.send_signal(number)
        while server.poll() is None:  # it prints little: a pipe takes that unread
            queued_s = max(queued_s, queued(server.pid))
            time.sleep(0.01)
        took_s = time.monotonic() - start
        said, _ = server.communicate(timeout=60)
    assert server.returncode == 0
    words = " ".join(said.split())
    assert "the motors were off" in words and ("ticks within 1 ms" in words or "no tick yet" in words)
    others_s = queued_s - before_s
    print(f"ended within {took_s:.2f} s, {others_s:.2f} s of them the processor was with other programs")
    assert took_s - others_s < 1.0
    assert not (tmp_path / "s").exists()
    assert replay(tmp_path / "rec", tmp_path / "again")[0] == replay(tmp_path / "rec", tmp_path / "third")[0]
