"""The telescope as programs see it: commands that start or are refused at once, a snapshot at every tick.

Everything here runs on the ticking thread. Other threads come in by `Telescope.call`, which hands a function
over to the next tick, and look at `Telescope.snapshot`, which is replaced as a whole.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from concurrent.futures import Future
from functools import partial
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

from bus.protocol import Device, Health, Opcode
from bus.protocol.nodes import DOME
from host.client import Client, ClientError
from host.logs.journal import Journal
from host.procedures.manual import AXES
from host.sky.observed import Observed
from host.sky.visibility import Observatory
from host.telescope.drive import Drive
from host.telescope.focuser import Focuser
from host.telescope.house import House
from host.telescope.jobs import Activity, Job, Reason, Refused, Side
from host.telescope.paddle import Paddle
from host.telescope.state import Snapshot, axis_state, board_states, stale_boards


class Boards:
    """Asks and sets what belongs to single boards; each command is a `Job` beside the others."""

    def __init__(self, client: Client, side: Side) -> None:
        self._client = client
        self._side = side

    def check(self) -> Job[dict[Device, Health | None]]:
        """Health bits of every board, None for one that does not answer."""
        return self._side.start(Job("health check", self._check(), Activity.IDLE))

    def get(self, device: Device, parameter: int) -> Job[int]:
        """Value of a parameter."""
        return self._side.start(Job(f"get {parameter}", self._get(device, parameter), Activity.IDLE))

    def set(self, device: Device, parameter: int, value: int) -> Job[int]:
        """Set a parameter; the job ends with the value the board has taken."""
        procedure = self._set(device, parameter, value)
        return self._side.start(Job(f"set {parameter}", procedure, Activity.IDLE))

    def _check(self) -> Generator[None, None, dict[Device, Health | None]]:
        answers: dict[Device, Health | None] = {}
        for device in self._client.devices:
            try:
                reply = yield from self._client.ask(device, Opcode.PING)
            except ClientError:
                answers[device] = None
                self._client.health.pop(device, None)
            else:
                answers[device] = Health(reply.value)
        return answers

    def _get(self, device: Device, parameter: int) -> Generator[None, None, int]:
        reply = yield from self._client.ask(device, Opcode.GET_PARAMETER, parameter)
        return reply.value

    def _set(self, device: Device, parameter: int, value: int) -> Generator[None, None, int]:
        yield from self._client.ask(device, Opcode.SET_PARAMETER, parameter, value)
        return (yield from self._get(device, parameter))


T = TypeVar("T")
_SLEWING = (Activity.SLEWING, Activity.PARKING, Activity.PADDLE, Activity.STOPPING)


class Telescope:
    """Drive, paddle, focus and boards of one telescope, and the fence other threads come in by.

    locked: the console lock (H2); doors that respect it refuse everything but the stop and the way out.
    """

    def __init__(self, client: Client, observatory: Observatory, journal: Journal) -> None:
        self.client = client
        self.observatory = observatory
        self.journal = journal
        self.side = Side()
        self.drive = Drive(client, observatory, journal)
        self.paddle = Paddle(self.drive, self.side)
        self.focuser = Focuser(client, journal)
        self.boards = Boards(client, self.side)
        self.house = House(client, self.side, self.aim)
        self.locked = False
        self.urgent = False
        """Somebody asked for a stop: whoever ticks does it now instead of at the next one due."""
        self._closed = False
        self._inbox: SimpleQueue[tuple[Callable[[Telescope], Any], Future[Any]]] = SimpleQueue()
        self.snapshot = self._look()

    def emergency_stop(self) -> Job[None]:
        """Both axes, the focus and the dome, if any, stop; nothing that was on its way is sent after it."""
        self.journal.command(self.client.now_ns, "HOST", "emergency stop", "sent")
        job = self.drive.stop()
        for device in AXES.values():
            self.side.start(Job("stop", self.client.ask(device, Opcode.STOP), Activity.STOPPING))
        self.focuser.hold()
        if self.house.boards(DOME):
            self.house.stop()
        return job

    def target(self) -> Observed | None:
        """Where it is going to, or what it follows; None: neither."""
        track, now = self.drive.pointing.track, self.snapshot
        if track is None or not (now.slewing or now.tracking):
            return None
        return self.observatory.observed(*track.steps(now.t_s))

    def aim(self) -> Observed | None:
        """Where the slit has to be: at the end of a slew, else where the tube points; None: not known."""
        now = self.snapshot
        if now.slewing and (target := self.target()) is not None:
            return target
        if now.ra.steps is None or now.dec.steps is None:
            return None
        return self.observatory.observed(now.ra.steps, now.dec.steps)

    def call(self, act: Callable[[Telescope], T], urgent: bool = False) -> Future[T]:
        """Have `act(telescope)` called at the next tick; from any thread. The future holds its value or
        what it raised, `Refused` above all. urgent: that tick does not wait until it is due."""
        future: Future[T] = Future()
        if self._closed:
            future.set_exception(Refused(Reason.SILENT, "the telescope is shut down"))
        else:
            self._inbox.put((act, future))
            self.urgent = self.urgent or urgent
        return future

    def tick(self, t_ns: int) -> None:
        """One tick of the host: what came in, what goes on, what goes out, and a new snapshot."""
        self.client.now_ns = t_ns
        self.urgent = False
        answers = self._let_in()
        self.drive.tick()
        self.focuser.tick()
        self.house.tick()
        self.side.tick()
        self.client.tick(t_ns)
        self.snapshot = self._look()
        for answer in answers:  # whoever gets one and then looks, sees what it has done
            answer()

    def close(self) -> None:
        """No more ticks: whoever waits is told so."""
        self._closed = True
        while True:
            try:
                _, future = self._inbox.get_nowait()
            except Empty:
                return
            if future.set_running_or_notify_cancel():
                future.set_exception(Refused(Reason.SILENT, "the telescope is shut down"))

    def _let_in(self) -> list[Callable[[], None]]:
        answers: list[Callable[[], None]] = []
        for _ in range(self._inbox.qsize()):
            act, future = self._inbox.get()
            if not future.set_running_or_notify_cancel():
                continue  # whoever asked has gone
            try:
                answers.append(partial(future.set_result, act(self)))
            except Exception as error:  # belongs to the caller; a door's mistake must not stop the telescope
                answers.append(partial(future.set_exception, error))
        return answers

    def _look(self) -> Snapshot:
        client, drive = self.client, self.drive
        track = drive.pointing.track
        return Snapshot(
            t_s=client.now_s,
            ra=axis_state(client, "ra"),
            dec=axis_state(client, "dec"),
            focus=client.focus(),
            boards=board_states(client),
            activity=drive.activity.value,
            powered=drive.powered,
            slewing=drive.activity in _SLEWING,
            tracking=drive.tracking,
            parked=bool(drive.parked),
            pulse_guiding=self.paddle.guider.pulsing,
            target=track.star.name if track is not None else "",
            errors_arcsec=drive.pointing.errors_arcsec(),
            locked=self.locked,
            stale=stale_boards(client),
        )
