"""Host programs in this process on the gateway's USB cable."""

import pytest

from bus.protocol import Device, Opcode, Reply, pack_command, unpack_reply
from bus.protocol.report import pack_report
from host.link import HidLink
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.usb import IN_LIMIT, OUT_LIMIT, UsbFull, UsbPlug
from scenarios.lab.prepare import chosen

PING = pack_report([pack_command(Device.DISPLAY, Opcode.PING)])
MS = 1_000_000


@pytest.fixture
def served() -> LiveNetwork:
    served = LiveNetwork(*chosen())
    served.run_until(20 * MS)
    return served


def replies(link: HidLink) -> list[Reply]:
    found: list[Reply] = []
    link.on_reply = lambda _t, data: found.append(unpack_reply(data))
    return found


def pump(plug: UsbPlug, link: HidLink) -> None:
    for t_ns, report in plug.reports():
        link.receive(t_ns, report)


def test_two_programs_command_and_both_hear_all_answers(served: LiveNetwork) -> None:
    plugs = [served.usb.plug(name) for name in ("one", "two")]
    links = [HidLink(plug.write) for plug in plugs]
    heard = [replies(link) for link in links]
    for link, device in zip(links, (Device.DISPLAY, Device.FOCUS), strict=True):
        link.queue(pack_command(device, Opcode.PING))
        link.flush(served.now_ns)
    served.run_until(served.now_ns + 20 * MS)
    for plug, link in zip(plugs, links, strict=True):
        pump(plug, link)
    for each in heard:
        assert [(reply.device, reply.result) for reply in each] == [(Device.DISPLAY, 0), (Device.FOCUS, 0)]
    assert links[0].measurements[Device.POSITION_RA]


def test_a_flood_of_reports_waits_is_bounded_and_all_are_answered(served: LiveNetwork) -> None:
    plug = served.usb.plug("flood")
    link = HidLink(plug.write)
    heard = replies(link)
    for _ in range(OUT_LIMIT):
        assert plug.ready
        plug.write(served.now_ns, PING)
    with pytest.raises(UsbFull):
        plug.write(served.now_ns, PING)
    for _ in range(40):
        served.run_until(served.now_ns + 100 * MS)
        pump(plug, link)
    assert len(heard) == OUT_LIMIT
    assert served.network.boards["GATEWAY"].dropped == 0


def test_a_program_that_does_not_read_loses_the_oldest(served: LiveNetwork) -> None:
    plug = served.usb.plug("asleep")
    served.run_until(served.now_ns + 40_000 * MS)
    times = [t_ns for t_ns, _ in plug.reports()]
    assert len(times) == IN_LIMIT
    assert times == sorted(times)
    assert times[-1] > served.now_ns - 20 * MS
    plug.unplug()
    served.run_until(served.now_ns + 20 * MS)
    assert plug.reports() == []


def test_nothing_enters_in_the_middle_of_a_slice(served: LiveNetwork) -> None:
    plug = served.usb.plug("rude")
    served.network.queue.at(served.now_ns + MS, lambda t_ns: plug.write(t_ns, PING))
    served.entry.running = True
    with pytest.raises(RuntimeError):
        served.run_until(served.now_ns + 2 * MS)


@pytest.mark.parametrize("length", [0, 1, 63, 65, 1000])
def test_reports_of_a_wrong_length_are_refused(served: LiveNetwork, length: int) -> None:
    with pytest.raises(ValueError, match="64"):
        served.usb.plug("odd").write(0, bytes(length))


@pytest.mark.parametrize(
    "report", [bytes([0x61, *range(1, 64)]), b"\xff" * 64, bytes(range(64)), b"\x80" * 64]
)
def test_reports_of_nonsense_harm_nobody(served: LiveNetwork, report: bytes) -> None:
    served.usb.plug("nonsense").write(0, report)
    served.run_until(served.now_ns + 100 * MS)
    assert all(board.on for board in served.network.boards.values())
