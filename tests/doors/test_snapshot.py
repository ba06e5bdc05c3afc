"""A snapshot of a served session: on from it goes what went on, at any instant, whatever is under way."""

import json
import socket
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from random import Random

import pytest

from bus.can.candump import CandumpWriter
from bus.protocol import COMMAND_BASE, Device, Opcode, pack_command
from bus.protocol.report import pack_report
from host.logs.files import LogError
from scenarios.doors.can import CanDoor
from scenarios.doors.clients import Client
from scenarios.doors.control import ControlDoor
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.recording import Recording
from scenarios.doors.replay import replay, replay_rest
from scenarios.doors.snapshots import Snapshots, standing
from scenarios.doors.usb import out_report
from scenarios.lab.prepare import chosen, prepare
from scenarios.lab.snapshot.file import read
from scenarios.lab.snapshot.freeze import SnapshotError
from scenarios.lab.snapshot.run import Order
from scenarios.native.finder import compiled
from scenarios.run.run import Way, run
from tests.doors.conftest import MS, Bench
from tests.doors.process import PROGRAM, ROOT, Serving
from tests.fuzz import inputs
from tests.ports import free_ports
from tests.scenarios.conftest import SHORT

pytestmark = pytest.mark.skipif(compiled(), reason="snapshots need the plain source")


def schmidt(*words: object) -> subprocess.CompletedProcess[str]:
    """The command, in a process of its own."""
    line = [sys.executable, "-c", PROGRAM, *map(str, words)]
    return subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)


def _busy(served: LiveNetwork, door: CanDoor, random: Random, slices: int) -> None:
    """Slices of odd lengths with commands, hostile frames and reports, debug bytes, supply and faults."""
    plug = served.usb.plug("pc")
    for _ in range(slices):
        served.run_until(served.now_ns + random.randrange(1, 7 * MS))
        kind = random.randrange(20)
        if kind == 0:
            plug.write(0, pack_report([pack_command(axis, Opcode.POWER, 1) for axis in (0x11, 0x12)]))
        elif kind == 1:
            plug.write(0, pack_report([pack_command(Device.AXIS_RA, Opcode.SET_CLASS, 2, 1)]))
        elif kind == 2:
            served.debug("FOCUS", b"O\rt0C184131020000000000\r"[: random.randrange(24)])
        elif kind == 3:
            served.switch("DISPLAY", random.random() < 0.7)
        elif kind == 4 and not served.faults.running:
            served.start_fault("bit_errors", probability=0.03)
        elif kind == 5 and served.faults.running:
            served.clear_fault(served.faults.running[-1].number)
        elif kind < 14:
            frame = inputs.frame(random)
            if frame.identifier & 0x780 != COMMAND_BASE:
                door._enter(frame)
        elif (report := out_report(inputs.report(random))) is not None and plug.ready:
            plug.write(0, report)


def _session(folder: Path, seed: int) -> list[Path]:
    """A recorded session with two snapshots on the way, each in the middle of things."""
    random = Random(seed)
    scenario, model = chosen()
    recording = Recording(folder / "session")
    served = LiveNetwork(scenario, model, journal=recording)
    door = CanDoor("virtual:snapshot", 0, served)
    recording.attach(served)
    Snapshots(folder / "taken", served, recording)
    assert served.snapshot is not None
    for name in ("a", "b"):
        _busy(served, door, random, random.randrange(20, 120))
        served.snapshot(name)
    _busy(served, door, random, 60)
    recording.close(served.now_ns)
    return [folder / "taken" / name for name in ("a", "b")]


@pytest.mark.parametrize(
    "seed", [1, pytest.param(2, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.slow)]
)
def test_what_entered_after_a_snapshot_gives_the_same_on_from_it(tmp_path: Path, seed: int) -> None:
    for snapshot in _session(tmp_path, seed):
        again, before = replay_rest(tmp_path / "session", snapshot)
        assert again == before is not None
    again, before = replay(tmp_path / "session", tmp_path / "again")  # and taking them has changed nothing
    assert again == before


def test_one_entry_more_after_the_snapshot_is_another_rest(tmp_path: Path) -> None:
    snapshot = _session(tmp_path, 4)[1]
    file = tmp_path / "session" / "entered.log"
    lines = file.read_text().splitlines()
    end_ns = lines[-1].split()[0]
    file.write_text("\n".join([*lines, f"{end_ns} command {b'power POSITION_RA off'.hex()}"]) + "\n")
    again, before = replay_rest(tmp_path / "session", snapshot)
    assert before not in (None, again)


def test_a_session_that_goes_on_is_recorded_and_replayed_like_any(tmp_path: Path) -> None:
    """And its log of the bus is the end of the first session's."""
    snapshot = _session(tmp_path, 5)[1]
    stood = standing(read(snapshot))
    recording = Recording(tmp_path / "on", snapshot)
    served = LiveNetwork(stood.scenario, stood.model, journal=recording, begun=stood)
    CanDoor("virtual:on", 0, served)
    recording.attach(served)
    first = (tmp_path / "session" / "entered.log").read_text().splitlines()[stood.entries :]
    for line in first:
        t_ns, kind, data = line.split()
        served.run_until(int(t_ns))
        served.entry.enter(kind, bytes.fromhex(data))
    served.run_until(json.loads((tmp_path / "session" / "session.json").read_text())["end_ns"])
    digest = recording.close(served.now_ns)
    rest = (tmp_path / "on" / "can.log").read_bytes()
    assert len(rest) > 1000
    assert (tmp_path / "session" / "can.log").read_bytes().endswith(rest)
    assert replay(tmp_path / "on", tmp_path / "again") == (digest, digest)


def test_clients_of_the_session_are_not_in_it(tmp_path: Path) -> None:
    """A door's node stays on the bus, acknowledges, and is there for the next door; nobody hears."""
    stood = standing(read(_session(tmp_path, 6)[0]))
    assert list(stood.nodes) == ["can0"]
    served = LiveNetwork(stood.scenario, stood.model, begun=stood)
    ports = len(served.network.wire.ports)
    door = CanDoor("virtual:next", 0, served)
    assert door.node is stood.nodes["can0"]
    assert len(served.network.wire.ports) == ports
    plug = served.usb.plug("pc")
    served.run_until(served.now_ns + 100 * MS)
    assert plug.reports()


def test_on_from_a_run(tmp_path: Path) -> None:
    """Where a programme has brought the telescope, others may take over."""
    (short := tmp_path / "short.yaml").write_text(SHORT)
    order = Order(1_700_000_000, tmp_path / "of-a-run")
    scenario, model = prepare(short)
    run(scenario, model, tmp_path / "run", lambda *_: None, Way(report=False, snapshot=order))
    stood = standing(read(order.file))
    served = LiveNetwork(stood.scenario, stood.model, begun=stood)
    assert served.now_ns == 1_700_000_000
    log = CandumpWriter(io := BytesIO())
    served.network.wire.tap(log.take)
    served.run_until(1_760_000_000)  # the host has sent nothing meanwhile
    log.flush()
    lines = io.getvalue()
    assert len(lines) > 1000
    assert lines in (tmp_path / "run" / "can.log").read_bytes()


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("snapshot a/b", "letters"), ("snapshot ../x", "letters"), ("snapshot .", "letters"),
        ("snapshot a b", "snapshot [NAME]"), ("snapshot " + "x" * 65, "64 at most"),
        ("snapshot twice", "take another name"),
    ],
)  # fmt: skip
def test_names_that_are_none_are_refused(bench: Bench, tmp_path: Path, line: str, answer: str) -> None:
    Snapshots(tmp_path / "taken", bench.served)
    assert ask(bench, "snapshot twice").startswith("ok")
    assert answer in ask(bench, line)
    assert [file.name for file in (tmp_path / "taken").iterdir()] == ["twice"]


def ask(bench: Bench, line: str) -> str:
    """What the control plane answers a client of this machine."""
    door = ControlDoor("7411", None, bench.served)
    ours, theirs = socket.socketpair()
    with theirs:
        client = Client(ours, "127.0.0.1")
        door._trusted.add(client)
        answer = door._answer(client, line.encode())
        client.close()
    return answer


def test_a_session_without_a_folder_says_how_it_would_have_one(bench: Bench) -> None:
    assert "--snapshots DIR" in ask(bench, "snapshot")


def test_a_disk_that_takes_nothing_is_one_line(bench: Bench, tmp_path: Path) -> None:
    Snapshots(tmp_path / "taken", bench.served)
    (tmp_path / "taken").rmdir()
    (tmp_path / "taken").write_text("a file where the folder should be")
    with pytest.raises(LogError, match="taken: cannot be made: file exists"):
        Snapshots(tmp_path / "taken", bench.served)
    answer = ask(bench, "snapshot x")
    assert answer.startswith("error: ")
    assert "cannot be written" in answer
    assert bench.all_tick()


def test_changed_bytes_are_no_snapshot(bench: Bench, tmp_path: Path) -> None:
    Snapshots(tmp_path, bench.served)
    ask(bench, "snapshot x")
    data = bytearray((tmp_path / "x").read_bytes())
    data[len(data) // 2] ^= 1
    (tmp_path / "x").write_bytes(data)
    with pytest.raises(SnapshotError, match="damaged"):
        read(tmp_path / "x")


AGAIN = """
import sys
from pathlib import Path
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.snapshots import standing
from scenarios.lab.snapshot.file import read
stood = standing(read(Path(sys.argv[1])))
served = LiveNetwork(stood.scenario, stood.model, begun=stood)
served.run_until(served.now_ns + 40_000_000)
print(len(served.network.boards), sum(board.on for board in served.network.boards.values()))
"""


def test_final_is_restored_where_nothing_was_built_before(tmp_path: Path) -> None:
    """In a process of its own: what building declares is not there while it reads."""
    scenario, model = chosen(network_name="final")
    served = LiveNetwork(scenario, model)
    served.run_until(400_000_000)
    Snapshots(tmp_path, served).take("x")
    words = [sys.executable, "-c", AGAIN, str(tmp_path / "x")]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)
    assert done.stdout.split() == ["18", "18"], done.stderr


@pytest.mark.slow
def test_the_commands(tmp_path: Path) -> None:
    """serve, control snapshot, replay --from, serve --from, replay; with a client that talks all the time."""
    with Serving(tmp_path, "--snapshots", str(tmp_path), "--record", str(tmp_path / "one")) as first:
        first.ask("power FOCUS off")
        first.wait(0.3)
        assert first.ask("snapshot x").startswith("ok")
        first.ask("power FOCUS on")
        first.ask("fault start babbler identifier=0x7FF")
        first.wait(0.8)
        assert "digest" in first.end()
    done = schmidt("run", "--from", tmp_path / "x", "--out", tmp_path / "run")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "serve --from" in done.stderr
    again = schmidt("replay", tmp_path / "one", "--from", tmp_path / "x")
    assert "as recorded" in again.stdout, again.stdout + again.stderr
    with Serving(tmp_path, "--from", str(tmp_path / "x"), "--record", str(tmp_path / "two")) as second:
        now = second.status()
        assert now["boards"]["FOCUS"] is False
        assert now["simulated_s"] >= 0.3
        second.wait(now["simulated_s"] + 0.3)
        second.end()
    again = schmidt("replay", tmp_path / "two", "--out", tmp_path / "three")
    assert "as recorded" in again.stdout, again.stdout + again.stderr


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--from", "nowhere"], "No such file"),
        (["--from", "pyproject.toml"], "no snapshot"),
        (["--from", "nowhere", "--seed", "2"], "nothing else"),
    ],
)
def test_what_cannot_be_gone_on_from_is_one_line(words: list[str], reason: str) -> None:
    done = schmidt("serve", "--control", str(free_ports()), *words)
    assert done.returncode == 2
    assert reason in done.stderr
    assert done.stderr.count("\n") == 1
