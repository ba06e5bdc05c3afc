"""Who rules a network: the first report starts it, and a master's silence is told once."""

import pytest

from boards.canopen.masters import Host, Watched
from boards.silicon.hid import HidEndpoint
from bus.time import EventQueue, Oscillator

MS = 1_000_000


def test_a_first_report_starts_all_nodes_and_later_ones_who_boots_up() -> None:
    """NMT: 1 starts, node 0 is all of them (CiA 301, 7.2.8.3.1)."""
    hid = HidEndpoint()
    reports: list[tuple[int, bytes]] = []
    commands: list[tuple[int, int]] = []
    hid.from_host = lambda t_ns, report: reports.append((t_ns, report))
    host = Host(hid, lambda *each: commands.append(each))
    host.booted(0x11)
    assert (host.there, commands) == (False, [])
    for t_ns in (5, 6):
        hid.write(t_ns, bytes(64))
    assert (host.there, commands) == (True, [(1, 0)])
    host.booted(0x11)
    assert commands == [(1, 0), (1, 0x11)]
    assert reports == [(5, bytes(64)), (6, bytes(64))]


class Bench:
    """Node 3 may be silent for 100 ms and node 0x7F for 65.535 s by this crystal's time."""

    def __init__(self, ppm: float = 0.0) -> None:
        self.queue = EventQueue()
        self.told: list[tuple[int, int, bool]] = []
        self.watched = Watched(
            self.queue, Oscillator(ppm, 0), lambda node, there: self.told.append((self.now_ms, node, there))
        )
        self.watched.set([3 << 16 | 100, 0x7F << 16 | 0xFFFF, 0, 4 << 16, 50])

    @property
    def now_ms(self) -> int:
        return self.queue.now_ns // MS

    def at(self, ms: int, *nodes: int) -> None:
        """Heartbeats at a time."""
        self.queue.run_until(ms * MS)
        for node in nodes:
            self.watched.heard(node, self.queue.now_ns)


def test_a_master_is_lost_when_its_time_is_over_and_back_with_its_next_heartbeat() -> None:
    bench = Bench()
    bench.at(1000)
    assert bench.told == []  # silent from the start: not looked at yet
    for ms in (1000, 1099, 1198):
        bench.at(ms, 3)
    bench.at(2000)
    assert (bench.told, bench.watched.lost) == ([(1298, 3, False)], {3})
    bench.at(2000, 3)
    assert bench.told[1:] == [(2000, 3, True)] and not bench.watched.lost
    bench.at(5000)
    assert bench.told[2:] == [(2100, 3, False)]


def test_each_has_its_own_time_and_who_is_not_watched_has_none() -> None:
    bench = Bench()
    bench.at(0, 0x7F)
    assert bench.queue.next_ns() == 65_535_000_000
    bench.at(0, 3, 0x7F, 4, 0, 5)
    bench.at(65_534)
    assert bench.told == [(100, 3, False)]
    bench.at(70_000)
    assert bench.told[1:] == [(65_535, 0x7F, False)]


def test_watching_others_forgets_those_before() -> None:
    bench = Bench()
    bench.at(0, 3)
    bench.at(150, 0x7F)
    bench.watched.set([5 << 16 | 10])
    assert bench.watched.lost == set()
    bench.at(160, 3, 5)
    bench.at(100_000)
    assert bench.told == [(100, 3, False), (170, 5, False)]


@pytest.mark.parametrize(("ppm", "ms"), [(10_000.0, 99), (-10_000.0, 101)])
def test_the_time_is_the_boards_own(ppm: float, ms: int) -> None:
    bench = Bench(ppm)
    bench.at(0, 3)
    bench.at(1000)
    assert bench.told == [(ms, 3, False)]
