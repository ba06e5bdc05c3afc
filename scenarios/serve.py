"""`schmidt serve [SCENARIO] --can INTERFACE:CHANNEL [--speed X]`: the network in real time, for others
to join."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from rich.console import Console

from bus.door import Door
from bus.external import open_bus
from bus.pacer import Pacer
from scenarios.network import Network
from scenarios.served import network

_STATUS_S = 1.0


def serve(
    scenario: Path | None,
    can: str,
    speed: float = 1.0,
    seed: int | None = None,
    plant: str | None = None,
    duration_s: float | None = None,
) -> int:
    """Pace the network and join it to the bus `can` names, until Ctrl-C or `duration_s` (wall time).

    The scenario's steps are not run (see `scenarios.served`). Returns the exit status, 0; raises ValueError
    subclasses with one line for input that cannot be used.
    """
    console = Console()
    with open_bus(can) as outside, console.status("starting (the first time compiles)") as line:
        served = network(scenario, seed, plant)
        served.run_until(1)  # every kernel is compiled before the clock starts
        door = Door(served.queue, served.wire, outside)
        pacer = Pacer(served.queue, speed)
        status = _Status(served, door, pacer, duration_s)
        boards = len(served.boards)
        console.print(f"serving {boards} boards on {can} at {speed:g} times real time; Ctrl-C ends it")
        try:
            pacer.run(each_slice=lambda: status.slice(line.update))
        except KeyboardInterrupt:
            pass
        finally:
            door.close()
    console.print(status.text())
    return 0


class _Status:
    """Looks outside before every slice, says once a second how things stand, and knows when time is up."""

    def __init__(self, served: Network, door: Door, pacer: Pacer, duration_s: float | None) -> None:
        self._served = served
        self._door = door
        self._pacer = pacer
        self._start_s = perf_counter()
        self._start_ns = served.queue.now_ns
        self._next_s = self._start_s + _STATUS_S
        self._end_s = None if duration_s is None else self._start_s + duration_s

    def slice(self, show: Callable[[str], None]) -> bool:
        """Between two slices; True when time is up."""
        self._door.poll()
        now_s = perf_counter()
        if now_s >= self._next_s:
            self._next_s = now_s + _STATUS_S
            show(self.text())
        return self._end_s is not None and now_s >= self._end_s

    def text(self) -> str:
        """One line of how things stand."""
        now_ns = self._served.queue.now_ns
        wall_s = max(perf_counter() - self._start_s, 1e-9)
        pace = (now_ns - self._start_ns) * 1e-9 / wall_s
        door, pacer = self._door, self._pacer
        lost = door.lost_in + door.lost_out + door.rejected
        return (
            f"{now_ns * 1e-9:.1f} s simulated at {pace:.2f} times real time, "
            f"bus load {self._served.wire.load:.1%}, "
            f"{door.frames_in} frames in, {door.frames_out} out, {lost} lost, "
            f"{pacer.lateness_s * 1e3:.1f} ms late (worst {pacer.worst_lateness_s * 1e3:.0f} ms)"
        )
