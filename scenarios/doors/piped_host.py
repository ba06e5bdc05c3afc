"""The host program beside `schmidt serve`: telescope client, consoles, LX200, Alpaca in their own process."""

from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from itertools import count
from multiprocessing.connection import Connection
from threading import Lock
from time import monotonic
from typing import Any

from host.camera.camera import Camera, Frame
from host.camera.models import CAMERAS
from host.camera.stars import SyntheticSky, from_file
from host.console.runs import RecordedRuns
from host.console.views import BusState, FaultKind
from host.logs.clientguiding import ClientGuiding
from scenarios.doors.door import counted
from scenarios.doors.options import ServeOptions
from scenarios.doors.pc import Host, TelescopePc
from scenarios.doors.pipe_messages import Settings, Slice, Taken
from scenarios.language.model import Scenario

_LOOKED_S = 1.0  # Pages refresh four times a second; when nobody has asked for so long, nobody looks.


class BusMirror:
    """A `BusView`. boards: whose supply can be switched. send: takes a wish, from any thread."""

    def __init__(self, boards: list[str], kinds: list[FaultKind], send: Callable[[object], None]) -> None:
        self.boards = tuple(boards)
        self.kinds = kinds
        self._send = send
        self._numbers = count()
        self._open: dict[int, Future[str]] = {}
        self._asked_s = float("-inf")
        self.state = BusState([], 0.0, {}, [], [])

    @property
    def watching(self) -> bool:
        """Whether somebody looks."""
        return monotonic() - self._asked_s < _LOOKED_S

    def look(self) -> BusState:
        """The last picture."""
        self._asked_s = monotonic()
        return self.state

    def wish(self, command: str) -> Future[str]:
        """The next slice does it."""
        number = next(self._numbers)
        future = self._open[number] = Future()
        self._send(("wish", number, command))
        return future

    def done(self, number: int, text: str, refused: bool) -> None:
        """What became of a wish."""
        future = self._open.pop(number, None)
        if future is None or not future.set_running_or_notify_cancel():
            return  # whoever wished has gone
        if refused:
            future.set_exception(ValueError(text))
        else:
            future.set_result(text)


def cameras(scenario: Scenario, options: ServeOptions, guiding: ClientGuiding | None) -> tuple[Camera, ...]:
    """By Alpaca's number, where there is an Alpaca door. scenario: one with a date. guiding: sees the frames.
    Raises ValueError for a catalogue that cannot be used."""
    if not options.asked.get("alpaca"):
        return ()
    sky = SyntheticSky() if options.stars is None else from_file(options.stars)
    folder = options.frames

    def keep(frame: Frame) -> None:
        if guiding is not None:
            guiding.frame(frame)
        if folder is not None:
            from host.camera.fits import write  # of the extra `camera`

            write(frame, scenario.site, scenario.clock, folder)

    return tuple(Camera(model, sky, scenario.site, scenario.clock, scenario.seed, keep) for model in CAMERAS)


_LOOK_S = 0.02
"""Wall time without a slice after which the host looks for itself, for a stop while time stands still."""


class PipedHost(Host):
    """What the pipe brings goes to the telescope client; what it and the pages want goes back."""

    def __init__(self, pipe: Connection, settings: Settings) -> None:
        self._pipe = pipe
        self._sending = Lock()
        self._now_ns = 0
        options = settings.options
        pc = TelescopePc(settings.scenario, self._report, settings.devices, options.logs)
        pc.cameras = cameras(settings.scenario, options, pc.guiding)
        self._mirror = BusMirror(settings.boards, settings.kinds, self._send)
        runs = RecordedRuns(options.runs, settings.headers, pc.journal)
        super().__init__(pc, self._mirror, runs, options, lambda text: self._send(("said", text)))

    def run(self) -> None:
        """Until told to close, or nobody is there any more."""
        self._send(("opened", self._told(), ""))
        try:
            while not self._pipe.poll(_LOOK_S) or self._take(self._pipe.recv()):
                self.pc.poll(self._now_ns)
                self.poll(self._now_ns)
        except (EOFError, OSError):  # the emulator has gone without a word
            self.close()
            return
        told = self._told()
        self.close()
        self._send(Taken(False, False, False, told))

    def _take(self, message: tuple[Any, ...]) -> bool:
        """A message; False when it is the last."""
        if isinstance(message, Slice):
            self._now_ns = message.now_ns
            for t_ns, report in message.reports:
                self.pc.link.receive(t_ns, report)
            for board, data in message.lines:
                self.runs.receive(message.now_ns, board, data)
            if message.bus is not None:
                self._mirror.state = message.bus
            for look in message.looks:
                for camera in self.pc.cameras:
                    camera.take(look)
            self.pc.poll(self._now_ns)
            looking = any(camera.looking for camera in self.pc.cameras)
            self._send(Taken(self._mirror.watching, self.runs.recording, looking, self._told()))
        elif message[0] == "done":
            self._mirror.done(*message[1:])
        return bool(message[0] != "close")

    def _told(self) -> list[tuple[str, str]]:
        now = self.pc.telescope.snapshot
        errors = counted((self.pc.journal.errors, "errors"))
        state = f"{now.activity}, {errors}" if errors else str(now.activity)
        return [("the host", state), *((each.door.name, each.door.state()) for each in self.keepers)]

    def _report(self, _t_ns: int, report: bytes) -> None:
        self._send(("report", report))

    def _send(self, message: object) -> None:
        with self._sending, suppress(ConnectionError):  # an emulator that has gone is seen when it is heard
            self._pipe.send(message)


def main(number: int) -> None:
    """Of the process; the pipe's file number is inherited."""
    with Connection(number) as pipe:
        try:
            settings = pipe.recv()
        except EOFError:
            return
        side = None
        try:
            side = PipedHost(pipe, settings)
            side.open()
        except (OSError, ValueError) as error:
            with suppress(ConnectionError):
                pipe.send(("opened", [], str(error)))
            if side is not None:
                side.close()
            return
        side.run()
