"""Bytes of RS232 lines: each is there when its stop bit is over; of what nobody takes the oldest is gone."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.protocol.serial import SAMPLES
from scenarios.doors.lines import Feed, Lines

BAUD = 100_000  # A byte of ten bits takes 100 us.
BYTE_NS = 100_000


def uart() -> Any:
    return SimpleNamespace(baud=BAUD, duration_ns=lambda count: count * BYTE_NS, line=None)


def test_a_byte_is_there_when_its_stop_bit_is_over() -> None:
    feed = Feed(uart())
    assert feed.until(0) == b""
    feed.hear(1000, b"abc")
    assert feed.until(500) == b"" and feed.until(1000) == b""
    assert feed.until(1000 + BYTE_NS - 1) == b""
    assert feed.until(1000 + BYTE_NS) == b"a"
    assert feed.until(1000 + BYTE_NS) == b""
    assert feed.until(1000 + 3 * BYTE_NS) == b"bc"
    assert feed.until(10**9) == b""


@given(st.lists(st.integers(0, 900_000), max_size=12))
def test_whenever_one_looks_every_byte_comes_once(looks: list[int]) -> None:
    feed = Feed(uart())
    for start_ns, packet in ((0, b"abc"), (300_000, b"de"), (700_000, b"f")):
        feed.hear(start_ns, packet)
    found = b""
    for t_ns in sorted(looks):
        found += feed.until(t_ns)
        through = min(t_ns // BYTE_NS, 5) + (t_ns >= 800_000)
        assert len(found) == through
    assert found + feed.until(10**9) == b"abcdef"


def test_a_packet_that_is_out_is_followed_by_the_next_one() -> None:
    feed = Feed(uart())
    feed.hear(0, b"ab")
    feed.hear(200_000, b"cd")
    assert feed.until(100_000) == b"a"
    assert feed.until(350_000) == b"bc"
    assert feed.until(400_000) == b"d"


def test_sixteen_seconds_wait_and_the_oldest_goes_with_what_was_told_of_it() -> None:
    feed, most = Feed(uart()), 64 * SAMPLES
    for k in range(most):
        feed.hear(k * 300_000, bytes([k % 256, 255]))
    assert feed.until(100_000) == b"\0"
    feed.hear(most * 300_000, b"\7\7")
    found = feed.until(10**12)
    assert found[:2] == bytes([1, 255]) and len(found) == 2 * most


def test_a_slower_uart_s_duration_counts() -> None:
    """Start bits that are late: the line says when a byte is through."""
    slow = SimpleNamespace(baud=BAUD, duration_ns=lambda count: count * BYTE_NS - 30)
    feed: Any = Feed(slow)  # type: ignore[arg-type]
    feed.hear(0, b"ab")
    assert feed.until(BYTE_NS - 31) == b"" and feed.until(BYTE_NS - 30) == b"a"


def test_lines_have_any_number_of_feeds() -> None:
    first, second = uart(), uart()
    lines = Lines({"A": first, "B": second})
    one, other, third = lines.feed("A"), lines.feed("A"), lines.feed("B")
    first.line(0, b"x")
    lines.drop("A", other)
    lines.drop("A", other)
    first.line(100_000, b"y")
    assert one.until(10**9) == b"xy" and other.until(10**9) == b"x" and third.until(10**9) == b""
    with pytest.raises(KeyError):
        lines.feed("C")
