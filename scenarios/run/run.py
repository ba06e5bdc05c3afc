"""`schmidt run`: load, check, run, judge, report."""

import dataclasses
import gc
import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

from host.logs.files import FORMATS, LogError, convert, write_file
from plant.model import PlantModel
from scenarios.lab.muted import Feed
from scenarios.lab.session import Session
from scenarios.lab.snapshot.run import Order, Progress, resume
from scenarios.language.model import STARS, Scenario
from scenarios.progress import shown
from scenarios.run.evaluate import Verdict, judge
from scenarios.run.outcome import Outcome, write_guiding, write_runs
from scenarios.run.report import html

_PIECE_NS = 1_000_000_000
"""Between two pieces of simulated time files are flushed, the disk is asked for room, the bar moves."""
_FLUSH_PIECES = 10
_TAIL_NS = 1_000_000_000
"""After the last step: packets of the last quarter second still have to arrive."""


Show = Callable[[str, float, float], None]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Way:
    """How a scenario is run.

    report: draw the figures and write the page; the logs and `summary.json` come in any case.
    snapshot: taken on the way. begun: a snapshot that was read, to go on from. mute: a board and the candump
    log its frames come from.
    """

    report: bool = True
    snapshot: Order | None = None
    begun: dict[str, Any] | None = None
    mute: tuple[str, Path] | None = None


@dataclasses.dataclass
class Result:
    """A finished run."""

    summary: dict[str, Any]
    verdicts: list[Verdict]
    folder: Path
    outcome: Outcome
    interrupted: bool = False

    @property
    def passed(self) -> bool:
        """Whether every expectation holds."""
        return all(verdict.passed for verdict in self.verdicts)


def run(
    scenario: Scenario, model: PlantModel, folder: Path, progress: Show, way: Way | None = None
) -> Result:
    """Run a scenario into a folder. progress: `(step, simulated s, times real time)`, once a second of it.

    An interruption (KeyboardInterrupt) ends the run early with readable logs; a disk that is full raises
    `LogError` after everything that could be closed was closed.
    """
    way = way or Way()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LogError(f"{folder}: cannot be made: {error.strerror}") from None
    progress("starting (the first time compiles)", 0.0, 0.0)
    if way.begun is None:
        session = Session(scenario, model, folder)
        state = Progress(0, 0, round(scenario.time_limit_s * 1e9))
    else:
        session, state = resume(way.begun, folder), way.begun["progress"]
    if way.mute is not None:
        try:
            Feed(session.network, *way.mute)
        except ValueError:
            session.recorder.close()
            raise
    if way.snapshot is not None:
        way.snapshot.begin(session, way.begun)
    wall_s = time.perf_counter()
    interrupted = False
    gc.freeze()  # what is there now stays to the end: the collector need not look through it again and again
    try:
        _loop(session, state, progress, way.snapshot)
    except KeyboardInterrupt:
        interrupted = True
    except BaseException:
        session.recorder.close()
        raise
    finally:
        gc.unfreeze()
    wall_s = time.perf_counter() - wall_s
    progress("writing the report", session.network.queue.now_ns * 1e-9, 0.0)
    session.flush_traces()
    failures = session.recorder.close()
    if failures:
        raise LogError(failures[0])
    if scenario.can_log in FORMATS:
        progress(f"writing can.{scenario.can_log}", session.network.queue.now_ns * 1e-9, 0.0)
        convert(folder / "can.log", scenario.can_log, scenario.clock.iso(0.0))
    return _conclude(session, state.bus, wall_s, interrupted, way.report)


def _loop(session: Session, state: Progress, progress: Show, snapshot: Order | None = None) -> None:
    scenario, wire = session.scenario, session.network.wire
    limit_ns = round(scenario.time_limit_s * 1e9)
    start = time.perf_counter()
    while state.t_ns < state.end_ns:
        t_ns = min(state.t_ns + _PIECE_NS, state.end_ns)
        if snapshot is not None and snapshot.due(t_ns):
            session.advance(snapshot.at_ns)
            snapshot.take(session, state)
        session.advance(t_ns)
        state.bus.append((t_ns * 1e-9, (wire.bits - state.bits) * wire.bit_ns / _PIECE_NS, wire.frames))
        state.t_ns, state.bits = t_ns, wire.bits
        if len(state.bus) % _FLUSH_PIECES == 0:
            session.recorder.flush()
        if session.programme.finished and state.end_ns == limit_ns:
            state.end_ns = min(limit_ns, t_ns + _TAIL_NS)
        wall_s = time.perf_counter() - start
        if scenario.speed is not None and wall_s < t_ns * 1e-9 / scenario.speed:
            time.sleep(t_ns * 1e-9 / scenario.speed - wall_s)
            wall_s = time.perf_counter() - start
        running = [
            r.step.name for r in session.programme.records if r.start_s is not None and r.end_s is None
        ]
        progress(", ".join(running) or "ending", t_ns * 1e-9, t_ns * 1e-9 / max(wall_s, 1e-9))


def _conclude(
    session: Session, bus: list[tuple[float, float, int]], wall_s: float, interrupted: bool, report: bool
) -> Result:
    network, recorder = session.network, session.recorder
    simulated_s = network.queue.now_ns * 1e-9
    records = session.programme.records
    counters: dict[str, Any] = {
        "simulated_s": simulated_s,
        "wall_s": wall_s,
        "real_time_factor": simulated_s / max(wall_s, 1e-9),
        "bus_load": network.wire.load,
        "frames": network.wire.frames,
        "frame_errors": sum(network.wire.errors.values()),
        "overruns": sum(network.overruns.values()),
        "dropped": sum(network.dropped.values()),
        "error_log_entries": recorder.ascii.error_entries,
        "steps_completed": sum(r.end_s is not None and not r.failed for r in records),
        "silent_faults": sum(each.first_ns is None for each in session.faults.evidence),
        "interrupted": interrupted,
    }
    outcome = Outcome(
        recorder.folder, session.scenario, records, counters, bus, session.faults.evidence,
        session.plant.model.mount,
    )  # fmt: skip
    write_runs(outcome)
    write_guiding(outcome)
    verdicts = judge(outcome)
    summary = _summary(session, outcome, verdicts)
    text = json.dumps(summary, indent=2, ensure_ascii=False)
    write_file(recorder.folder / "summary.json", text + "\n")
    if report:
        html.write(outcome, verdicts, summary)
    return Result(summary, verdicts, recorder.folder, outcome, interrupted)


def _summary(session: Session, outcome: Outcome, verdicts: list[Verdict]) -> dict[str, Any]:
    scenario = session.scenario
    return {
        "scenario": scenario.name,
        "trace_digest": session.recorder.digest(),
        **outcome.counters,
        "expectations": [verdict.as_json() for verdict in verdicts],
        "passed": all(verdict.passed for verdict in verdicts),
        "seed": scenario.seed,
        "plant": session.plant.model.name,
        "start_utc": scenario.clock.iso(0.0),
        "version": version("schmidt"),
        "overruns_by_board": session.network.overruns,
        "steps": [
            {
                "name": r.step.name,
                "action": r.step.action,
                "start_s": r.start_s,
                "end_s": r.end_s,
                "failed": r.failed,
            }
            for r in outcome.records
        ],
        "faults": [each.as_json() for each in outcome.faults],
    }


@contextmanager
def bar(scenario: Scenario) -> Iterator[Show]:
    """What is left of a run, estimated from its steps."""
    total = sum(_estimate_s(step.action, step.arguments) for step in scenario.steps if step.after is None)
    with shown(scenario.name, max(total, 1.0)) as tell:

        def show(step: str, t_s: float, factor: float) -> None:
            tell(t_s, f"{step[:40]}, {factor:.0f}× real time" if factor else step)

        yield show


def _estimate_s(action: str, arguments: dict[str, Any]) -> float:
    if action == "pointing_run":
        return 40.0 * float(arguments.get("stars", STARS))
    return float(arguments.get("for", 40.0 if action in ("goto", "park") else 1.0))
