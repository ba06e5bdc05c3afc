"""A log of candump fed into a stub network: when each frame is offered, and how two logs compare."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from bus.can import Frame
from bus.can.bits import INTERMISSION_BITS
from bus.can.length import frame_bits
from bus.protocol import COMMAND_BASE, REPLY_BASE
from scenarios.lab import muted
from scenarios.lab.muted import Feed, Rest, compare, read, says
from tests.scenarios.lab.faults.stub import BIT_NS, Queue

DEVICE = 0x11


def log(path: Path, *lines: tuple[float, str]) -> Path:
    path.write_text("".join(f"({t_s:.6f}) can0 {text}\n" for t_s, text in lines))
    return path


@pytest.mark.parametrize(
    ("identifier", "own"),
    [
        (0x200 + DEVICE, True),
        (0x200 + DEVICE + 1, False),
        (COMMAND_BASE + DEVICE, False),
        (REPLY_BASE + DEVICE, True),
    ],
)
def test_a_board_s_frames_have_its_device_type_but_for_commands(identifier: int, own: bool) -> None:
    assert says(DEVICE, Frame(identifier, b"")) is own
    assert not says(DEVICE, Frame(identifier, b"", extended=True))


def test_frames_are_read_with_their_time_and_error_frames_left_out(tmp_path: Path) -> None:
    file = log(tmp_path / "a", (0.25, "211#0102"), (0.5, "20000004#0004000000000000"), (1.5, "212#"))
    assert list(read(file)) == [(250_000_000, Frame(0x211, b"\1\2")), (1_500_000_000, Frame(0x212, b""))]


def test_a_line_that_is_none_is_named_and_cut(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("(0.250000) can0 211#00\n" + "x" * 300 + "\n")
    with pytest.raises(ValueError) as caught:
        list(read(file))
    assert str(caught.value) == f"{file}:2: not a line of candump -L: {'x' * 60!r}"
    with pytest.raises(ValueError, match=f"^{tmp_path}: "):
        list(read(tmp_path))


class Rig:
    """A muted board of DEVICE; arrived: what the fed node offers."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.arrived: list[tuple[int, Frame]] = []
        self.queue, self.names = Queue(), list[str]()
        self.board: Any = SimpleNamespace(device_type=DEVICE, send=None)
        self.network: Any = SimpleNamespace(
            boards={"A": self.board, "B": None}, queue=self.queue, wire=SimpleNamespace(bit_ns=BIT_NS)
        )

        def node(_queue: Any, _wire: Any, name: str) -> Any:
            self.names.append(name)
            return SimpleNamespace(arrive=lambda frame: self.arrived.append((self.queue.now_ns, frame)))

        monkeypatch.setattr(muted, "OutsideNode", node)


def test_each_frame_is_offered_at_its_start_and_the_board_says_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    rig = Rig(monkeypatch)
    file = log(tmp_path / "a", (0.25, "211#0102"), (0.26, "212#00"), (0.5, "211#03"))
    Feed(rig.network, "A", file)
    assert rig.board.send(Frame(1, b""), 0) is True and rig.names == ["A from the log"]
    rig.queue.step()
    rig.queue.step()
    assert not rig.queue.due
    frames = (Frame(0x211, b"\1\2"), Frame(0x211, b"\3"))
    lengths = [(frame_bits(each) - INTERMISSION_BITS) * BIT_NS for each in frames]
    assert rig.arrived == [
        (t_ns - length, frame)
        for t_ns, length, frame in zip((250_000_000, 500_000_000), lengths, frames, strict=True)
    ]


def test_what_began_before_time_is_offered_at_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    rig = Rig(monkeypatch)
    Feed(rig.network, "A", log(tmp_path / "a", (0.0, "211#01"), (0.0, "211#02")))
    assert [rig.queue.step(), rig.queue.step()] == [0, 0]


def test_a_board_that_is_not_there_or_says_nothing_is_said(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    rig = Rig(monkeypatch)
    file = log(tmp_path / "a", (0.25, "212#00"))
    with pytest.raises(ValueError, match=r"^--mute C: there is no such board; use one of A, B$"):
        Feed(rig.network, "C", file)
    with pytest.raises(ValueError, match=f"^{file}: no frame of A is in it$"):
        Feed(rig.network, "A", file)


def test_the_rest_is_compared_per_identifier_in_its_order(tmp_path: Path) -> None:
    """One of 0x212 differs, the muted board's frame is not looked at, one identifier is in the run alone."""
    before = log(
        tmp_path / "a", (0.1, "212#01"), (0.2, "212#02"), (0.3, "211#09"), (0.4, "213#05"), (0.5, "214#")
    )
    after = log(
        tmp_path / "b",
        (0.100004, "212#01"),
        (0.2, "212#03"),
        (0.399991, "213#05"),
        (0.6, "215#"),
        (0.7, "215#"),
    )
    rest = compare(before, after, DEVICE)
    assert (rest.same, rest.logged, rest.heard) == (2, 4, 5) and rest.late_us == pytest.approx(9.0)
    assert (
        Rest(2, 4, 5, 9.0).text() == "the rest: 2 of 4 frames as in the log (5 were sent), times within 9 us"
    )
    assert compare(before, before, DEVICE).late_us == 0.0
