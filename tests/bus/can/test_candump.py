from hashlib import sha256
from io import BytesIO
from pathlib import Path

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.can import Frame
from bus.can.candump import CandumpWriter, block, line, parsed
from tests.bus.can.test_bits import frames
from tests.bus.can.test_wire import network

logs = st.lists(st.tuples(st.integers(0, 10**14), frames), max_size=20)


@given(logs)
def test_what_python_can_reads_is_what_was_written(log: list[tuple[int, Frame]]) -> None:
    file = BytesIO()
    writer = CandumpWriter(file)
    for t_ns, frame in log:
        writer.take(t_ns, frame)
    writer.close()
    from io import StringIO

    back = list(can.CanutilsLogReader(StringIO(file.getvalue().decode())))
    assert len(back) == len(log) == writer.frames
    for message, (t_ns, frame) in zip(back, log, strict=True):
        assert abs(message.timestamp - t_ns / 1e9) < 2e-6
        assert message.channel == "can0"
        assert message.arbitration_id == frame.identifier
        assert message.is_extended_id == frame.extended
        assert message.is_remote_frame == frame.remote
        assert message.dlc == len(frame.data)
        if not frame.remote:
            assert bytes(message.data) == frame.data
    assert writer.hexdigest() == sha256(file.getvalue()).hexdigest()


@given(logs)
def test_the_digest_needs_no_file_and_no_order_of_flushes(log: list[tuple[int, Frame]]) -> None:
    kept, bare = CandumpWriter(BytesIO()), CandumpWriter(None)
    for t_ns, frame in log:
        kept.take(t_ns, frame)
        kept.flush()
        bare.take(t_ns, frame)
    assert kept.hexdigest() == bare.hexdigest()
    text = "".join(line(t_ns, frame) + "\n" for t_ns, frame in log)
    assert bare.hexdigest() == sha256(text.encode()).hexdigest()


def test_it_taps_a_wire(tmp_path: Path) -> None:
    queue, wire = network(2)
    path = tmp_path / "can.log"
    with path.open("wb") as file:
        writer = CandumpWriter(file)
        wire.tap(writer.take)
        wire.ports[0].send(Frame(0x211, b"\x11\x22"), 1_000_000_000)
        queue.run_until(2_000_000_000)
        writer.close()
    # 0x211 with two bytes: 63 bits and its stuff bits, delivered three bits before the end of intermission.
    assert path.read_text().endswith(" can0 211#1122\n")
    assert path.read_text().startswith("(1.00006")


plain = st.builds(Frame, st.integers(0, 0x7FF), st.binary(min_size=8, max_size=8))


@given(st.lists(st.tuples(st.integers(10**9, 10**15), plain), min_size=1, max_size=20))
def test_lines_filled_in_by_column_are_the_lines(log: list[tuple[int, Frame]]) -> None:
    """Times of the same number of digits go the quick way, a mixture the plain one."""
    digits = len(str(log[0][0]))
    for rows in (log, [row for row in log if len(str(row[0])) == digits]):
        text = "".join(line(t_ns, frame) + "\n" for t_ns, frame in rows)
        assert block([t_ns for t_ns, _ in rows], [frame for _, frame in rows]) == text.encode()


@pytest.mark.parametrize(("text", "found"), [
    ("(1.000129) can0 211#1101000000000000", (1_000_129_000, Frame(0x211, b"\x11\x01" + bytes(6)))),
    ("(1714000000.250000) vcan12 7FF#", (1_714_000_000_250_000_000, Frame(0x7FF, b""))),
    ("(2.000000) can0 00000012#AB", (2_000_000_000, Frame(0x12, b"\xab", extended=True))),
    ("(0.000001) can0 7FF#R", (1000, Frame(0x7FF, b"", remote=True))),
    ("(0.000000) can0 1FFFFFFF#R3", (0, Frame(0x1FFF_FFFF, bytes(3), extended=True, remote=True))),
    ("(1.000129) can0 211#110", None),
    ("(0.000000) can0 20000004#00", (0, Frame(0x2000_0004, b"\0", extended=True))),  # CAN_ERR_FLAG
])  # fmt: skip
def test_a_line_is_read_as_it_stands(text: str, found: tuple[int, Frame] | None) -> None:
    assert parsed(text) == found


def test_a_batch_is_written_as_it_is_full_and_not_before() -> None:
    file = BytesIO()
    writer = CandumpWriter(file)
    for k in range(1023):
        writer.take(k * 1000, Frame(0x211, b""))
    assert not file.getvalue() and writer.frames == 0
    writer.take(1_023_000, Frame(0x211, b""))
    assert file.getvalue().count(b"\n") == writer.frames == 1024


def test_flushing_writes_through_to_the_file(tmp_path: Path) -> None:
    with (tmp_path / "can.log").open("wb") as file:
        writer = CandumpWriter(file)
        writer.take(0, Frame(0x211, b""))
        writer.flush()
        assert (tmp_path / "can.log").read_bytes() == b"(0.000000) can0 211#\n"


def test_a_log_goes_on_behind_lines_written_before() -> None:
    before = b"(0.000000) can0 211#11\n(0.001000) can0 212#\n"
    whole = before + b"(1.000000) can0 213#22\n"
    file = BytesIO()
    for writer in (CandumpWriter(file), CandumpWriter(None)):
        writer.resume(before)
        writer.take(1_000_000_000, Frame(0x213, b"\x22"))
        assert writer.hexdigest() == sha256(whole).hexdigest()
        assert writer.frames == 3
    assert file.getvalue() == whole
