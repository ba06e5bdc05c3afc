"""`schmidt serve [SCENARIO] [doors]`: the network in real time, for others to join."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from io import BytesIO

from rich.console import Console
from rich.live import Live

from bus.can.candump import CandumpWriter
from bus.outside.pacer import checked_speed
from plant.model import PlantModel
from scenarios.doors.door import Door, Keeper
from scenarios.doors.host_door import HostProcess
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.loop import Loop, first
from scenarios.doors.making import attached, check, make_doors
from scenarios.doors.options import ServeOptions
from scenarios.doors.parking import interrupts, park
from scenarios.doors.recording import Recording
from scenarios.doors.snapshots import Snapshots, standing
from scenarios.doors.steps import Steps
from scenarios.lab.muted import Feed
from scenarios.lab.prepare import chosen
from scenarios.lab.snapshot.file import read
from scenarios.lab.wiring import wire
from scenarios.language.model import Scenario

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
    if options.muted is not None and (options.record is not None or options.snapshots is not None):
        raise ValueError(
            "--mute with --record or --snapshots: frames fed from a log are not recorded; leave one out"
        )
    stood = None if options.begun is None else standing(read(options.begun))
    if stood is None:
        scenario, model = chosen(options.scenario, options.seed, options.plant, options.network)
    else:
        scenario, model = stood.scenario, stood.model
    # no thread that refreshes: it would hold Python's lock when a tick is due
    with Live(
        "starting (the first time compiles)", console=console, auto_refresh=False, transient=True
    ) as line:
        line.refresh()
        folder = options.record
        recording = None if folder is None else Recording(folder, options.begun)
        served = LiveNetwork(scenario, model, options.speed, recording, stood)
        if options.clock == "steps":
            served.steps = Steps(served)
        if options.snapshots is not None:
            Snapshots(options.snapshots, served, recording)
        if options.muted is not None:
            Feed(served.network, *options.muted)
        doors = make_doors(options, served, console.print)
        if recording is not None:
            recording.attach(served)
        keepers = [Keeper(door, console.print) for door in doors]
        show = partial(line.update, refresh=True) if console.is_terminal else lambda _text: None
        loop = Loop(served, keepers, console, show, options.duration, recording)
        try:
            _warm_up(scenario, model)
            for keeper in keepers:
                keeper.open()
            _say_hello(console, served, doors)
            with interrupts(served.stop), _ahead(options) as said:
                if said is not None:
                    console.print(said, soft_wrap=True)
                loop.run()
        finally:
            for keeper in keepers:
                keeper.close()
            try:
                ended = park(served, console.print) if served.steps is None else "left where they stood"
            finally:
                digest = recording.close(served.now_ns) if recording is not None else ""
    _say_goodbye(console, loop, served, doors)
    console.print(ended, soft_wrap=True)
    if recording is not None:
        told = f"recorded in {folder}, digest {digest[:16]}; schmidt replay {folder} repeats it"
        console.print(told, markup=False, soft_wrap=True)
    return 0


def _ahead(options: ServeOptions) -> AbstractContextManager[str | None]:
    """Real-time priority, where it is meant; quicker than the wall, ticks would leave others no processor."""
    if options.realtime is None and (options.clock == "steps" or options.speed > 1):
        return nullcontext()
    return nullcontext() if options.realtime is False else first(asked=options.realtime is True)


def _warm_up(scenario: Scenario, model: PlantModel) -> None:
    """Another network for a moment, and a log, so that all is compiled and imported before time starts."""
    network, log = wire(scenario, model), CandumpWriter(BytesIO())
    network.wire.tap(log.take)
    network.run_until(_WARM_NS)
    log.flush()


def _say_hello(console: Console, served: LiveNetwork, doors: Sequence[Door]) -> None:
    count, boards, speed = len(served.network.boards), list(served.lines.uarts), served.pacer.speed
    pace = f"at {speed:g} times real time" if served.steps is None else "as clients step them"
    console.print(f"serving {count} boards {pace}; Ctrl-C ends it", soft_wrap=True)
    names = [name for name, _ in _states(doors) if name.startswith("--")]
    for name in names:
        text = f"  {name:{max(map(len, names))}}  {attached(name, boards).words}"
        console.print(text, markup=False, highlight=False, soft_wrap=True)


def _states(doors: Sequence[Door]) -> Iterator[tuple[str, str]]:
    """Name and state of every door, those of the host too."""
    for door in doors:
        yield from door.doors if isinstance(door, HostProcess) else [(door.name, door.state())]


def _say_goodbye(console: Console, loop: Loop, served: LiveNetwork, doors: Sequence[Door]) -> None:
    """The session in figures, and each door that somebody used."""
    console.print(loop.text(), soft_wrap=True)
    states = {name.partition(" (")[0]: state for name, state in _states(doors)}  # no token again
    for name, state in states.items():
        if state:
            console.print(f"  {name}: {state}", markup=False, highlight=False, soft_wrap=True)
    unused = ", ".join(name for name, state in states.items() if not state)
    if unused:
        console.print(f"  nobody came to {unused}", markup=False, highlight=False, soft_wrap=True)
    if served.punctual.ticks:
        console.print(served.punctual.text(), soft_wrap=True)
