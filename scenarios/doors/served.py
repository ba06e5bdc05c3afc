"""A served network: everything a door may touch."""

from __future__ import annotations

from bus.pacer import Pacer
from bus.punctual import Punctuality
from plant.model import PlantModel
from scenarios.doors.entry import Entry, Journal
from scenarios.doors.lines import Lines
from scenarios.doors.usb import Usb
from scenarios.model import Scenario
from scenarios.served import wire

BOARD = "board"
"""Kind of entry that switches a board's supply: `NAME on` or `NAME off`."""
DEBUG = "debug"
"""Kind of entry of a debug port: `NAME ` and the bytes."""


class Served:
    """Network, pace and ways in. Nothing in here knows a particular door.

    entry: where things enter. usb: the gateway's USB cable, for host programs in this process too. lines: the
    five RS232 lines. pacer: speed and pause, both changeable at any time. `stop()` ends the serving.
    """

    def __init__(
        self, scenario: Scenario, model: PlantModel, speed: float = 1.0, journal: Journal | None = None
    ) -> None:
        self.scenario = scenario
        self.model = model
        self.network = wire(scenario, model)
        self.entry = Entry(self.network.queue, journal)
        self.usb = Usb(self.network.queue, self.network.hid, self.entry)
        self.lines = Lines(self.network.uarts)
        self.pacer = Pacer(self.network.queue, speed)
        self.punctual = Punctuality(self.pacer)
        self.ending = False
        self.entry.register(BOARD, self._switch)
        self.entry.register(DEBUG, self._debug)

    @property
    def now_ns(self) -> int:
        """Simulated time."""
        return self.network.queue.now_ns

    def stop(self) -> None:
        """End the serving with the next slice."""
        self.ending = True

    def switch(self, board: str, on: bool) -> None:
        """Switch the supply of a board, by name; raises NetworkError for one there is not."""
        self.network.board(board)
        self.entry.enter(BOARD, f"{board} {'on' if on else 'off'}".encode())

    def _switch(self, data: bytes) -> None:
        name, _, state = data.decode().partition(" ")
        board = self.network.board(name)
        (board.power_on if state == "on" else board.power_off)(self.now_ns)

    def debug(self, board: str, data: bytes) -> None:
        """Bytes for a board's debug port."""
        self.entry.enter(DEBUG, board.encode() + b" " + data)

    def _debug(self, data: bytes) -> None:
        name, _, text = data.partition(b" ")
        self.network.debug[name.decode()].write(self.now_ns, text)

    def run_until(self, t_ns: int) -> None:
        """Let simulated time go on to `t_ns`, as fast as it goes."""
        self.network.queue.run_until(t_ns)
