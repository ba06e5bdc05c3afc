"""`schmidt serve --clock steps`: hosts in other processes and languages are part of a run that repeats."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bus.can import Frame
from scenarios.doors.control import ControlDoor
from scenarios.doors.making import check
from scenarios.doors.options import ServeOptions
from scenarios.doors.stepped import Stepped
from scenarios.doors.steps import Steps
from tests.docs.guides import write_files
from tests.doors.conftest import Bench
from tests.doors.process import ROOT, Serving
from tests.ports import free_ports

STEPS = 1000
BUSY = "while True: pass"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The guide's programs, compiled."""
    where = tmp_path_factory.mktemp("hosts")
    assert write_files("stepped-host.md", where) == ["host.c", "log.py"]
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    subprocess.run(["cc", "-Wall", "-Wextra", "-Werror", "-o", "host", "host.c"], cwd=where, check=True)
    return where


def digest(folder: Path, out: Path, *pauses: str, target: int = 20000, load: bool = False) -> str:
    """One run of the C host beside the Python host; what they printed, and the digest."""
    out.mkdir()
    line = free_ports(5)
    environment = os.environ | {"PYTHONPATH": str(ROOT), "JOIN": "join 2 axis"}
    environment.pop("SCHMIDT_PURE", None)  # the page's host imports bus first: it is plain, whatever serves
    with Serving(out, "--clock", "steps", "--serial", f"tcp:{line}", "--record", str(out / "r")) as serving:
        busy = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(2 * load)]
        try:
            words = [str(folder / "host"), str(serving.control), str(STEPS), str(target), *pauses]
            with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as host:
                log = subprocess.run(
                    [sys.executable, folder / "log.py", str(serving.control), str(line)],
                    env=environment, capture_output=True, text=True, timeout=300,
                )  # fmt: skip
                if log.returncode:
                    host.kill()  # nobody steps beside it any more
                said = host.communicate(timeout=300)[0]
        finally:
            for each in busy:
                each.kill()
                each.wait()
        assert host.returncode == 0 and log.returncode == 0, log.stderr
        assert serving.status()["simulated_s"] == pytest.approx(5.0)
        text = serving.end()
    return said + log.stdout + text.split("digest ")[1][:16]


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_thousand_pauses_of_the_hosts_change_nothing(folder: Path, tmp_path: Path) -> None:
    plain = digest(folder, tmp_path / "a")
    reached = int(plain.split()[0])
    assert abs(reached - 20000) < 10_000, "24 arcsec: the host in C closed its loop, friction and all"
    assert digest(folder, tmp_path / "b", "1", load=True) == plain
    assert digest(folder, tmp_path / "c", target=19999) != plain, "and what a host does is part of the run"


class Client:
    """What the barrier sees of a connection."""

    def __init__(self) -> None:
        self.said = b""

    def deliver(self, data: bytes) -> None:
        self.said += data


def test_time_goes_to_the_nearest_goal_and_frames_enter_by_name(bench: Bench) -> None:
    steps = Steps(bench.served)
    frames: list[Frame] = []
    bench.served.network.wire.tap(
        lambda _t, frame, sender: frames.append(frame) if sender.startswith("outside") else None
    )
    one, two = Client(), Client()

    def words(client: Client, text: str) -> str | None:
        return steps.take(client, text.split())  # type: ignore[arg-type]

    assert words(two, "join 2 zenith") is None
    assert steps.goal_ns() is None and two.said == b""
    assert words(one, "join 2 axis") is None and steps.waits(one)  # type: ignore[arg-type]
    assert steps.goal_ns() is None
    assert (one.said, two.said) == (b"ok\n", b"ok\n")
    with pytest.raises(ValueError, match="a client axis already"):
        words(two, "join 2 axis")
    assert words(two, "send 7FF#02") == "ok"
    assert words(one, "send 7FF#01") == "ok"
    words(two, "listen")
    words(two, "step 12ms")
    assert steps.goal_ns() is None
    looks = 0

    def look() -> bool:
        nonlocal looks
        looks += 1
        return looks > 100

    def wait(_timeout_s: float) -> bool:
        """As the loop does: the next word of a client, here."""
        if steps.goal_ns() is None and bench.served.now_ns < 10_000_000:
            words(one, "step 5 ms")
            return False
        return True

    steps.run(look, wait)
    assert bench.served.now_ns == 10_000_000
    assert one.said == b"ok\nok 5000000\nok 10000000\n" and two.said == b"ok\n"
    assert [frame.data for frame in frames] == [b"\1", b"\2"]
    steps.leave(one)  # type: ignore[arg-type]
    steps.run(look, lambda _timeout_s: True)
    heard, last = two.said.decode().splitlines()[1:-1], two.said.decode().splitlines()[-1]
    assert last == "ok 12000000"
    assert any("7FF#01" in each for each in heard), "one hears the others, too"
    assert len(heard) == bench.served.network.wire.frames


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("step", "join N"), ("step 5", "no unit"), ("step -5 ms", "does not go back"), ("step 5 kg", "kg"),
        ("send 011", "ID#DATA"), ("send 011#1", "ID#DATA"), ("send 3FFFFFFF#", "identifier"),
        ("join x", "join N"), ("join 0", "1 to 64"), ("join 65", "1 to 64"), ("step 1e300 s", "too large"),
        ("listen now", "join N"), ("speed 2", "stepped"), ("resume", "stepped"),
    ],
)  # fmt: skip
def test_a_line_that_cannot_be_meant_is_one_line_of_error(bench: Bench, line: str, reason: str) -> None:
    from tests.doors.test_control import Caller

    bench.served.steps = Steps(bench.served)
    door = ControlDoor(str(free_ports()), None, bench.served)
    bench.open(door)
    ask = Caller(bench, door.port)
    answer = ask(line)
    assert answer.startswith("error: ") and reason in answer and "\n" not in answer
    ask.socket.close()


def test_who_does_not_serve_steps_says_so(bench: Bench) -> None:
    from tests.doors.test_control import Caller

    door = ControlDoor(str(free_ports()), None, bench.served)
    bench.open(door)
    ask = Caller(bench, door.port)
    assert ask("step 5ms") == "error: step: time is paced here (schmidt serve --clock)"
    ask.socket.close()
    with pytest.raises(ValueError, match="--clock steps needs --control"):
        check(ServeOptions(clock="steps", asked={"serial": ("tcp:1",)}))


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_client_from_python_and_one_that_hangs_up(tmp_path: Path) -> None:
    with Serving(tmp_path, "--clock", "steps", "--lx200", str(free_ports())) as serving:
        with Stepped(str(serving.control), name="a") as clock, Stepped(str(serving.control), name="b"):
            assert clock.ask("status").startswith("{")  # b stands, and has not stepped
        with Stepped(str(serving.control)) as clock:
            clock.send(0x091, bytes.fromhex("1101000000000000"))
            heard = clock.step("60 ms")
            assert clock.now_ns == 60_000_000
            assert {0x091, 0x111} <= {frame.identifier for _, frame in heard}
            assert all(0 < t_ns <= 60_000_000 for t_ns, _ in heard)
            with pytest.raises(ValueError, match="ID#DATA"):
                clock.ask("send nothing")
            said = subprocess.run(
                [sys.executable, "-c", "from scenarios.cli import main; main()", "control", "status",
                 "--at", str(serving.control)], cwd=ROOT, capture_output=True, text=True, check=True,
            )  # fmt: skip
            assert '"paused": true' in said.stdout
