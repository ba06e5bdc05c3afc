"""Frames: equal where every field is, and what CAN 2.0 can carry (identifiers of 11 and 29 bits, 8 bytes)."""

import pytest

from bus.can import Frame, FrameError
from bus.can.frame import arbitration_key, check

ONE = Frame(0x123, b"\x01", extended=False, remote=False)
OTHERS = [
    Frame(0x124, b"\x01"),
    Frame(0x123, b"\x02"),
    Frame(0x123, b"\x01", extended=True),
    Frame(0x123, b"\x01", remote=True),
]


@pytest.mark.parametrize("other", OTHERS, ids=str)
def test_a_frame_differs_by_any_one_field(other: Frame) -> None:
    assert other != ONE
    assert len({ONE, other, Frame(0x123, b"\x01")}) == 2
    assert hash(ONE) == hash(Frame(0x123, b"\x01"))


def test_nothing_else_is_a_frame() -> None:
    assert ONE not in [(0x123, b"\x01", False, False), 0x123]


def test_a_frame_with_another_identifier_keeps_the_rest() -> None:
    assert Frame(5, b"\x07", True, True).moved(6) == Frame(6, b"\x07", True, True)
    assert Frame(5, b"\x07").moved(6) == Frame(6, b"\x07")


@pytest.mark.parametrize(("frame", "text"), [
    (Frame(0x12, b"\x01"), r"Frame(0x012, b'\x01')"),
    (Frame(0x12, b"", extended=True), "Frame(0x012, b'', extended)"),
    (Frame(0x12, b"", remote=True), "Frame(0x012, b'', remote)"),
])  # fmt: skip
def test_a_frame_says_what_it_is(frame: Frame, text: str) -> None:
    assert repr(frame) == text


@pytest.mark.parametrize(("identifier", "extended", "size", "fits"), [
    (0, False, 0, True), (0x7FF, False, 8, True), (0x800, False, 8, False), (-1, False, 0, False),
    (0x1FFF_FFFF, True, 8, True), (0x2000_0000, True, 0, False), (0x7FF, False, 9, False),
])  # fmt: skip
def test_limits_of_can(identifier: int, extended: bool, size: int, fits: bool) -> None:
    frame = Frame(identifier, bytes(size), extended)
    if fits:
        check(frame)
    else:
        with pytest.raises(FrameError):
            check(frame)


@pytest.mark.parametrize(("frame", "bits"), [  # SOF left out: identifier, RTR or SRR, IDE, identifier, RTR
    (Frame(0x123, b""), "00100100011 0 0" + "0" * 19),
    (Frame(0x123, b"", remote=True), "00100100011 1 0" + "0" * 19),
    (Frame(0x12345678, b"", True), "10010001101 1 1 000101011001111000 0"),
    (Frame(0x12345678, b"", True, True), "10010001101 1 1 000101011001111000 1"),
])  # fmt: skip
def test_the_key_is_the_arbitration_field(frame: Frame, bits: str) -> None:
    assert arbitration_key(frame) == int(bits.replace(" ", ""), 2)
