import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus import protocol as p
from bus.can import Frame
from bus.protocol.report import PLACES, ReportError, pack_report, place, slot, unpack_commands, unpack_report

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


@given(st.lists(frames, max_size=8))
def test_L2_a_node_is_in_its_place_with_its_newest_and_all_else_in_order(batch: list[Frame]) -> None:
    report = place([slot(frame) for frame in batch])
    back = unpack_report(report)
    for at in range(8):
        assert PLACES.get(report[8 * at], at) == at
    for device in PLACES:
        ours = [each for each in batch if each.identifier == p.MEASUREMENT_BASE + device]
        assert [each for each in back if each.identifier == p.MEASUREMENT_BASE + device] == ours[-1:]
    others = [each for each in batch if each.identifier - p.MEASUREMENT_BASE not in PLACES]
    assert [each for each in back if each.identifier - p.MEASUREMENT_BASE not in PLACES] == others


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


@pytest.mark.parametrize(
    ("identifier", "data"),
    [
        (0x200, "00 01 02 03 04 05 06 07"),  # device 0 would be an empty slot
        (0x280, "80 01 02 03 04 05 06 07"),  # bit 7 is the report's own
        (0x211, "11 01 02 03 04 05 06"),
        (0x211, "11 01 02 03 04 05 06 07 08"),
    ],
)
def test_B7_a_frame_that_no_slot_can_hold_is_refused(identifier: int, data: str) -> None:
    with pytest.raises(ReportError, match="no slot"):
        slot(Frame(identifier, bytes.fromhex(data)))


@pytest.mark.parametrize("identifier", [0x091, 0x111 + 1, 0x212, 0x311, 0x711])
def test_B7_a_frame_whose_bytes_say_another_kind_is_refused(identifier: int) -> None:
    with pytest.raises(ReportError, match="another kind"):
        slot(Frame(identifier, bytes([0x11, 0x22, *range(6)])))


def test_B7_a_summary_with_a_heartbeats_kind_is_refused() -> None:
    for base, kind in ((p.SUMMARY_BASE, p.HEARTBEAT_KIND), (p.HEARTBEAT_BASE, p.SUMMARY_KIND)):
        with pytest.raises(ReportError, match="another kind"):
            slot(Frame(base + 0x11, bytes([0x11, kind, *range(6)])))


def test_B7_slots_byte_by_byte() -> None:
    """docs/reference/protocol.md: bit 7 of byte 0 marks no measurement; byte 1 tells the kinds apart."""
    assert slot(Frame(0x211, bytes([0x11, 0x92, *range(6)]))) == bytes([0x11, 0x92, *range(6)])
    assert slot(Frame(0x111, bytes([0x11, 0x12, *range(6)]))) == bytes([0x91, 0x12, *range(6)])
    assert slot(Frame(0x311, bytes([0x11, 0xF3, *range(6)]))) == bytes([0x91, 0xF3, *range(6)])
    assert slot(Frame(0x711, bytes([0x11, 0xF7, *range(6)]))) == bytes([0x91, 0xF7, *range(6)])
    assert slot(Frame(0x27F, bytes([0x7F, *range(7)]))) == bytes([0x7F, *range(7)])
    assert slot(Frame(0x201, bytes([0x01, *range(7)]))) == bytes([0x01, *range(7)])


def test_B7_slots_anywhere_in_a_report_are_found() -> None:
    report = bytes(8) + bytes([0x11, *range(7)]) + bytes(40) + bytes([0x7F, *range(7)])
    assert unpack_report(report) == [
        Frame(0x211, bytes([0x11, *range(7)])),
        Frame(0x27F, bytes([0x7F, *range(7)])),
    ]
    assert [frame.identifier for frame in unpack_commands(report)] == [0x091, 0x0FF]
    for count in (63, 65):
        with pytest.raises(ReportError, match=f"{count} bytes, expected 64"):
            unpack_report(bytes(count))


def test_B7_a_reply_ends_at_opcode_0x7f() -> None:
    (frame,) = unpack_report(bytes([0x91, 0x7F]).ljust(64, b"\0"))
    assert frame.identifier == 0x111 and frame.data[:2] == bytes([0x11, 0x7F])
    with pytest.raises(ReportError, match="kind 0x80"):
        unpack_report(bytes([0x91, 0x80]).ljust(64, b"\0"))


def test_B7_a_command_may_have_bit_7_set() -> None:
    (frame,) = unpack_commands(bytes([0x91, 0x01]).ljust(64, b"\0"))
    assert frame.identifier == 0x091
