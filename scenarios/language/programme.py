"""The steps of a scenario in their order: which may start, which run, which have ended and when."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from bus.protocol import Device, Opcode
from host.client import Client, ClientError, Procedure
from host.logs.journal import AsciiLogs
from host.procedures import dome, focus, manual
from host.procedures.autoguide import Guided, Guiding, autoguide
from host.procedures.pointing import CLASSES, Pointing
from host.procedures.pointing_run import Eye, Visit, directions, visit
from host.sky.catalogue import Star
from host.sky.pointfit import TooFewStars, fit
from host.sky.pointmodel import PointingModel
from host.sky.tracks import StarTrack
from host.sky.visibility import Unreachable, check_reachable
from scenarios.language import configure
from scenarios.language.model import STARS, Scenario, Step, target_of


@dataclass(frozen=True)
class Record:
    """What became of a step. Times in seconds; None: not yet."""

    step: Step
    start_s: float | None = None
    end_s: float | None = None
    failed: str = ""
    star: Star | None = None
    focus_goal: float | None = None
    """Where a focus step sends the housing, half steps."""
    visits: tuple[Visit, ...] = ()
    """Stars of a pointing run."""
    model: PointingModel | None = None
    """The pointing model of the visits."""
    guided: tuple[Guided, ...] = ()
    """Exposures of a guide camera so far."""


class Programme:
    """Starts and advances the steps; called once per tick of the client."""

    def __init__(self, scenario: Scenario, client: Client, logs: AsciiLogs, eye: Eye) -> None:
        self.records = [Record(step) for step in scenario.steps]
        self.pointing = Pointing(client, scenario.mount)
        self.failed = False
        self._scenario = scenario
        self._client = client
        self._logs = logs
        self._eye = eye
        self._running: dict[int, Procedure] = {}
        self._waiting = list(range(len(self.records)))
        self._before = [self._predecessors(index) for index in self._waiting]
        self._ready_since_s: dict[int, float] = {}
        self._due_s: dict[int, float] = {}
        """Since when a step may start but for its `when`: its timeout counts from there."""
        self._stopping: Procedure | None = None

    @property
    def finished(self) -> bool:
        """All steps have ended, or one has failed."""
        return self.failed or not (self._waiting or self._running)

    def tick(self, t_ns: int) -> None:
        """Start what may start, advance what runs; after a failure, stop the axes."""
        if self.failed:
            self._stop()
            return
        if self._waiting:
            self._start_ready(t_ns * 1e-9)
        for index in list(self._running):
            if not self.failed:
                self._advance(index, t_ns)

    def _start_ready(self, t_s: float) -> None:
        for index in list(self._waiting):
            if self._may_start(index, t_s):
                self._waiting.remove(index)
                self._start(index, t_s)
            elif self._late(index, t_s):
                step = self.records[index].step
                self._fail(index, t_s, f"not {step.when} within {step.timeout_s:g} s")
            if self.failed:
                return

    def _stop(self) -> None:
        """Nobody watches a telescope whose programme has failed."""
        if self._stopping is None:
            self._stopping = manual.stop(self._client, "both")
        with suppress(StopIteration, ClientError):
            next(self._stopping)

    def _may_start(self, index: int, t_s: float) -> bool:
        step = self.records[index].step
        if step.at_s is not None and t_s < step.at_s:
            return False
        for before in reversed(self._before[index]):  # the last one is the likeliest not to have ended
            if self.records[before].end_s is None:
                return False
        if t_s - self._ready_since_s.setdefault(index, t_s) < step.delay_s:
            return False
        self._due_s.setdefault(index, t_s)
        return step.when is None or self._holds(step.when)

    def _late(self, index: int, t_s: float) -> bool:
        """Whether a step's timeout is over, the wait for its `when` included."""
        timeout_s = self.records[index].step.timeout_s
        return timeout_s is not None and t_s - self._due_s.get(index, t_s) > timeout_s

    def _predecessors(self, index: int) -> list[int]:
        """What has to end before a step may start."""
        steps = [record.step for record in self.records]
        after = steps[index].after
        if after is not None:
            return [before for before in range(index) if steps[before].name == after]
        # in line: everything before, except what runs beside the line because of its `after`
        return [before for before in range(index) if steps[before].after is None]

    def _holds(self, condition: str) -> bool:
        axes = [self._client.motion(axis) for axis in manual.BOARDS]
        conditions: dict[str, Callable[[], bool]] = {
            "powered": lambda: all(manual.powered(self._client, axis) for axis in manual.BOARDS),
            "on_target": lambda: self.pointing.on_target,
            "tracking": lambda: self.pointing.tracking,
            "stopped": lambda: all(motion is not None and not motion.velocity for motion in axes),
        }
        return conditions[condition]()

    def _note(self, index: int, **became: Any) -> None:
        """Fields of a step's record."""
        self.records[index] = replace(self.records[index], **became)

    def _start(self, index: int, t_s: float) -> None:
        self._note(index, start_s=t_s)
        self._logs.status(self._client.now_ns, "HOST", f"step {self.records[index].step.name!r} starts")
        try:
            self._running[index] = self._procedure(index, t_s)
        except (ClientError, Unreachable) as error:
            self._fail(index, t_s, str(error))

    def _advance(self, index: int, t_ns: int) -> None:
        step, t_s = self.records[index].step, t_ns * 1e-9
        try:
            next(self._running[index])
        except StopIteration:
            del self._running[index]
            self._note(index, end_s=t_s)
            self._logs.status(t_ns, "HOST", f"step {step.name!r} is done")
        except (ClientError, Unreachable) as error:
            self._fail(index, t_s, str(error))
        else:
            if self._late(index, t_s):
                self._fail(index, t_s, f"not done within {step.timeout_s:g} s")

    def _fail(self, index: int, t_s: float, reason: str) -> None:
        self._note(index, failed=reason, end_s=t_s)
        self.failed = True
        self._running.clear()
        self._waiting.clear()
        for place, other in enumerate(self.records):  # whatever ran beside it ends here as well
            if other.start_s is not None and other.end_s is None:
                self._note(place, failed="given up", end_s=t_s)
        step = self.records[index].step
        self._logs.error(self._client.now_ns, "HOST", f"step {step.name!r} failed: {reason}")

    def _procedure(self, index: int, t_s: float) -> Procedure:
        step, client, scenario = self.records[index].step, self._client, self._scenario
        given = step.arguments
        match step.action:
            case "power_on":
                return manual.power_on(client, given.get("health_check", True))
            case "goto":
                star = target_of(given["target"], step.where)
                self._note(index, star=star)
                check_reachable(star, scenario, t_s)
                track = StarTrack(star, scenario.site, scenario.clock, scenario.mount)
                return self.pointing.goto(track, tuple(given.get("classes", CLASSES)))
            case "track":
                self._note(index, star=self.pointing.track.star if self.pointing.track else None)
                return self.pointing.follow(given["for"])
            case "autoguide":
                self._note(index, star=self.pointing.track.star if self.pointing.track else None)

                def told(frame: Guided) -> None:
                    self._note(index, guided=(*self.records[index].guided, frame))

                return autoguide(self.pointing, scenario, self._eye, guiding_of(given), told)
            case "pointing_run":
                return self._pointing_run(index, given.get("stars", STARS), given.get("fit", True))
            case "move":
                return manual.hold_button(
                    client, given["axis"], given["class"], given["direction"], given["for"]
                )
            case "set_rate":
                return manual.set_rate(client, given["axis"], given["rate"], given["for"])
            case "open_loop":
                return manual.open_loop(client, given["axis"], given["effort"], given["for"])
            case "stop":
                return manual.stop(client, given.get("axis", "both"))
            case "power_off":
                return manual.power_off(client)
            case "focus":
                goal, procedure = _focus(client, given)
                self._note(index, focus_goal=goal)
                return procedure
            case "dome":
                _device(client, "DOME")
                if "azimuth" in given:
                    return dome.turn(client, given["azimuth"] / 3600)
                return dome.shutter(client, given["shutter"] == "open")
            case "park":
                return self.pointing.park()
            case "wait":
                return client.wait(given["for"])
            case "firmware":
                return configure.firmware(client, given["of_axes"])
            case "compensation":
                table = given["table"]
                return manual.load(client, manual.AXES[table.axis], table.parameters())
            case "set_parameter":
                device = _device(client, given["node"])
                return client.ask(device, Opcode.SET_PARAMETER, given["parameter"], given["value"])
            case "display":
                return client.ask(_device(client, "DISPLAY"), Opcode.BRIGHTNESS, given["brightness"])
        raise AssertionError(f"the schema knows {step.action!r}, the programme does not")

    def _pointing_run(self, index: int, count: int, fits: bool) -> Procedure:
        """Look at stars all over the sky; then point by the model that they give."""
        scenario = self._scenario
        where = directions(count, scenario, float(index))
        visits = yield from visit(self.pointing, scenario, where, self._eye)
        self._note(index, visits=visits)
        if not fits:
            return
        try:
            model = fit([each.sighting for each in visits], scenario.mount, scenario.site.latitude_rad)
        except TooFewStars as error:
            raise ClientError(str(error)) from None
        mount = replace(scenario.mount, model=model)
        self._scenario, self.pointing.mount = replace(scenario, mount=mount), mount
        self._note(index, model=model)


def guiding_of(given: Mapping[str, Any]) -> Guiding:
    """What an autoguide step asks for."""
    return Guiding(
        seconds=given["for"],
        exposure_s=given.get("exposure", 2.0),
        aggressiveness=given.get("aggressiveness", 0.7),
        by_rate=given.get("by") == "rate",
    )


def _device(client: Client, name: str) -> Device:
    for device in client.devices:
        if device.name == name:
            return device
    raise ClientError(f"{name} is not on this network")


def _focus(client: Client, given: dict[str, float | str | bool]) -> tuple[float | None, Procedure]:
    """Where a focus step sends the housing, half steps, if anywhere; and how."""
    now = client.focus()
    if "to" in given:
        return float(given["to"]), focus.move_to(client, float(given["to"]))
    if "by" in given:
        by = float(given["by"])
        return now.position + by if now is not None else None, focus.step_by(client, by)
    if "state" in given:
        return None, focus.set_state(client, str(given["state"]))
    return None, focus.reference(client)
