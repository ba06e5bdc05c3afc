"""Reports of the USB link: what is kept of each kind of frame, and what is counted and dropped."""

import pytest

from bus.protocol import HEARTBEAT_KIND, SUMMARY_KIND
from bus.protocol.report import REPORT_BYTES, SLOTS
from host.link import HidLink


def report(*slots: bytes) -> bytes:
    return b"".join(slots).ljust(REPORT_BYTES, b"\0")


def slot(device: int, kind: int = 0, text: bytes = b"abcdef") -> bytes:
    return bytes((device, kind)) + text


@pytest.fixture
def link() -> HidLink:
    return HidLink(lambda *_: None)


def test_the_last_frame_of_each_device_and_kind_is_kept_with_its_time(link: HidLink) -> None:
    link.receive(5, report(slot(0x11), slot(0x91, SUMMARY_KIND), slot(0x91, HEARTBEAT_KIND), slot(0x7F)))
    link.receive(9, report(slot(0x11, 0, b"newest")))
    assert link.measurements == {0x11: slot(0x11, 0, b"newest"), 0x7F: slot(0x7F)}
    assert link.measured_ns == {0x11: 9, 0x7F: 5}
    assert link.summaries == {0x11: slot(0x11, SUMMARY_KIND)}
    assert link.heartbeats == {0x11: slot(0x11, HEARTBEAT_KIND)} and link.heard_ns == {0x11: 5}
    assert (link.reports, link.bad_reports) == (2, 0)


def test_a_reply_is_handed_on_without_its_mark(link: HidLink) -> None:
    heard: list[tuple[int, bytes]] = []
    link.receive(3, report(slot(0x91, 0x10)))  # nobody listens
    link.on_reply = lambda t_ns, data: heard.append((t_ns, data))
    link.receive(4, report(slot(0x91, 0x10), slot(0x80, 0x7F)))
    assert heard == [(4, slot(0x11, 0x10)), (4, slot(0x00, 0x7F))]
    assert link.bad_reports == 0


def test_a_wrong_length_and_an_unknown_kind_are_counted(link: HidLink) -> None:
    for wrong in (b"", bytes(REPORT_BYTES - 1), bytes(REPORT_BYTES + 1)):
        link.receive(1, wrong)
    assert (link.reports, link.bad_reports) == (0, 3)
    unknown = next(k for k in range(0x80, 0x100) if k not in (SUMMARY_KIND, HEARTBEAT_KIND))
    link.receive(1, report(slot(0x91, unknown), slot(0x12)))
    assert (link.reports, link.bad_reports) == (1, 4) and 0x12 in link.measurements


@pytest.mark.parametrize("count", [0, 1, SLOTS, SLOTS + 1, 2 * SLOTS + 3])
def test_commands_leave_in_their_order_eight_to_a_report(count: int) -> None:
    sent: list[tuple[int, bytes]] = []
    link = HidLink(lambda t_ns, data: sent.append((t_ns, data)))
    commands = [slot(k + 1, 0x10) for k in range(count)]
    for each in commands:
        link.queue(each)
    link.flush(7)
    link.flush(8)
    assert len(sent) == -(-count // SLOTS) and all(t_ns == 7 and len(d) == REPORT_BYTES for t_ns, d in sent)
    assert b"".join(data for _, data in sent).rstrip(b"\0") == b"".join(commands)
