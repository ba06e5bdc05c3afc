"""How one sits at the telescope from an asyncio loop in a thread of its own.

    desk = AsyncDesk(telescope)
    await desk.run(lambda t: t.drive.goto(star))        # until the telescope is on target
    await desk.do(lambda t: t.paddle.press("n", SpeedClass.FINE))
    print(desk.now.ra.rate_arcsec_s)

`do` returns when the command was taken or raises `Refused`; `run` waits until its job has ended.
"""

import asyncio
from collections.abc import Callable
from typing import TypeVar

from host.telescope.jobs import Job, Reason, Refused
from host.telescope.state import Snapshot
from host.telescope.telescope import Telescope

T = TypeVar("T")
ANSWER_S = 5.0
"""Wall time until a tick must have come; ticks are 50 ms apart at speed 1, 0.5 s at speed 0.1. ASSUMPTION."""

_LOOK_S = 0.05
"""Wall time between two looks at what comes with a tick."""


class AsyncDesk:
    """For one asyncio loop. console: it respects the console lock, which programs do not, nor a stop ever."""

    def __init__(self, telescope: Telescope, console: bool = False) -> None:
        self.telescope = telescope
        self._console = console

    @property
    def now(self) -> Snapshot:
        """The telescope at the last tick."""
        return self.telescope.snapshot

    def _guarded(self, act: Callable[[Telescope], T], always: bool) -> Callable[[Telescope], T]:
        if not self._console or always:
            return act

        def unless_locked(telescope: Telescope) -> T:
            if telescope.locked:
                raise Refused(Reason.LOCKED, "the console is locked; unlock it first")
            return act(telescope)

        return unless_locked

    async def do(self, act: Callable[[Telescope], T], always: bool = False, urgent: bool = False) -> T:
        """Have a command carried out at the next tick; returns its value or raises `Refused`."""
        future = asyncio.wrap_future(self.telescope.call(self._guarded(act, always), urgent))
        try:
            return await asyncio.wait_for(future, ANSWER_S)
        except TimeoutError:
            raise Refused(Reason.SILENT, f"no tick within {ANSWER_S:g} s; is it paused?") from None

    async def encoders(self) -> tuple[int, int, float]:
        """Readings of both axes and when RA's was latched, s; waits for the first ones, else `Refused`."""
        for _ in range(round(ANSWER_S / _LOOK_S)):
            now = self.now
            if now.ra.steps is not None and now.dec.steps is not None:
                return now.ra.steps, now.dec.steps, now.ra.latched_s
            await asyncio.sleep(_LOOK_S)
        raise Refused(Reason.SILENT, "no position has been received yet")

    async def run(self, act: Callable[[Telescope], Job[T]]) -> T:
        """Have a command carried out and wait until its job has ended."""
        job = await self.do(act)
        return await asyncio.shield(asyncio.wrap_future(job.finished))

    async def emergency_stop(self) -> None:
        """Stop everything, whatever the lock says."""
        await self.do(lambda telescope: telescope.emergency_stop(), always=True, urgent=True)

    async def lock(self, on: bool) -> None:
        """Lock the consoles, or unlock them."""
        await self.do(lambda telescope: setattr(telescope, "locked", on), always=True)
