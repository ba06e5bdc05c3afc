"""The focus drive: one thing at a time, in half steps of 6.25 µm (H3)."""

from bus.protocol import Device, FocusFlag, Opcode
from host.client import Client, Procedure
from host.logs.journal import Logs
from host.procedures import focus
from host.procedures.focus import TRAVEL_HALF_STEPS
from host.telescope.jobs import Activity, Job, Reason, Refused

_CREEP_S = 0.1
"""Pause between two half steps of the slow key: 10 half steps/s. ASSUMPTION."""


class Focuser:
    """Moves, steps, holds, frees, finds its reference. Commands start a `Job` or raise `Refused`."""

    def __init__(self, client: Client, logs: Logs) -> None:
        self.client = client
        self.logs = logs
        self.job: Job[None] | None = None

    @property
    def moving(self) -> bool:
        """A command is under way, or the board says that the motor turns."""
        turns = focus.says(self.client, FocusFlag.MOVING)
        return turns or (self.job is not None and self.job.running)

    def move_to(self, half_steps: int) -> Job[None]:
        """Go to a position."""
        if abs(half_steps) > TRAVEL_HALF_STEPS:
            raise Refused(Reason.VALUE, f"{half_steps} half steps is outside ±{TRAVEL_HALF_STEPS}")
        self._energised()
        return self._begin(f"focus to {half_steps}", focus.move_to(self.client, half_steps))

    def step(self, half_steps: int) -> Job[None]:
        """Press +1 or −1 as often as asked for."""
        self._energised()
        return self._begin(f"focus by {half_steps:+d}", focus.step_by(self.client, half_steps))

    def run(self, outward: bool, slow: bool = False) -> Job[None]:
        """Hold a key: move until `hold`, to the end of the travel at most."""
        self._energised()
        sign = 1 if outward else -1
        end = focus.move_to(self.client, sign * TRAVEL_HALF_STEPS)
        return self._begin(f"focus {'out' if outward else 'in'}", self._creep(sign) if slow else end)

    def reference(self) -> Job[None]:
        """Find the absolute position from LVDT and index pulse."""
        self._energised()
        return self._begin("focus reference", focus.reference(self.client))

    def hold(self) -> Job[None]:
        """Motor power off: stop where it is, then the coils hold."""
        return self._begin("focus hold", focus.set_state(self.client, "hold"))

    def free(self) -> Job[None]:
        """Control power off: nothing holds the shaft, and the reference is lost."""
        return self._begin("focus free", focus.set_state(self.client, "free"))

    def tick(self) -> None:
        """Go on."""
        job = self.job
        if job is None or not job.running:
            return
        job.advance()
        if job.failed:
            self.logs.error(self.client.now_ns, "FOCUS", f"{job.name}: {job.failed}")

    def _begin(self, name: str, procedure: Procedure) -> Job[None]:
        if self.job is not None:
            self.job.cancel(f"given up for: {name}")
        self.client.forget(Device.FOCUS)
        self.job = Job(name, procedure, Activity.IDLE)
        return self.job

    def _creep(self, sign: int) -> Procedure:
        while True:
            yield from self.client.ask(Device.FOCUS, Opcode.FOCUS_STEP, sign)
            yield from self.client.wait(_CREEP_S)

    def _energised(self) -> None:
        if focus.says(self.client, FocusFlag.FREE):
            raise Refused(Reason.STATE, "the focus is free (control power off); hold it first")
