"""`schmidt run`: load, check, run, judge, report."""

from __future__ import annotations

import dataclasses
import gc
import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.logs.files import LogError
from scenarios.configure import read_tables, with_firmware
from scenarios.document import Document, ScenarioError
from scenarios.load import convert, load
from scenarios.model import Scenario
from scenarios.present import check_boards
from scenarios.targets import check_targets

if TYPE_CHECKING:
    from plant.model import PlantModel
    from scenarios.evaluate import Verdict
    from scenarios.outcome import Outcome
    from scenarios.session import Session
    from scenarios.snapshot.run import Order, Progress

_PIECE_NS = 1_000_000_000
"""Between two pieces of simulated time files are flushed, the disk is asked for room, the bar moves."""
_FLUSH_PIECES = 10
_TAIL_NS = 1_000_000_000
"""After the last step: packets of the last quarter second still have to arrive."""


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


def prepare(
    source: Path | Document,
    seed: int | None = None,
    plant: str | None = None,
    speed: float | None = None,
    status_period_s: float | None = None,
    firmware: str | None = None,
    network: str | None = None,
) -> tuple[Scenario, PlantModel]:
    """Load a scenario, apply the command line's changes, check all that can be checked without running.

    source: the file, or what stands in it (relative names are looked for beside its `file`).
    """
    from scenarios.plants import plant_model

    scenario = convert(source) if isinstance(source, Document) else load(source)
    changes: dict[str, Any] = {"seed": seed, "speed": speed, "status_period_s": status_period_s}
    scenario = dataclasses.replace(
        scenario, **{key: value for key, value in changes.items() if value is not None}
    )
    if plant is not None:
        scenario = dataclasses.replace(scenario, plant={**scenario.plant, "file": plant})
    if network is not None:
        scenario = dataclasses.replace(scenario, network={**scenario.network, "name": network})
    check_targets(scenario)
    check_boards(scenario)
    scenario = read_tables(scenario)
    if firmware is not None:
        scenario = with_firmware(scenario, firmware)
    return scenario, plant_model(scenario.plant, scenario.file.parent)


def run(
    scenario: Scenario,
    model: PlantModel,
    folder: Path,
    progress: Callable[[str, float, float], None],
    report: bool = True,
    snapshot: Order | None = None,
    begun: dict[str, Any] | None = None,
    mute: tuple[str, Path] | None = None,
) -> Result:
    """Run a scenario into a folder. progress: `(step, simulated s, times real time)`, once a second of it.
    report: draw the figures and write the page; the logs and `summary.json` come in any case.
    snapshot: taken on the way. begun: a snapshot that was read, to go on from. mute: a board and the candump
    log its frames come from.

    An interruption (KeyboardInterrupt) ends the run early with readable logs; a disk that is full raises
    `LogError` after everything that could be closed was closed.
    """
    from scenarios.session import Session
    from scenarios.snapshot.run import Progress, resume

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LogError(f"{folder}: cannot be made: {error.strerror}") from None
    progress("starting", 0.0, 0.0)
    if begun is None:
        session = Session(scenario, model, folder)
        state = Progress(0, 0, round(scenario.time_limit_s * 1e9))
    else:
        session, state = resume(begun, folder), begun["progress"]
    if mute is not None:
        from scenarios.muted import Feed

        try:
            Feed(session.network, *mute)
        except ValueError:
            session.recorder.close()
            raise
    if snapshot is not None:
        snapshot.begin(session, begun)
    wall_s = time.perf_counter()
    interrupted = False
    gc.freeze()  # what is there now stays to the end: the collector need not look through it again and again
    try:
        _loop(session, state, progress, snapshot)
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
    return _conclude(session, state.bus, wall_s, interrupted, report)


def _loop(
    session: Session,
    state: Progress,
    progress: Callable[[str, float, float], None],
    snapshot: Order | None = None,
) -> None:
    scenario, wire = session.scenario, session.network.wire
    limit_ns = round(scenario.time_limit_s * 1e9)
    start = time.perf_counter()
    t_ns, bits, end_ns, bus = state.t_ns, state.bits, state.end_ns, state.bus
    while t_ns < end_ns:
        before_ns, t_ns = t_ns, min(t_ns + _PIECE_NS, end_ns)
        if snapshot is not None and snapshot.due(t_ns):
            session.advance(snapshot.at_ns)
            snapshot.take(session, dataclasses.replace(state, t_ns=before_ns, bits=bits, end_ns=end_ns))
        session.advance(t_ns)
        bus.append((t_ns * 1e-9, (wire.bits - bits) * wire.bit_ns / _PIECE_NS, wire.frames))
        bits = wire.bits
        if len(bus) % _FLUSH_PIECES == 0:
            session.recorder.flush()
        if session.programme.finished and end_ns == limit_ns:
            end_ns = min(limit_ns, t_ns + _TAIL_NS)
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
    from scenarios.evaluate import judge
    from scenarios.outcome import Outcome

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
        "interrupted": interrupted,
    }
    outcome = Outcome(recorder.folder, session.scenario, records, counters, bus)
    verdicts = judge(outcome)
    summary = _summary(session, outcome, verdicts)
    _write_json(recorder.folder / "summary.json", summary)
    if report:
        from scenarios.report.page import write

        write(outcome, verdicts, summary)
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
    }


def _write_json(path: Path, data: dict[str, Any]) -> None:
    try:
        path.write_text(json.dumps(data, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise LogError(f"{path}: {(error.strerror or 'cannot be written').lower()}") from None


@contextmanager
def bar(scenario: Scenario, terminal: bool) -> Iterator[Callable[[str, float, float], None]]:
    """A progress bar when there is a terminal to show it on, otherwise silence."""
    if not terminal:
        yield lambda _step, _t, _factor: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    total = sum(_estimate_s(step.action, step.arguments) for step in scenario.steps if step.after is None)
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[text]}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(
            "starting (the first time compiles, some seconds)", total=max(total, 1.0), text=""
        )

        def show(step: str, t_s: float, factor: float) -> None:
            text = f"{t_s:.0f} s simulated, {factor:.0f}× real time" if factor else ""
            progress.update(task, completed=t_s, description=step[:40], text=text)

        yield show


def _estimate_s(action: str, arguments: dict[str, Any]) -> float:
    return float(arguments.get("for", 40.0 if action in ("goto", "park") else 1.0))


__all__ = ["LogError", "Result", "ScenarioError", "bar", "prepare", "run"]
