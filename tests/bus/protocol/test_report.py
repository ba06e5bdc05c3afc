import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus import protocol as p
from bus.can import Frame
from bus.protocol.report import ReportError, pack_report, slot, unpack_commands, unpack_report

devices = st.sampled_from(list(p.Device))
seven = st.binary(min_size=7, max_size=7)
measurements = st.builds(lambda d, rest: Frame(p.MEASUREMENT_BASE + d, bytes([d]) + rest), devices, seven)
replies = st.builds(
    lambda d, op, rest: Frame(p.REPLY_BASE + d, bytes([d, op]) + rest[1:]),
    devices,
    st.integers(0, 0x7F),
    seven,
)
kinds = st.builds(
    lambda d, k, rest: Frame(k[0] + d, bytes([d, k[1]]) + rest[1:]),
    devices,
    st.sampled_from([(p.SUMMARY_BASE, p.SUMMARY_KIND), (p.HEARTBEAT_BASE, p.HEARTBEAT_KIND)]),
    seven,
)
frames = st.one_of(measurements, replies, kinds)


@given(st.lists(frames, max_size=8))
def test_B7_a_report_gives_the_frames_back(batch: list[Frame]) -> None:
    report = pack_report([slot(frame) for frame in batch])
    assert len(report) == 64
    assert unpack_report(report) == batch


@given(st.lists(st.builds(lambda d, rest: bytes([d]) + rest, devices, seven), max_size=8))
def test_B7_commands_go_to_the_device_they_name(batch: list[bytes]) -> None:
    frames = unpack_commands(pack_report(batch))
    assert [frame.data for frame in frames] == batch
    assert all(frame.identifier == p.COMMAND_BASE + frame.data[0] for frame in frames)


def test_B7_the_answer_to_an_opcode_beyond_0x7f_stays_a_reply() -> None:
    frame = Frame(p.REPLY_BASE + 0x11, p.pack_reply(0x11, 0xF7, p.Result.UNKNOWN_OPCODE, 0, 0))
    (back,) = unpack_report(pack_report([slot(frame)]))
    assert back.identifier == frame.identifier
    assert p.unpack_reply(back.data).opcode == 0x77


def test_B7_what_has_no_place_is_refused() -> None:
    with pytest.raises(ReportError, match="63 bytes"):
        unpack_report(bytes(63))
    with pytest.raises(ReportError, match="9 slots"):
        pack_report([bytes(8)] * 9)
    with pytest.raises(ReportError, match="no slot"):
        slot(Frame(0x211, b"\x11"))
    with pytest.raises(ReportError, match="kind 0x90"):
        unpack_report(pack_report([bytes([0x91, 0x90, 0, 0, 0, 0, 0, 0])]))
