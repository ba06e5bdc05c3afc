"""The host program of a served network, in a process beside it: its end of the pipe."""

import select
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from time import monotonic

from host.client import TICK_NS
from host.console.views import BusState
from scenarios.doors import pipe_messages as messages
from scenarios.doors.busview import EmulatedBus, Looks
from scenarios.doors.lines import Feed
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.options import ServeOptions
from scenarios.doors.pc import dated
from scenarios.doors.usb import UsbFull, UsbPlug
from scenarios.lab.session import log_headers

RECORDED = ("AXIS_RA", "AXIS_DEC")
"""Boards whose RS232 lines a console can record."""
_START_S = 120.0  # Wall time in which a host on a very busy machine has imported its libraries. ASSUMPTION.
_SILENT_S = 10.0
"""A host that has not taken a slice for so long hangs: it is ended and started again. ASSUMPTION."""
_END_S = 2.0  # Wall time for its farewell and the logs. ASSUMPTION.
_BUS_S = 0.25  # Wall time between two pictures of the bus: consoles refresh as often.
_MOST = 256  # Reports in one slice: 20 kB, far less than a socket's buffer, so that sending never blocks.


class HostProcess:
    """The host as a door; what it has open for others is over there. say: takes lines for the user.

    Its program is started at once, as it has much to import; `open` waits until it has opened its doors.
    """

    def __init__(self, served: LiveNetwork, options: ServeOptions, say: Callable[[str], None]) -> None:
        self.name = "the host"
        self._served = served
        self._scenario = dated(served.scenario)  # once: the next process has the same sky
        self._options = options
        self._say = say
        self._bus = EmulatedBus(served)
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: Connection | None = None
        self._plug: UsbPlug | None = None
        self._feeds: list[tuple[str, Feed]] = []
        self._once = False
        self._ready = False
        self._waiting = False
        self._asked_s = 0.0
        self._sent_ns = 0
        self._bus_s = 0.0
        self._watching = False
        self._looks = Looks(served)
        self.doors: list[tuple[str, str]] = []
        """(name, state) of itself and its doors, as it last said."""
        self._start()

    def _start(self) -> None:
        ours, theirs = Pipe()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", messages.program(), str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                start_new_session=True,  # a Ctrl-C is the emulator's, which tells its host when it is over
            )
        self._pipe, self._ready, self._waiting = ours, False, False
        self._heard = select.poll()  # once: `Connection.poll` makes a new one every time
        self._heard.register(ours.fileno(), select.POLLIN)
        served = self._served
        ours.send(
            messages.Settings(
                self._scenario,
                self._options,
                list(served.network.boards),
                served.network.devices,
                log_headers(served.scenario, served.model),
                self._bus.fault_kinds(),
            )
        )
        self._asked_s = monotonic()

    def open(self) -> None:
        """Have it open its doors: wait for that the first time, later only start it. Raises OSError."""
        if self._pipe is None:
            self._start()
        self._plug = self._served.usb.plug(self.name)
        if not self._once:
            assert self._pipe is not None
            end_s = monotonic() + _START_S
            while not self._ready:
                if not self._pipe.poll(max(0.0, end_s - monotonic())):
                    raise OSError(f"{self.name} did not start within {_START_S:g} s")
                self._hear()
            self._once = True

    def poll(self, now_ns: int) -> None:
        """What it wants, then what has happened since it last took a slice."""
        pipe, plug = self._pipe, self._plug
        if pipe is None or plug is None:
            return
        while self._heard.poll(0):
            self._hear()
        if self._waiting and self._served.pacer.speed > 1.0 and now_ns - self._sent_ns > 2 * TICK_NS:
            self._let_it_catch_up(_BUS_S)
        self._looks.poll(now_ns)
        if self._waiting or not self._ready:
            if monotonic() - self._asked_s > (_SILENT_S if self._ready else _START_S):
                if self._process is not None:
                    self._process.kill()
                raise OSError("it does not answer")
            return
        if self._served.steps is not None and now_ns - self._sent_ns < TICK_NS:
            return  # it does nothing between its ticks, and nobody waits for it
        reports = plug.reports(_MOST)
        lines = [(name, data) for name, feed in self._feeds if (data := feed.until(now_ns))]
        bus = self._bus_state()
        if reports or lines or bus is not None or now_ns - self._sent_ns >= TICK_NS:
            self._send(messages.Slice(now_ns, reports, lines, bus, self._looks.taken()))
            self._waiting, self._asked_s, self._sent_ns = True, monotonic(), now_ns
            if self._served.steps is not None:
                self._let_it_catch_up(_SILENT_S)

    def close(self) -> None:
        """Have it hang up and write its logs; ends it if it does not."""
        process, pipe = self._process, self._pipe
        self._process = self._pipe = None
        if self._plug is not None:
            self._plug.unplug()
            self._plug = None
        self._record(False)
        if pipe is not None:
            with pipe, suppress(OSError, EOFError):
                pipe.send(("close",))
                end_s = monotonic() + _END_S
                while pipe.poll(max(0.0, end_s - monotonic())):
                    said = pipe.recv()
                    if isinstance(said, messages.Taken):
                        self.doors = said.doors
        if process is not None:
            try:
                process.wait(_END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def state(self) -> str:
        """What the telescope does, as it last said."""
        return self.doors[0][1] if self.doors else "not there yet"

    def _let_it_catch_up(self, wall_s: float) -> None:
        """Faster than real time, time waits for the host: its time-outs are in simulated time. At real time
        it does not, as it would not for a PC. Where clients step time it waits until the host is through."""
        end_s = monotonic() + wall_s
        while self._waiting and self._pipe is not None and self._pipe.poll(max(0.0, end_s - monotonic())):
            self._hear()

    def _hear(self) -> None:
        assert self._pipe is not None
        try:
            said = self._pipe.recv()
        except (EOFError, OSError):
            raise OSError("its process has ended") from None
        match said:
            case messages.Taken():
                self._waiting, self._watching, self.doors = False, said.watching, said.doors
                self._looks.wanted = said.looking
                self._record(said.recording)
            case "report", data if self._plug is not None:
                with suppress(UsbFull):  # as if it were lost on the way
                    self._plug.write(self._served.now_ns, data)
            case "wish", number, command:
                self._send(("done", number, *self._bus.wish(command)))
            case "said", text:
                self._say(text)
            case "opened", doors, error:
                if error:
                    raise OSError(error)
                self._ready, self.doors = True, doors

    def _send(self, message: object) -> None:
        try:
            if self._pipe is not None:
                self._pipe.send(message)
        except OSError:
            raise OSError("its process has ended") from None

    def _bus_state(self) -> BusState | None:
        now_s = monotonic()
        if not self._watching or now_s < self._bus_s:
            return None
        self._bus_s = now_s + _BUS_S
        return self._bus.look()

    def _record(self, on: bool) -> None:
        lines = self._served.lines
        if on and not self._feeds:
            self._feeds = [(name, lines.feed(name)) for name in RECORDED if name in lines.uarts]
        elif not on:
            for name, feed in self._feeds:
                lines.drop(name, feed)
            self._feeds = []
