"""A board muted, its frames fed from a log: the rest of the network goes on as if it were there."""

from pathlib import Path

import pytest

from bus.can import Frame
from bus.protocol import Device
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.muted import Feed, compare, read, says
from scenarios.lab.prepare import chosen
from tests.scenarios.conftest import Command


@pytest.fixture
def log(schmidt: Command, short: Path, tmp_path: Path) -> Path:
    assert schmidt("run", short, "--out", tmp_path / "one", "--no-report").returncode == 0
    return tmp_path / "one/can.log"


@pytest.mark.parametrize("board", ["POSITION_RA", "AXIS_RA"])
def test_the_rest_is_as_in_the_log(
    board: str, log: Path, schmidt: Command, short: Path, tmp_path: Path
) -> None:
    done = schmidt("run", short, "--out", tmp_path / "two", "--no-report", "--mute", board, "--feed", log)
    assert done.returncode == 0, done.stderr
    rest = compare(log, tmp_path / "two/can.log", Device[board])
    assert rest.logged == rest.heard > 1000
    assert rest.same == rest.logged
    assert rest.late_us <= 2.0  # candump's times are cut to microseconds, one at either end
    assert rest.text() in done.stdout


def test_other_frames_show_in_the_comparison(log: Path, tmp_path: Path) -> None:
    lines = log.read_text().splitlines(keepends=True)
    place = next(k for k, line in enumerate(lines) if " 211#" in line)
    lines[place] = lines[place][:-3] + ("00\n" if lines[place][-3:-1] != "00" else "01\n")
    (tmp_path / "other.log").write_text("".join(lines))
    rest = compare(log, tmp_path / "other.log", Device.POSITION_RA)
    assert rest.same == rest.logged - 1


@pytest.mark.parametrize(
    ("text", "board", "reason"),
    [
        ("(0.1) can0 221#00\n", "POSITION_RA", "not a line"),
        ("(0.100000) can0 222#00\n", "POSITION_RA", "no frame of POSITION_RA"),
        ("(0.100000) can0 221#00\n", "POSITION_XX", "no such board"),
    ],
)
def test_what_cannot_be_fed_is_said(
    text: str, board: str, reason: str, schmidt: Command, short: Path, tmp_path: Path
) -> None:
    file = tmp_path / "a.log"
    file.write_text(text)
    done = schmidt("run", short, "--no-report", "--mute", board, "--feed", file)
    assert done.returncode == 2
    assert reason in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_log_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="No such file"):
        list(read(tmp_path / "a.log"))


@pytest.mark.parametrize("body", ["211#R9", "FFF#00", "4FFFFFFF#00", "211#0", "211#00 R"])
def test_frames_that_can_does_not_have_are_refused(body: str, tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text(f"(0.100000) can0 {body}\n")
    with pytest.raises(ValueError, match=":1: not a line"):
        list(read(tmp_path / "a.log"))


def test_error_frames_are_left_out_and_an_empty_remote_frame_is_read(tmp_path: Path) -> None:
    text = "(0.100000) can0 20000004#0004000000000000\n(0.200000) can0 211#R\n"
    (tmp_path / "a.log").write_text(text)
    (logged,) = read(tmp_path / "a.log")
    assert logged.frame == Frame(0x211, b"", remote=True)


def test_a_served_board_is_muted_and_fed(log: Path, schmidt: Command, tmp_path: Path) -> None:
    heard: list[Frame] = []
    scenario, model = chosen()
    served = LiveNetwork(scenario, model)
    Feed(served.network, "POSITION_RA", log)
    served.network.wire.tap(lambda _t, frame, _sender: heard.append(frame))
    served.run_until(1_000_000_000)
    own = [frame for frame in heard if says(Device.POSITION_RA, frame)]
    logged = [each.frame for each in read(log) if says(Device.POSITION_RA, each.frame)]
    assert own == logged[: len(own)] and len(own) > 190


def test_serve_says_what_does_not_go_together(log: Path, schmidt: Command, tmp_path: Path) -> None:
    door = ("serve", "--debug", tmp_path / "ports", "--duration", "1", "--mute", "POSITION_RA")
    for more, complaint in (
        ((), "--mute BOARD and --feed LOG go together"),
        (("--feed", log, "--record", tmp_path / "rec"), "leave one out"),
        (("--feed", tmp_path / "none.log"), "No such file"),
    ):
        done = schmidt(*door, *more)
        assert done.returncode == 2 and complaint in done.stderr and "Traceback" not in done.stderr
