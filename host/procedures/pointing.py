"""Go to a star through the speed classes, track it, park (H2, B2)."""

from dataclasses import dataclass
from functools import partial
from typing import Final

from bus.protocol import Device, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.client import Client, ClientError, Procedure
from host.procedures.manual import BOARDS, power_off
from host.sky.mount import STEP_ARCSEC, Mount
from host.sky.tracks import StarTrack

ENCODERS: Final = (Device.POSITION_RA, Device.POSITION_DEC)
CLASSES: Final = ("slew", "set", "guide", "fine")


@dataclass(frozen=True)
class Reach:
    """How near a speed class brings the telescope before the next takes over, and how long it may take."""

    arcsec: float
    timeout_s: float


REACH: Final = {
    "slew": Reach(300.0, 240.0),  # 180° at 2°/s and its ramps
    "set": Reach(30.0, 60.0),
    "guide": Reach(8.0, 60.0),
    "fine": Reach(3.0, 120.0),
}
"""ASSUMPTION: each hands over within seconds of the next one's speed; fine ends well inside 10″."""
SETTLED_S: Final = 1.0
"""Both axes stay inside `fine` for this long before the telescope counts as on target. ASSUMPTION."""
REFRESH_S: Final = 5.0
"""Rates are sent again this often: refraction changes them by less than 0.001 ″/s meanwhile. ASSUMPTION."""
TRIM_S: Final = 20.0
"""A mean error is taken out over this time by way of the rate, so that nothing jerks. ASSUMPTION."""
TRIM_ARCSEC_S: Final = 0.1
"""Largest such change of the rate: a tenth of the 1 ″/s that the paper asks for. ASSUMPTION."""
LOST_ARCSEC: Final = 60.0
"""An axis this far off does not follow, and no shift of its target will help. ASSUMPTION."""
NUDGE_ARCSEC: Final = 5.0
"""A mean error beyond half the 10″ objective is taken out at once. ASSUMPTION."""


class Pointing:
    """The star the telescope is on, or on its way to."""

    def __init__(self, client: Client, mount: Mount) -> None:
        self.client = client
        self.mount = mount
        self.track: StarTrack | None = None
        self.on_target = False
        self.tracking = False
        self.commanding = False
        """Whether `follow` has rates on their way or is about to."""
        self.guided = 0
        """Pulses under way: `follow` leaves the rates to them."""
        self.trims = [0.0, 0.0]
        self._errors_ns = -1
        self._errors: tuple[float, float] | None = None

    def errors_arcsec(self) -> tuple[float, float] | None:
        """Star less encoder on both axes, ″ of the axis; None before there is a star or a reading.

        The star's place is taken for the moment the encoder was latched, as the frame's age tells.
        """
        if self.track is None:
            return None
        if self._errors_ns != self.client.now_ns:  # several ask within a tick
            self._errors_ns = self.client.now_ns
            self._errors = self._measure(self.track)
        return self._errors

    def _measure(self, track: StarTrack) -> tuple[float, float] | None:
        errors = []
        for index, encoder in enumerate(ENCODERS):
            reading = self.client.position(encoder)
            if reading is None:
                return None
            latched_s = self.client.latched_s(encoder, reading)
            errors.append((track.steps(latched_s)[index] - reading.position) * STEP_ARCSEC)
        return errors[0], errors[1]

    def goto(self, track: StarTrack, classes: tuple[str, ...] = CLASSES) -> Procedure:
        """Bring both axes onto the star, one speed class after the other, and leave them moving with it."""
        self.on_target = self.tracking = False
        self.track = track
        self._errors_ns = -1
        for name in classes:
            yield from self._send_rates()
            steps = track.steps(self.client.now_s)
            for axis, target in zip(BOARDS, steps, strict=True):
                yield from self.client.ask(axis, Opcode.MOVE_TO, target, SpeedClass[name.upper()])
            reach = REACH[name]
            what = f"{track.star.name}: within {reach.arcsec:g}″ at {name} speed"
            yield from self.client.until(what, partial(self._within, reach.arcsec), reach.timeout_s)
        yield from self._settle(REACH[classes[-1]])
        self.on_target = True

    def follow(self, seconds: float) -> Procedure:
        """Track: refresh the rates and take out what the encoders show to be missing.

        The boards' crystals are off by some 50 ppm: 0.05″ a minute that only the PC's clock can see.
        """
        if self.track is None:
            raise ClientError("track: there is no target yet; go to one first")
        self.tracking = True
        end_ns = self.client.now_ns + round(seconds * 1e9)
        trims = self.trims = [0.0, 0.0]
        while self.client.now_ns < end_ns:
            self.commanding = True
            yield from self._send_rates((trims[0], trims[1]))
            self.commanding = False
            sums, count = [0.0, 0.0], 0
            part_end_ns = min(end_ns, self.client.now_ns + round(REFRESH_S * 1e9))
            while self.client.now_ns < part_end_ns or self.guided:
                errors = self.errors_arcsec()
                if self.guided:  # it lags behind a pulse, which is no drift
                    sums, count = [0.0, 0.0], 0
                elif errors is not None:
                    sums, count = [total + each for total, each in zip(sums, errors, strict=True)], count + 1
                yield
            for index, axis in enumerate(BOARDS):
                mean = sums[index] / max(count, 1)
                if abs(mean) > LOST_ARCSEC:
                    name = self.track.star.name if self.track is not None else "its target"
                    raise ClientError(f"{axis.name}: does not follow {name}, {mean:.0f}″ off")
                trims[index] = min(max(mean / TRIM_S, -TRIM_ARCSEC_S), TRIM_ARCSEC_S)
                if abs(mean) > NUDGE_ARCSEC:
                    yield from self.client.ask(axis, Opcode.NUDGE, round(mean / STEP_ARCSEC))
        self.tracking = False

    def park(self) -> Procedure:
        """Move to the park position, then switch the axes off."""
        self.track, self.on_target, self.tracking = None, False, False
        goals = self.mount.park_steps
        for axis in BOARDS:
            yield from self.client.ask(axis, Opcode.TRACK_RATE, 0)
        for name in CLASSES[:3]:
            for axis, goal in zip(BOARDS, goals, strict=True):
                yield from self.client.ask(axis, Opcode.MOVE_TO, goal, SpeedClass[name.upper()])
            reach = REACH[name]
            near = partial(self._near_steps, goals, reach.arcsec)
            yield from self.client.until(
                f"park: within {reach.arcsec:g}″ at {name} speed", near, reach.timeout_s
            )
        yield from power_off(self.client)

    def _send_rates(self, trims: tuple[float, float] = (0.0, 0.0)) -> Procedure:
        assert self.track is not None
        rates = self.track.rates(self.client.now_s)
        for axis, rate, trim in zip(BOARDS, rates, trims, strict=True):
            yield from self.client.ask(axis, Opcode.TRACK_RATE, rate_q16(rate + trim))

    def _settle(self, reach: Reach) -> Procedure:
        assert self.track is not None
        start_ns = since_ns = self.client.now_ns
        while self.client.now_ns - since_ns < SETTLED_S * 1e9:
            if not self._within(reach.arcsec):
                since_ns = self.client.now_ns + 1
            if self.client.now_ns - start_ns > reach.timeout_s * 1e9:
                raise ClientError(f"{self.track.star.name}: does not stay within {reach.arcsec:g}″")
            yield

    def _within(self, arcsec: float) -> bool:
        errors = self.errors_arcsec()
        return errors is not None and max(abs(each) for each in errors) <= arcsec

    def _near_steps(self, goals: tuple[int, int], arcsec: float) -> bool:
        for encoder, goal in zip(ENCODERS, goals, strict=True):
            reading = self.client.position(encoder)
            if reading is None or abs(reading.position - goal) * STEP_ARCSEC > arcsec:
                return False
        return True
