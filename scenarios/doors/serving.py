"""`schmidt serve [SCENARIO] [doors]`: the network in real time, for others to join."""

import gc
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial
from io import BytesIO
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.live import Live

from bus.can.candump import CandumpWriter
from bus.outside.pacer import checked_speed
from plant.model import PlantModel
from scenarios.doors.attach import words
from scenarios.doors.control import ControlDoor
from scenarios.doors.door import Door
from scenarios.doors.interrupt import interrupts
from scenarios.doors.keeper import Keeper
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.making import check, make_doors
from scenarios.doors.options import ServeOptions
from scenarios.doors.parking import park
from scenarios.doors.priority import first
from scenarios.doors.recording import Recording
from scenarios.doors.standing import Standing
from scenarios.doors.steps import Steps
from scenarios.lab.muted import Feed, FeedError
from scenarios.lab.prepare import chosen
from scenarios.lab.wiring import wire
from scenarios.language.model import Scenario

_STATUS_S = 1.0
_WARM_NS = 20_000_000


def serve(options: ServeOptions) -> int:
    """Pace the network, or let clients step it, with its doors open, until Ctrl-C, `schmidt control stop`, or
    `duration` (wall).

    The scenario's steps are not run (see `scenarios.lab.wiring`). Returns the exit status, 0; raises
    ValueError subclasses and OSError with one line for input that cannot be used.
    """
    console = Console()
    checked_speed(options.speed)
    check(options)
    record, mute = options.record, options.muted
    if mute is not None and (record is not None or options.snapshots is not None):
        raise FeedError(
            "--mute with --record or --snapshots: frames fed from a log are not recorded; leave one out"
        )
    standing = None if options.begun is None else _standing(options.begun)
    if standing is None:
        scenario, model = chosen(options.scenario, options.seed, options.plant, options.network)
    else:
        scenario, model = standing.scenario, standing.model
    # no thread that refreshes: it would hold Python's lock when a tick is due
    with Live(
        "starting (the first time compiles)", console=console, auto_refresh=False, transient=True
    ) as line:
        line.refresh()
        recording = Recording(record, scenario, model, options.begun) if record is not None else None
        served = LiveNetwork(scenario, model, options.speed, recording, standing)
        if options.clock == "steps":
            served.steps = Steps(served)
        if options.snapshots is not None:
            from scenarios.doors.snapshots import Snapshots

            Snapshots(options.snapshots, served, recording)
        if mute is not None:
            Feed(served.network, *mute)
        doors = make_doors(options, served, console.print)
        if recording is not None:
            recording.attach(served)
        keepers = [Keeper(door, console.print) for door in doors]
        try:
            _warm_up(scenario, model)
            for keeper in keepers:
                keeper.open()
            _say_hello(console, served, doors)
            show = partial(line.update, refresh=True) if console.is_terminal else _nowhere
            loop = _Loop(served, keepers, console, show, options.duration, recording)
            with interrupts(served.stop), first() if options.realtime else nullcontext():
                loop.run()
        finally:
            for keeper in keepers:
                keeper.close()
            ended = park(served) if served.steps is None else "left where they stood"
            digest = recording.close(served.now_ns) if recording is not None else ""
    console.print(loop.text())
    for door in doors:
        console.print(f"  {door.name}: {door.state()}")
    console.print(f"{served.punctual.text()}; {ended}")
    if recording is not None:
        console.print(f"recorded in {record}, digest {digest[:16]}; schmidt replay {record} repeats it")
    return 0


def _warm_up(scenario: Scenario, model: PlantModel) -> None:
    """Another network for a moment, and a log, so that all is compiled and imported before time starts."""
    network, log = wire(scenario, model), CandumpWriter(BytesIO())
    network.wire.tap(log.take)
    network.run_until(_WARM_NS)
    log.flush()


def _standing(file: Path) -> Standing:
    from scenarios.doors.standing import standing
    from scenarios.lab.snapshot.file import read

    return standing(read(file))


def _say_hello(console: Console, served: LiveNetwork, doors: Sequence[Door]) -> None:
    boards, speed = len(served.network.boards), served.pacer.speed
    pace = f"at {speed:g} times real time" if served.steps is None else "as clients step them"
    console.print(f"serving {boards} boards {pace}; Ctrl-C ends it")
    names = [door.name for door in doors if door.name.startswith("--")]
    for name in names:
        text = f"  {name:{max(map(len, names))}}  {words(name, list(served.lines.uarts))}"
        console.print(text, markup=False, highlight=False, soft_wrap=True)


def _nowhere(_text: str) -> None:
    """The line for a terminal that is none."""


class _Loop:
    """Looks at the doors before every slice and says once a second how things stand."""

    def __init__(
        self,
        served: LiveNetwork,
        keepers: Sequence[Keeper],
        console: Console,
        show: Callable[[str], None],
        duration_s: float | None,
        recording: Recording | None,
    ) -> None:
        self._served = served
        planes = [each for each in keepers if served.steps is not None and isinstance(each.door, ControlDoor)]
        self._keepers = [each for each in keepers if each not in planes]
        self._planes = planes
        self._console = console
        self._show = show
        self._recording = recording
        self._start_s = perf_counter()
        self._start_ns = served.now_ns
        self._next_s = self._start_s + _STATUS_S
        self._flush_s = self._next_s + _STATUS_S / 2
        self._second = (self._start_s, self._start_ns, 0)
        self._slow = False
        self._duration_s = duration_s
        self._end_s: float | None = None
        self._end_wall_s = self._start_s

    def run(self) -> None:
        """Until somebody ends it."""
        gc.collect()
        gc.freeze()  # a collection that walks the whole network makes a tick late
        served = self._served
        self._start_s = now_s = perf_counter()
        self._next_s = now_s + _STATUS_S
        self._flush_s = self._next_s + _STATUS_S / 2
        self._second = (now_s, served.now_ns, 0)
        self._end_s = None if self._duration_s is None else now_s + self._duration_s
        try:
            if served.steps is None:
                served.pacer.run(each_slice=self._slice)
            else:
                served.steps.run(self._slice, self._wait)
        finally:
            served.entry.running = False
            served.punctual.counting = False
            self._end_wall_s = perf_counter()
            gc.unfreeze()

    def _slice(self) -> bool:
        """Between two slices; True when it is over."""
        served = self._served
        served.entry.running = False
        now_ns = served.now_ns
        for keeper in self._keepers:
            keeper.poll(now_ns)
        now_s = perf_counter()
        if now_s >= self._next_s:
            self._each_second(now_s)
        elif (
            now_s >= self._flush_s and self._recording is not None
        ):  # in another slice: half a millisecond each
            self._flush_s = now_s + _STATUS_S
            self._recording.flush()
        served.entry.running = True
        return self._over(now_s)

    def _wait(self, timeout_s: float) -> bool:
        """Time stands until a client says something at the control plane; True when it is over."""
        for keeper in self._planes:
            if isinstance(keeper.door, ControlDoor):
                keeper.door.wait(timeout_s)
            keeper.poll(self._served.now_ns)
        return self._over(perf_counter())

    def _over(self, now_s: float) -> bool:
        return self._served.ending or (self._end_s is not None and now_s >= self._end_s)

    def _each_second(self, now_s: float) -> None:
        self._next_s = now_s + _STATUS_S
        self._end_wall_s = now_s
        self._show(self.text())
        self._keeping_up(now_s)

    def _keeping_up(self, now_s: float) -> None:
        """Say it once when the machine is too slow, and once when it is quick enough again."""
        served = self._served
        before_s, before_ns, slips = self._second
        self._second = (now_s, served.now_ns, served.pacer.slips)
        pace = (served.now_ns - before_ns) * 1e-9 / max(now_s - before_s, 1e-9)
        slow = served.pacer.slips > slips
        if slow and not self._slow:
            wanted = served.pacer.speed
            self._console.print(
                f"this machine cannot keep up: {pace:.2f} of {wanted:g} times real time; "
                "time runs slower; boards lose no frame, what clients send too fast is refused and counted"
            )
        elif self._slow and not slow:
            self._console.print(f"keeping up again at {pace:.2f} times real time")
        self._slow = slow

    def text(self) -> str:
        """One line of how things stand."""
        served = self._served
        pace = (served.now_ns - self._start_ns) * 1e-9 / max(self._end_wall_s - self._start_s, 1e-9)
        paused = ", paused" if served.pacer.paused else ""
        return (
            f"{served.now_ns * 1e-9:.1f} s simulated at {pace:.2f} times real time{paused}, "
            f"bus load {served.network.wire.load:.1%}, {served.entry.count} entries, "
            f"{served.pacer.worst_lateness_s * 1e3:.0f} ms late at worst"
        )
