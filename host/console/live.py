"""The last minutes of the telescope, sampled once for all browsers."""

import asyncio
from collections import deque
from typing import NamedTuple

from bus.protocol import Device, unpack_tach
from bus.units import ARCSEC_PER_TURN
from host.console.figures import Clocks, clocks
from host.console.skymap import Chart
from host.console.views import BusView
from host.telescope import Snapshot, Telescope
from host.telescope.alarms import SILENCE_S, Alarms, Events, of_bus, of_house
from host.telescope.jobs import Activity

PERIOD_S = 0.25
"""Wall time between samples; the RS232 links of the paper's console are as fast."""
_CLOCKS = 4
"""Samples from one look at the clocks to the next; the way to the limits takes milliseconds."""
KEPT = 480
"""Samples kept, two minutes."""
RATIO = (113 / 27) * (123 / 21) * (250 / 17)
"""Motor turns per axis turn (paper, section 2.2)."""
TACH_COUNTS = 4096
LEAST_ARCSEC_S = 50.0
"""Slower than this the tachometers' counts do not tell a gear reduction (4.6″/s per count)."""


class Sample(NamedTuple):
    """One moment, axis by axis (ra, dec). gear: motor turns per axis turn; twist: motor A against B, ″."""

    t_s: float
    error_arcsec: tuple[float | None, float | None]
    rate_arcsec_s: tuple[float | None, float | None]
    effort_percent: tuple[float, float]
    current_a: tuple[float, float, float, float]
    gear: tuple[float | None, float | None]
    twist_arcsec: tuple[float | None, float | None]


class Live:
    """Samples of one telescope; `run` is the one task that takes them."""

    def __init__(self, telescope: Telescope, bus: BusView) -> None:
        self.telescope = telescope
        self.alarms = Alarms()
        self.events = Events()
        self.widths: list[tuple[float, float]] = []
        """Of the focus curve: half steps, star width as somebody has measured it."""
        self.chart = Chart(telescope.observatory)
        self.clocks = Clocks("–", "–", "–", "–", "–")
        self._bus = bus
        self.samples: deque[Sample] = deque(maxlen=KEPT)
        self._taken = 0

    async def run(self) -> None:
        """Until cancelled."""
        while True:
            self.take()
            await asyncio.sleep(PERIOD_S)

    def take(self) -> None:
        """One sample, when time has gone on."""
        now = self.telescope.snapshot
        if self.samples and now.t_s <= self.samples[-1].t_s:
            return
        bus = self._bus.look()
        found = self.alarms.of_telescope(now) | of_bus(bus.load, bus.running)
        if now.t_s > SILENCE_S:  # boards that have just been switched on are not silent
            found = of_house(self.telescope.house) | found
        self.alarms.take(now.t_s, found)
        self.events.take(self.telescope, self.alarms.standing)
        if self._taken % _CLOCKS == 0:
            self.clocks = clocks(self.telescope)
        self._taken += 1
        follows = now.activity == Activity.TRACKING.value  # else degrees to go hide arcseconds
        errors = now.errors_arcsec if follows else None
        moved = now.slewing  # and degrees a second the sky's own motion
        self.samples.append(
            Sample(
                now.t_s,
                (errors[0], errors[1]) if errors is not None else (None, None),
                (None, None) if moved else (now.ra.rate_arcsec_s, now.dec.rate_arcsec_s),
                (100 * now.ra.effort, 100 * now.dec.effort),
                (*now.ra.currents_a, *now.dec.currents_a),
                (_gear(now, "ra"), _gear(now, "dec")),
                (
                    self._twist(Device.MOTOR_RA_A, Device.MOTOR_RA_B),
                    self._twist(Device.MOTOR_DEC_A, Device.MOTOR_DEC_B),
                ),
            )
        )

    def _twist(self, a: Device, b: Device) -> float | None:
        counts = [self.telescope.client.link.measurements.get(motor) for motor in (a, b)]
        if counts[0] is None or counts[1] is None:
            return None
        first, second = (unpack_tach(data).counts for data in counts if data is not None)
        return (first - second) / TACH_COUNTS / RATIO * ARCSEC_PER_TURN


def _gear(now: Snapshot, axis: str) -> float | None:
    state = now.ra if axis == "ra" else now.dec
    turns = [each for each in state.motor_turns_s if each is not None]
    if not turns or abs(state.rate_arcsec_s) < LEAST_ARCSEC_S:
        return None
    return abs(sum(turns) / len(turns)) * ARCSEC_PER_TURN / abs(state.rate_arcsec_s)
