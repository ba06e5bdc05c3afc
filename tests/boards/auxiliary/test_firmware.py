"""The auxiliary encoder's board: a word of 17 bits every 10 ms."""

from boards.auxiliary.firmware import AuxiliaryBoard
from tests.boards.alone import Alone

AUXILIARY_RA = 0x23


def test_routines_take_what_the_table_says() -> None:
    """80 us for a word and the controller's buffer, 40 us for a command: this chip has no SPI."""
    alone = Alone(AuxiliaryBoard, AUXILIARY_RA)
    sample, can = (alone.board.cpu.lines[name] for name in ("sample", "can"))
    assert (sample.cost_ns, sample.latency_ns, sample.source.level) == (80_000, 1200, False)
    assert (can.cost_ns, can.latency_ns, can.source.level) == (40_000, 1200, True)


def test_a_position_has_17_bits_and_its_frames_are_numbered() -> None:
    alone = Alone(AuxiliaryBoard, AUXILIARY_RA)
    for value, told in ((5.0, 5), (131_071.9, 131_071), (131_072.0, 0), (131_077.0, 5), (-1.0, 131_071)):
        alone.pins["encoder"] = value
        alone.run(0.01)
        assert alone.said()["Position"] == told
    alone.run(2.6)
    numbers = [alone.codec.unpack(frame.data)["Sequence"] for _, frame in alone.told()]
    assert numbers == [k % 256 for k in range(1, len(numbers) + 1)]
    assert len(numbers) > 256


def test_an_age_is_from_the_latch_to_the_buffer() -> None:
    alone = Alone(AuxiliaryBoard, AUXILIARY_RA, encoder=1.0)
    alone.run(0.011)
    assert alone.said()["Age"] == 80
