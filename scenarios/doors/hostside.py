"""The host program beside `schmidt serve`: telescope client, consoles, LX200, Alpaca in their own process."""

from __future__ import annotations

from multiprocessing.connection import Connection
from threading import Lock

from bus.protocol.names import DECLARED, declared_device
from host.outside import Outside
from scenarios.doors.busmirror import BusMirror
from scenarios.doors.door import Door
from scenarios.doors.hostlink import Close, Done, Opened, Report, Said, Settings, Slice, Taken
from scenarios.doors.keeper import Keeper
from scenarios.doors.options import astronomy
from scenarios.hosted import Hosted

_LOOK_S = 0.02
"""Wall time without a slice after which the host looks for itself, for a stop while time stands still."""


class HostSide:
    """What the pipe brings goes to the telescope client; what it and the pages want goes back."""

    def __init__(self, pipe: Connection, settings: Settings) -> None:
        for number, name in settings.declared:
            if number not in DECLARED:
                declared_device(name, number)
        self._pipe = pipe
        self._sending = Lock()
        self._now_ns = 0
        options = settings.options
        self.hosted = Hosted(settings.scenario, self._report, settings.boards, options.logs)
        self.outside = Outside()
        self._doors: list[Door] = astronomy(options, self)
        self._bus = BusMirror(settings.boards, settings.kinds, self._send)
        self._runs = None
        if options.console is not None:
            from scenarios.doors.console import ConsoleDoor
            from scenarios.doors.runs import RecordedRuns

            self._runs = RecordedRuns(options.runs, settings.headers, self.hosted.journal)
            self._doors.append(ConsoleDoor(options.console, options.token, self, self._bus, self._runs))
        self._keepers = [Keeper(door, lambda text: self._send(Said(text))) for door in self._doors]

    def run(self) -> None:
        """Until told to close, or nobody is there any more."""
        try:
            for keeper in self._keepers:
                keeper.open()
        except (OSError, ValueError) as error:
            self._send(Opened([], str(error)))
            self._close()
            return
        self._send(Opened(self._told()))
        try:
            while not self._pipe.poll(_LOOK_S) or self._take(self._pipe.recv()):
                self.hosted.poll(self._now_ns)
                for keeper in self._keepers:
                    keeper.poll(self._now_ns)
        except (EOFError, OSError):  # the emulator has gone without a word
            self._close()
            return
        told = self._told()
        self._close()
        self._send(Taken(False, False, told))

    def _take(self, message: object) -> bool:
        """A message; False when it is the last."""
        if isinstance(message, Slice):
            self._now_ns = message.now_ns
            for t_ns, report in message.reports:
                self.hosted.link.receive(t_ns, report)
            if self._runs is not None:
                for board, data in message.lines:
                    self._runs.receive(message.now_ns, board, data)
            if message.bus is not None:
                self._bus.state = message.bus
            self.hosted.poll(self._now_ns)
            recording = self._runs is not None and self._runs.recording
            self._send(Taken(self._bus.watching, recording, self._told()))
        elif isinstance(message, Done):
            self._bus.done(message)
        return not isinstance(message, Close)

    def _told(self) -> list[tuple[str, str]]:
        now = self.hosted.telescope.snapshot
        state = f"{now.activity}, {self.hosted.journal.errors} errors"
        return [("the host", state), *((door.name, door.state()) for door in self._doors)]

    def _close(self) -> None:
        for keeper in self._keepers:
            keeper.close()
        self.outside.close()
        self.hosted.close()

    def _report(self, _t_ns: int, report: bytes) -> None:
        self._send(Report(report))

    def _send(self, message: object) -> None:
        with self._sending:
            self._pipe.send(message)


def main(number: int) -> None:
    """Of the process; the pipe's file number is inherited."""
    with Connection(number) as pipe:
        try:
            settings = pipe.recv()
        except EOFError:
            return
        try:
            side = HostSide(pipe, settings)
        except (OSError, ValueError) as error:
            pipe.send(Opened([], str(error)))
            return
        side.run()
