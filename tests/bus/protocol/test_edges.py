"""Values at and beyond the end of their fields; expected: the DBC's widths, docs/reference/protocol.md."""

import pytest

from bus import protocol as p
from bus.protocol.database import database
from bus.protocol.nodes import DOME
from bus.protocol.position import AGE_UNIT_NS
from bus.protocol.saturate import bounds
from bus.protocol.scales import COUNTS_PER_TURN, STEPS_PER_TURN, rate_q16
from bus.protocol.serial import PacketDecoder, pack_packet, packet_bytes


class Told:
    """Counts how often somebody was told of a cut value."""

    def __init__(self) -> None:
        self.times = 0

    def __call__(self) -> None:
        self.times += 1


@pytest.mark.parametrize(
    ("velocity", "effort", "sent", "told"),
    [  # MOTION: velocity has 15 bits, effort 13, both signed (schmidt.dbc)
        (16383, 4095, (16383, 4095), 0),
        (-16384, -4096, (-16384, -4096), 0),
        (16384, 0, (16383, 0), 1),
        (-16385, 0, (-16384, 0), 1),
        (0, 4096, (0, 4095), 1),
        (0, -4097, (0, -4096), 1),
        (99_999, -99_999, (16383, -4096), 1),
        (-1, -1, (-1, -1), 0),
    ],
)
def test_motion_at_the_ends_of_its_fields(
    velocity: int, effort: int, sent: tuple[int, int], told: int
) -> None:
    clip = Told()
    data = p.pack_motion(0x12, 0xF6, velocity, effort, (1023, 0), clip)
    assert clip.times == told
    assert p.unpack_motion(data) == (0x12, 6, 0xF, *sent, 1023, 0)
    signals = database().get_message_by_name("AXIS_DEC_MOTION").decode(data, decode_choices=False)
    assert (signals["Velocity"], signals["Effort"], signals["AdcA"], signals["AdcB"]) == (*sent, 1023, 0)
    assert p.unpack_motion(p.pack_motion(0x11, 0, velocity, effort, (0, 1023)))[3:5] == sent


@pytest.mark.parametrize(
    ("distance", "sent"), [(1 << 31, (1 << 31) - 1), (-(1 << 31) - 1, -(1 << 31)), ((1 << 31) - 1,) * 2]
)
def test_target_at_the_ends_of_its_distance(distance: int, sent: int) -> None:
    clip = Told()
    data = p.pack_target(0x11, 5, 1, distance, clip)
    assert p.unpack_target(data) == (0x11, 5, 1, sent)
    assert data[1] == p.SUMMARY_KIND and clip.times == (sent != distance)


@pytest.mark.parametrize("delta", [32_767, -1, -32_768])
def test_tach_at_the_ends_of_its_difference(delta: int) -> None:
    assert p.unpack_tach(p.pack_tach(0x31, 3, 7, delta)) == (0x31, 3, 7, delta)


@pytest.mark.parametrize(
    ("count", "sent"), [(0x7FFF_FFFF, 0x7FFF_FFFF), (0x8000_0000, -0x8000_0000), (-0x8000_0001, 0x7FFF_FFFF)]
)
def test_tach_counts_wrap_at_32_bits(count: int, sent: int) -> None:
    assert p.unpack_tach(p.pack_tach(0x31, 0, count, 0)).counts == sent


def test_a_heartbeats_counters_wrap_or_stay() -> None:
    """Uptime wraps after 65 536 s; lost interrupts and TEC stay at their largest value."""
    beat = p.unpack_heartbeat(p.pack_heartbeat(0x51, 3, 65_536 + 7, 70_000, 256))
    assert beat == (0x51, 3, 7, 65_535, 255)
    beat = p.unpack_heartbeat(p.pack_heartbeat(0x51, 1, 65_535, 65_535, 255))
    assert beat == (0x51, 1, 65_535, 65_535, 255)


def test_bounds_are_those_of_twos_complement() -> None:
    assert bounds("<bBhHiIx") == (
        (-128, 127), (0, 255), (-32_768, 32_767), (0, 65_535), (-0x8000_0000, 0x7FFF_FFFF), (0, 0xFFFF_FFFF),
    )  # fmt: skip


@pytest.mark.parametrize("data", [b"", bytes(7), b"\x11\x10" + bytes(7), b"\x11\x7f" + bytes(6)])
def test_what_is_no_command_is_refused(data: bytes) -> None:
    with pytest.raises(p.CommandError, match="not a command"):
        p.unpack_command(data)


@pytest.mark.parametrize(
    ("device", "own"),
    [
        (p.Device.AXIS_DEC, {0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17}),
        (p.Device.FOCUS, {0x20, 0x21, 0x22, 0x23, 0x24}),
        (p.Device.DISPLAY, {0x30}),
        (p.Device.POSITION_RA, set()),
        (p.Device.GATEWAY, set()),
    ],
)
def test_every_board_knows_its_opcodes_and_no_others(device: p.Device, own: set[int]) -> None:
    assert {int(each) for each in p.opcodes(device)} == {1, 2, 3} | own


def test_the_complaint_names_the_arguments() -> None:
    with pytest.raises(p.CommandError, match=r"MOVE_TO takes target, speed_class; \(1,\) does not fit"):
        p.pack_command(p.Device.AXIS_RA, p.Opcode.MOVE_TO, 1)
    with pytest.raises(p.CommandError, match="STOP takes no arguments"):
        p.pack_command(p.Device.AXIS_RA, p.Opcode.STOP, 1)


def test_the_age_counts_4_us() -> None:
    """schmidt.dbc, POSITION: Age in units of 4 us."""
    age = database().get_message_by_name("POSITION_RA_POSITION").get_signal_by_name("Age")
    assert (age.scale, age.unit, AGE_UNIT_NS) == (1, "4us", 4000)


def test_a_packet_byte_by_byte() -> None:
    """Sync AA 55, device, sequence and time stamp modulo their widths, samples, CRC-16 over all but the sync:
    by long division, polynomial 0x1021, initial 0xFFFF."""
    packet = pack_packet(p.Device.POSITION_RA, 0x1FE, 0x1_2345_6789, [(0x0102_0304,)] * 25)
    assert packet[:8] == bytes.fromhex("aa55 21fe 89674523")
    assert packet[8:12] == bytes.fromhex("04030201") and len(packet) == 2 + 6 + 25 * 4 + 2
    crc = 0xFFFF
    for byte in packet[2:-2]:
        crc ^= byte << 8
        for _ in range(8):
            crc = crc << 1 ^ (0x1_1021 if crc & 0x8000 else 0)
    assert packet[-2:] == crc.to_bytes(2, "little")


def test_samples_that_do_not_fit_are_cut_and_told_of_once() -> None:
    clip = Told()
    samples = [(40_000, -40_000, 70_000), *[(1, 2, 3)] * 24]
    (packet,) = PacketDecoder().feed(pack_packet(p.Device.FOCUS, 1, 2, samples, clip))
    assert [tuple(each) for each in packet.rows] == [(32_767, -32_768, 65_535), *samples[1:]]
    assert clip.times == 1
    pack_packet(p.Device.FOCUS, 1, 2, samples[1:2] * 25, clip)
    assert clip.times == 1


def test_a_declared_boards_packet_carries_its_frames() -> None:
    dome = DOME.nodes["DOME"]
    assert packet_bytes(dome) == 2 + 6 + 25 * 7 + 2
    (packet,) = PacketDecoder({dome}).feed(pack_packet(dome, 0, 0, [tuple(range(249, 256))] * 25))
    assert packet.rows == (tuple(range(249, 256)),) * 25


GOOD = pack_packet(p.Device.POSITION_DEC, 1, 2, [(3,)] * 25)


@pytest.mark.parametrize(
    ("before", "skipped", "wrong"),
    [
        (b"", 0, 0),
        (b"\x00\x01\x02", 3, 0),
        (b"\xaa", 1, 0),
        (b"\xaa\x00", 2, 0),
        (b"\xaa\x55\x99", 3, 0),  # sync and a device without a line
        (b"\xaa\x55", 2, 0),  # the next AA is no device type
        (GOOD[:-1] + bytes([GOOD[-1] ^ 1]), len(GOOD), 1),
    ],
    ids=["nothing", "noise", "half a sync", "no sync", "no device", "sync alone", "bad CRC"],
)
def test_what_stands_before_a_packet_is_skipped_and_counted(before: bytes, skipped: int, wrong: int) -> None:
    for piece in (1, len(before) + len(GOOD)):
        decoder, found, stream = PacketDecoder(), [], before + GOOD
        for start in range(0, len(stream), piece):
            found += decoder.feed(stream[start : start + piece])
        assert [(each.device, each.sequence, each.stamp) for each in found] == [(0x22, 1, 2)]
        assert (decoder.skipped_bytes, decoder.crc_errors) == (skipped, wrong)
        assert decoder.feed(b"\xaa") == [] and decoder.skipped_bytes == skipped
        assert len(decoder.feed(GOOD[1:])) == 1 and decoder.skipped_bytes == skipped


def test_noise_without_a_sync_is_counted_at_once_and_not_kept() -> None:
    decoder = PacketDecoder()
    assert decoder.feed(bytes(1000)) == [] and decoder.skipped_bytes == 1000
    assert decoder.feed(b"\x01\xaa") == [] and decoder.skipped_bytes == 1001  # half a sync may go on
    assert len(decoder.feed(GOOD[1:])) == 1 and decoder.skipped_bytes == 1001


def test_an_axis_scales_are_the_papers() -> None:
    """Encoder 4.608e6 on a roller 735:30; RCN 829 of 29 bits; 200 ticks a second: 15 arcsec/s are 6.533."""
    assert COUNTS_PER_TURN == 4_608_000 * 735 // 30 and STEPS_PER_TURN == 2**29
    assert rate_q16(15.0) == round(15 / 1_296_000 * 4_608_000 * 24.5 / 200 * 2**16) == 428_169


@pytest.mark.parametrize("sample", [(1, 2), (1, 2, 3, 4)])
def test_a_sample_of_another_length_is_not_cut_to_fit(sample: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="zip"):
        pack_packet(p.Device.FOCUS, 0, 0, [sample] * 25)
