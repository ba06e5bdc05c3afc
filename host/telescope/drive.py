"""What the axes do: one thing at a time, and tracking again when it has ended, if tracking is on."""

import math
from dataclasses import replace

from bus.protocol import AxisMode, Device, Opcode, unpack_target
from bus.protocol.scales import rate_q16
from bus.units import ARCSEC_PER_RAD
from host.client import Client, ClientError, Procedure
from host.logs.journal import Logs
from host.procedures import manual
from host.procedures.pointing import ENCODERS, Pointing
from host.sky.angles import format_degrees
from host.sky.catalogue import Star
from host.sky.mount import STEP_ARCSEC
from host.sky.observed import Observed, equatorial, observe, star_of_apparent
from host.sky.pointfit import TooFewStars, fit
from host.sky.pointmodel import PointingModel
from host.sky.pointstars import Sighting
from host.sky.tracks import DriveRate, GroundTrack, SkyTrack, StarTrack
from host.sky.visibility import BelowHorizon, Observatory, Unreachable, check_reachable
from host.telescope.jobs import Activity, Job, Reason, Refused

_FOREVER_S = 1e6
_REST_COUNTS = 2
"""Counts in 5 ms that still count as rest, 4.6 ″/s: quantisation and the loop's ripple. ASSUMPTION."""
_REST_S = 15.0
"""A stop from 3°/s at 2°/s² takes 1.5 s; ten times that is a fault. ASSUMPTION."""
_PARK_ARCSEC = 60.0
"""As near to the park position as this, unpowered, counts as parked at the start. ASSUMPTION."""
_SUMMARY_S = 0.6
"""Two TARGET frames: the axis board has told how far off it is since the command."""
_LOCK_S = 8.0
"""Until an axis has settled into the sky's motion; friction makes it creep there. ASSUMPTION."""
_LOCK_ARCSEC = 1.0
"""As near as this to where the board wants to be. ASSUMPTION: a fifth of the board's own `settled`."""
_GUARD_NS = 1_000_000_000
SYNC_LIMIT_RAD = math.radians(10.0)
"""The encoders are absolute: what differs by more is another star or a wrong clock. ASSUMPTION."""
_MOVING = (Activity.SLEWING, Activity.PARKING, Activity.PADDLE, Activity.POWERING)


class Drive:
    """Goes to, follows, stops, parks. Commands start a `Job` or raise `Refused`; nothing waits.

    tracking: whether the axes follow the sky when nothing else moves them.
    parked: None until the first readings have come in.
    dec_bias_q8: PWM steps in Q8 that take declination's motors across the dead zone of their power stage. It
        stands, so a guider's pulse turns its effort over; from −85 to 85 steps of 3000 nothing would move.
    """

    def __init__(self, client: Client, observatory: Observatory, logs: Logs) -> None:
        self.client = client
        self.observatory = observatory
        self.logs = logs
        self.pointing = Pointing(client, observatory.mount)
        self.job: Job[None] | None = None
        self.tracking = False
        self.parked: bool | None = None
        self.drive_rate = DriveRate.SIDEREAL
        self.drift_arcsec_s = (0.0, 0.0)
        self.dec_bias_q8 = 0
        self._guard_ns = 0
        self._altitude_rad = math.pi

    # --- what is the case ---
    @property
    def activity(self) -> Activity:
        """What the axes are busy with."""
        return self.job.activity if self.job is not None and self.job.running else Activity.IDLE

    @property
    def powered(self) -> bool:
        """Whether both axes say that their outputs are on."""
        return all(manual.powered(self.client, axis) for axis in manual.BOARDS)

    def readings(self) -> tuple[int, int, float]:
        """Encoders of both axes and when they were latched, in seconds; refused before the first frames."""
        ra, dec = (self.client.position(encoder) for encoder in ENCODERS)
        if ra is None or dec is None:
            raise Refused(Reason.SILENT, "no position has been received yet")
        return ra.position, dec.position, self.client.latched_s(ENCODERS[0], ra)

    def here(self) -> Star:
        """The place in the sky the telescope points at, as a star to follow."""
        ra, dec, t_s = self.readings()
        place = self.observatory.apparent(ra, dec, t_s)
        return star_of_apparent(place, self.observatory.clock, t_s, "here")

    # --- commands ---
    def power_on(self, check: bool = True) -> Job[None]:
        """Health check, then both axes on; ends being parked."""
        self._still()
        return self.begin("power on", self.power(check), Activity.POWERING)

    def wake(self) -> None:
        """Track, after powering up where that is needed; ends being parked."""
        if self.parked:
            self.tracking = True
            self.begin("wake up", self.power(), Activity.POWERING)
        else:
            self.track(True)

    def power_off(self) -> Job[None]:
        """Stop, then both axes off."""
        self.tracking = False
        return self.begin("power off", self._power_off(), Activity.STOPPING)

    def goto(self, star: Star, wake: bool = False) -> Job[None]:
        """Go to a star and track it. A parked telescope refuses, unless `wake` has it powered up first."""
        self.unparked(wake)
        try:
            check_reachable(star, self.observatory, self.client.now_s)
        except BelowHorizon as error:
            raise Refused(Reason.BELOW_HORIZON, str(error)) from None
        except Unreachable as error:
            raise Refused(Reason.LIMIT, str(error)) from None
        self.tracking = True
        return self.begin(
            f"slew to {star.name}", self._slew(self._track_of(star, drifting=False)), Activity.SLEWING
        )

    def goto_altaz(self, azimuth_rad: float, altitude_rad: float, wake: bool = False) -> Job[None]:
        """Go to a place over the ground (observed, azimuth north through east) and stand there."""
        self.unparked(wake)
        place = equatorial(azimuth_rad, altitude_rad, self.observatory.site)
        self._reachable(place)
        self.tracking = False
        about = self.observatory
        track = GroundTrack(place, about.site, about.clock, about.mount)
        return self.begin("slew to altitude and azimuth", self._slew(track), Activity.SLEWING)

    def track(self, on: bool) -> None:
        """Follow the sky where the telescope points, or stop following."""
        if on:
            self.unparked(False)
        if on == self.tracking:
            return
        self.tracking = on
        if self.activity in (Activity.IDLE, Activity.TRACKING):
            self.begin("track" if on else "stop", self._ready() if on else self.settle(), Activity.STOPPING)

    def set_rates(
        self, rate: DriveRate | None = None, drift_arcsec_s: tuple[float, float] | None = None
    ) -> None:
        """Follow the Moon or the Sun, or drift against the sky (hour angle positive west, declination)."""
        self.drive_rate = rate or self.drive_rate
        self.drift_arcsec_s = drift_arcsec_s or self.drift_arcsec_s
        if self.activity is Activity.TRACKING:
            self._lock_on()

    def abort(self) -> None:
        """End a slew, a move by hand or parking; tracking goes on where the telescope stops, if it is on."""
        if self.activity in _MOVING:
            self.begin("abort", self.settle(), Activity.STOPPING)

    def stop(self) -> Job[None]:
        """Stop both axes and stay there."""
        self.tracking = False
        return self.begin("stop", self.settle(), Activity.STOPPING)

    def park(self) -> Job[None]:
        """Go to the park position and switch the axes off."""
        self.tracking = False
        if self.parked:
            return self.begin("park", self.client.wait(0.0), Activity.STOPPING)
        return self.begin("park", self._park(), Activity.PARKING)

    def set_park(self) -> None:
        """Park where the telescope points now, from now on."""
        ra, dec, _ = self.readings()
        about, mount = self.observatory, self.observatory.mount
        angles = mount.ra.angle_rad(ra), mount.dec.angle_rad(dec)
        about.mount = replace(mount, park_hour_angle_rad=angles[0], park_declination_rad=angles[1])

    def sync(self, star: Star) -> tuple[float, float]:
        """The telescope points at this star: align the encoders. Returns the offsets found, ″.

        The star is kept for a pointing model.
        """
        self._still()
        ra, dec, t_s = self.readings()
        about = self.observatory
        expected = SkyTrack(star, about.site, about.clock, about.mount).steps(t_s)
        offsets = (ra - expected[0], dec - expected[1])
        arcsec = (offsets[0] * STEP_ARCSEC, offsets[1] * STEP_ARCSEC)
        away_rad = max(map(abs, arcsec)) / ARCSEC_PER_RAD
        if away_rad > SYNC_LIMIT_RAD:
            far = format_degrees(away_rad)
            raise Refused(
                Reason.STATE, f"the encoders say {far} from there: not the same star, or the clock is wrong"
            )
        h, d, *_ = observe(star, about.site, about.clock, t_s)
        about.stars += (Sighting(hour_angle_rad=h, declination_rad=d, ra_steps=ra, dec_steps=dec),)
        ra_scale, dec_scale = about.mount.ra.aligned(offsets[0]), about.mount.dec.aligned(offsets[1])
        about.mount = replace(about.mount, ra=ra_scale, dec=dec_scale)
        text = f"aligned: hour angle {arcsec[0]:.1f}″, declination {arcsec[1]:.1f}″"
        self.logs.status(self.client.now_ns, "HOST", text)
        if self.activity is Activity.TRACKING:
            self._follow(star)
        return arcsec

    def fit_model(self) -> PointingModel:
        """The pointing model of the stars that the telescope was synchronised on; moves nothing."""
        try:
            about = self.observatory
            return fit(about.stars, about.mount, about.site.latitude_rad)
        except TooFewStars as error:
            raise Refused(Reason.STATE, str(error)) from None

    def apply_model(self, model: PointingModel | None) -> None:
        """Point by a model, or by the encoders alone; tracking goes on where the telescope is."""
        self._still()
        self.observatory.mount = replace(self.observatory.mount, model=model)
        terms = "none" if model is None else " ".join(f"{t.name}={t.arcsec:.1f}″" for t in model.terms)
        self.logs.status(self.client.now_ns, "HOST", f"pointing model: {terms}")
        if self.activity is Activity.TRACKING:
            self._lock_on()

    # --- the ticking thread ---
    def tick(self) -> None:
        """Go on with what the axes do, and with tracking when it has ended."""
        if self.parked is None:
            self._look_whether_parked()
        self._guard()
        job = self.job
        if job is None or not job.running:
            return
        job.advance()
        if job.running:
            return
        if job.failed:
            self._failed(job)
        elif self.tracking:
            track = self.pointing.track if job.activity is Activity.SLEWING else None
            if track is not None:
                self._follow(track.star)
            else:
                self._lock_on()

    def _failed(self, job: Job[None]) -> None:
        self.logs.error(self.client.now_ns, "HOST", f"{job.name}: {job.failed}")
        self.tracking = False
        if job.activity in (*_MOVING, Activity.TRACKING) and self.powered:
            self.begin("stop", self.settle(), Activity.STOPPING)

    def _guard(self) -> None:
        """Nothing that sinks goes on below the horizon limit; the boards watch the soft limits."""
        now_ns = self.client.now_ns
        if now_ns < self._guard_ns or self.activity not in (Activity.TRACKING, Activity.PADDLE):
            return
        self._guard_ns = now_ns + _GUARD_NS
        ra, dec, _ = self.readings()
        altitude, before = self.observatory.observed(ra, dec).altitude_rad, self._altitude_rad
        self._altitude_rad = altitude
        if altitude < self.observatory.horizon_rad and altitude < before:
            self.logs.error(now_ns, "HOST", f"stopped at the horizon limit, {format_degrees(altitude)}")
            self.stop()

    def _look_whether_parked(self) -> None:
        motions = [self.client.motion(axis) for axis in manual.BOARDS]
        readings = [self.client.position(encoder) for encoder in ENCODERS]
        if None not in motions and None not in readings:
            self.parked = not self.powered and self._at_park()
            if motions[0] is not None and motions[0].mode == AxisMode.TRACK:
                self.tracking = True  # a host before this one has left the axes following the sky
                self._lock_on()

    def _at_park(self) -> bool:
        ra, dec, _ = self.readings()
        off = (here - there for here, there in zip((ra, dec), self.observatory.mount.park_steps, strict=True))
        return max(map(abs, off)) * STEP_ARCSEC < _PARK_ARCSEC

    # --- procedures ---
    def begin(self, name: str, procedure: Procedure, activity: Activity) -> Job[None]:
        """Give up what the axes do and start this; how `Paddle` moves them, too."""
        if self.job is not None:
            self.job.cancel(f"given up for: {name}")
        for axis in manual.BOARDS:
            self.client.forget(axis)
        if activity is not Activity.TRACKING:
            self.logs.status(self.client.now_ns, "HOST", name)
        self.job = Job(name, procedure, activity)
        return self.job

    def _follow(self, star: Star) -> None:
        track = self._track_of(star)
        self.pointing.track = track
        self.begin(f"track {star.name}", self.pointing.follow(_FOREVER_S), Activity.TRACKING)

    def _lock_on(self) -> None:
        self.begin("track", self._follow_here(), Activity.TRACKING)

    def _follow_here(self) -> Procedure:
        """Move with the sky first and look then where that is: no jump, and nothing to catch up with."""
        self.pointing.commanding = True
        rates = self._track_of(self.here()).rates(self.client.now_s)
        for axis, rate in zip(manual.BOARDS, rates, strict=True):
            yield from self.client.ask(axis, Opcode.TRACK_RATE, rate_q16(rate))
        yield from self.client.wait(_SUMMARY_S)
        end_ns = self.client.now_ns + round(_LOCK_S * 1e9)
        while self.client.now_ns < end_ns and not all(map(self._locked, manual.BOARDS)):
            yield
        self.pointing.track = self._track_of(self.here())
        yield from self.pointing.follow(_FOREVER_S)

    def _locked(self, axis: Device) -> bool:
        data = self.client.link.summaries.get(axis)
        return data is not None and abs(unpack_target(data).distance) * STEP_ARCSEC < _LOCK_ARCSEC

    def _track_of(self, star: Star, drifting: bool = True) -> SkyTrack:
        about = self.observatory
        self.pointing.mount = about.mount
        extra = self.drive_rate.value - DriveRate.SIDEREAL.value
        drift = (self.drift_arcsec_s[0] + extra, self.drift_arcsec_s[1]) if drifting else (0.0, 0.0)
        return SkyTrack(star, about.site, about.clock, about.mount, drift, self.client.now_s)

    def power(self, check: bool = True) -> Procedure:
        """Power up unless it is done; the first part of every move."""
        if not self.powered:
            yield from manual.power_on(self.client, check, self.dec_bias_q8)
        self.parked = False

    def _ready(self) -> Procedure:
        yield from self.power()
        yield from self.settle()

    def _power_off(self) -> Procedure:
        yield from self.settle()
        yield from manual.power_off(self.client)
        self.parked = self._at_park()

    def _slew(self, track: StarTrack) -> Procedure:
        self.pointing.track, self.pointing.on_target = track, False
        yield from self.power()
        yield from self.pointing.goto(track)

    def _park(self) -> Procedure:
        yield from self.power()
        self.pointing.mount = self.observatory.mount
        yield from self.pointing.park()
        self.parked = True

    def settle(self) -> Procedure:
        """Stop both axes and wait until they rest; the other one also where a board does not answer."""
        failed: ClientError | None = None
        for axis in manual.BOARDS:
            try:
                yield from self.client.ask(axis, Opcode.STOP)
            except ClientError as error:
                failed = failed or error
        if failed is not None:
            raise failed
        if self.powered:
            yield from self.client.until("stop: both axes at rest", self._at_rest, _REST_S)

    def _at_rest(self) -> bool:
        motions = [self.client.motion(axis) for axis in manual.BOARDS]
        return all(motion is not None and abs(motion.velocity) <= _REST_COUNTS for motion in motions)

    # --- refusals ---
    def unparked(self, wake: bool) -> None:
        """Refuse while parked, unless the caller wakes the telescope."""
        if self.parked and not wake:
            raise Refused(Reason.PARKED, "the telescope is parked")

    def _still(self) -> None:
        if self.activity in _MOVING:
            raise Refused(Reason.STATE, "the axes are moving")

    def _reachable(self, place: Observed) -> None:
        mount = self.observatory.mount
        if place.altitude_rad < self.observatory.horizon_rad:
            text = f"altitude {format_degrees(place.altitude_rad)} is below the horizon limit"
            raise Refused(Reason.BELOW_HORIZON, text)
        axes = ("hour angle", mount.ra), ("declination", mount.dec)
        for (name, scale), angle in zip(axes, place[:2], strict=True):
            if not scale.within(angle):
                raise Refused(Reason.LIMIT, f"{name} {format_degrees(angle)} is beyond the soft limits")
