"""A served network that a test paces by hand: polls its doors, lets time go on, as the loop does."""

from collections.abc import Callable, Iterator
from time import perf_counter, sleep

import pytest

from scenarios.doors.door import Door, Keeper
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.prepare import chosen

MS = 1_000_000


class Bench:
    """served, and the doors that have been opened on it; said: what the keepers reported."""

    def __init__(self) -> None:
        self.served = LiveNetwork(*chosen())
        self.keepers: list[Keeper] = []
        self.said: list[str] = []

    def open(self, door: Door) -> Keeper:
        keeper = Keeper(door, self.said.append)
        keeper.open()
        self.keepers.append(keeper)
        return keeper

    def slice(self, ns: int = MS) -> None:
        """One slice."""
        for keeper in self.keepers:
            keeper.poll(self.served.now_ns)
        self.served.entry.running = True
        self.served.run_until(self.served.now_ns + ns)
        self.served.entry.running = False

    def run(self, ms: int) -> None:
        """So many slices of a millisecond, as fast as they go."""
        for _ in range(ms):
            self.slice()

    def until(self, done: Callable[[], bool], wall_s: float = 10.0) -> None:
        """Slices until something is so; a client in a thread or process gets wall time for it."""
        end_s = perf_counter() + wall_s
        while not done():
            assert perf_counter() < end_s, "it did not happen"
            self.slice()
            sleep(0.0005)

    def all_tick(self) -> bool:
        """Whether every board's timer routine still runs."""
        boards = self.served.network.boards
        before = {name: board.ticks for name, board in boards.items()}  # type: ignore[attr-defined]
        self.served.run_until(self.served.now_ns + 1_100 * MS)
        return all(board.ticks > before[name] for name, board in boards.items())  # type: ignore[attr-defined]


@pytest.fixture
def bench() -> Iterator[Bench]:
    bench = Bench()
    yield bench
    for keeper in bench.keepers:
        keeper.close()
    assert not any(keeper.bugs for keeper in bench.keepers), bench.said
