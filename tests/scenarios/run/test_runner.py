"""The loop around a run: what it tells on the way, how it ends, and what it counts."""

import dataclasses
import gc
import itertools
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from host.logs import traces
from host.logs.files import LogError
from scenarios.lab.recorder import Recorder
from scenarios.lab.session import Session
from scenarios.lab.snapshot.run import Progress
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.plants import plant_model
from scenarios.run import run as runner
from scenarios.run.evaluate import Verdict
from tests.scenarios.conftest import SHORT

TEXT = SHORT + "  - {name: rest, wait: {for: 2 s}}\n"
Told = list[tuple[str, float, float]]


def go(folder: Path, progress: Callable[..., None], text: str = TEXT, **changes: Any) -> runner.Result:
    """A run without a page."""
    way = runner.Way(report=False, **changes)
    scenario = convert(parse(text, folder / "test.yaml"))
    return runner.run(scenario, plant_model(scenario.plant, folder), folder, progress, way)


@pytest.fixture(scope="module")
def told() -> Told:
    return []


@pytest.fixture(scope="module")
def plain(told: Told, tmp_path_factory: pytest.TempPathFactory) -> runner.Result:
    return go(tmp_path_factory.mktemp("plain"), lambda *each: told.append(each))


def test_a_run_tells_once_a_second_what_is_going_on(plain: runner.Result, told: Told) -> None:
    start, *middle, end = told
    assert start == ("starting (the first time compiles)", 0.0, 0.0)
    assert end == ("writing the report", plain.summary["simulated_s"], 0.0)
    assert [t_s for _, t_s, _ in middle] == [k + 1.0 for k in range(len(middle))]
    steps = {step["name"]: step for step in plain.summary["steps"]}
    for words, t_s, factor in middle:
        running = [
            name for name, step in steps.items() if step["start_s"] <= t_s and not step["end_s"] <= t_s
        ]
        assert words == (", ".join(running) or "ending")
        assert factor > 0.0
    assert {words for words, _, _ in middle} >= {"rest", "ending"}


def test_a_factor_is_simulated_time_over_the_clocks(plain: runner.Result, told: Told) -> None:
    walls = [t_s / factor for _, t_s, factor in told[1:-1]]
    assert all(later > sooner > 0.0 for sooner, later in itertools.pairwise(walls))
    summary = plain.summary
    assert summary["real_time_factor"] == pytest.approx(summary["simulated_s"] / summary["wall_s"])
    assert walls[-1] <= summary["wall_s"] < walls[-1] + 1.0


def test_a_run_ends_a_second_after_its_last_step(plain: runner.Result) -> None:
    done_s = plain.summary["steps"][-1]["end_s"]
    assert done_s + 1.0 <= plain.summary["simulated_s"] < done_s + 2.0


def test_bus_load_is_kept_by_the_second(plain: runner.Result) -> None:
    rows = plain.outcome.bus
    times, loads, frames = zip(*rows, strict=True)
    assert times == tuple(k + 1.0 for k in range(len(rows)))
    assert sum(loads) / len(loads) == pytest.approx(plain.summary["bus_load"])
    assert all(0.05 < load < 0.2 for load in loads[1:])
    ends = [float(line[1:].split(")")[0]) for line in (plain.folder / "can.log").read_text().splitlines()]
    for t_s, count in zip(times, frames, strict=True):
        assert abs(count - sum(end <= t_s for end in ends)) <= 2


def test_a_summary_counts_what_the_logs_have(plain: runner.Result) -> None:
    summary = json.loads((plain.folder / "summary.json").read_text(encoding="utf-8"))
    lines = (plain.folder / "can.log").read_text().splitlines()
    errors = [
        line for line in (plain.folder / "errors.log").read_text().splitlines() if not line.startswith("#")
    ]
    assert (summary["frames"], summary["error_log_entries"]) == (len(lines), len(errors))
    assert (summary["frame_errors"], summary["overruns"], summary["dropped"]) == (0, 0, 0)
    assert (summary["steps_completed"], summary["silent_faults"]) == (3, 0)
    assert (summary["passed"], summary["interrupted"], plain.interrupted) == (True, False, False)
    assert (summary["scenario"], summary["seed"]) == ("short", 1)
    assert summary["start_utc"].startswith("2026-02-10T14:00:00")
    assert [(each["name"], each["action"], each["failed"]) for each in summary["steps"]] == [
        ("power_on 1", "power_on", ""), ("go", "set_rate", ""), ("rest", "wait", ""),
    ]  # fmt: skip
    assert plain.summary == summary
    assert not (plain.folder / "report.html").exists()
    assert (plain.folder / "summary.json").read_text(encoding="utf-8").endswith("}\n")


def test_a_summary_is_for_people_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Indented by two, in UTF-8; faults that met nothing are counted."""
    written: list[str] = []
    for name in ("write_runs", "write_guiding"):
        monkeypatch.setattr(runner, name, lambda outcome, name=name: written.append(name))
    text = "time_limit: 2 s\n" + SHORT.replace("name: short", "name: Prüfung") + "faults:\n"
    text += "  - sensor_bias: {sensor: focus.lvdt, offset: 0.01}\n    at: 0.5 s\n"
    text += "  - frame_loss: {identifier: 0x7FF}\n  - frame_loss: {identifier: 0x7FE}\n"
    result = go(tmp_path, lambda *_: None, text)
    lines = (tmp_path / "summary.json").read_text(encoding="utf-8").splitlines()
    assert lines[1] == '  "scenario": "Prüfung",'
    assert result.summary["silent_faults"] == 2
    assert written == ["write_runs", "write_guiding"]


def test_a_run_leaves_the_collector_as_it_was(plain: runner.Result, tmp_path: Path) -> None:
    """What was there at the start is frozen meanwhile, so that it is not looked through again and again."""
    gc.unfreeze()
    seen: list[int] = []
    go(tmp_path, lambda *_: seen.append(gc.get_freeze_count()), SHORT)
    assert max(seen[1:-1]) == min(seen[1:-1]) > 0
    assert gc.get_freeze_count() == seen[0] == seen[-1] == 0


def test_an_interrupted_run_leaves_logs_and_says_so(tmp_path: Path) -> None:
    def stop(_words: str, t_s: float, factor: float) -> None:
        if t_s == 1.0 and factor:
            raise KeyboardInterrupt

    result = go(tmp_path, stop)
    assert (result.interrupted, result.summary["interrupted"], result.passed) == (True, True, False)
    assert result.summary["simulated_s"] == 1.0
    assert len((tmp_path / "can.log").read_text().splitlines()) == result.summary["frames"] > 100
    assert result.verdicts[0].reason == "the run was interrupted"
    assert result.summary["steps_completed"] < 3


def interrupt(_t_ns: int) -> None:
    raise KeyboardInterrupt


class Stopped(Session):
    """Interrupted in the middle of its second second."""

    def advance(self, t_ns: int) -> None:
        if t_ns == 2_000_000_000:
            self.network.queue.at(1_500_000_000, interrupt)
        super().advance(t_ns)


def test_an_interrupted_run_has_its_traces_until_then(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "Session", Stopped)
    result = go(tmp_path, lambda *_: None)
    assert result.interrupted and result.summary["simulated_s"] == 1.5
    assert traces.read(tmp_path / "host.parquet", (), 0.0, 9.0)["t_s"][-1] == pytest.approx(1.5, abs=0.11)


@pytest.fixture
def closed(monkeypatch: pytest.MonkeyPatch) -> list[Recorder]:
    """Recorders that were closed."""
    found: list[Recorder] = []
    close = Recorder.close

    def noting(self: Recorder) -> list[str]:
        found.append(self)
        return close(self)

    monkeypatch.setattr(Recorder, "close", noting)
    return found


def test_whatever_goes_wrong_the_logs_are_closed(closed: list[Recorder], tmp_path: Path) -> None:
    def fail(_words: str, t_s: float, _factor: float) -> None:
        if t_s:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        go(tmp_path, fail)
    assert len(closed) == 1
    assert gc.get_freeze_count() == 0


def test_a_board_to_be_muted_that_is_none_is_refused(closed: list[Recorder], tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="--mute NOBODY: there is no such board"):
        go(tmp_path, lambda *_: None, mute=("NOBODY", tmp_path / "can.log"))
    assert len(closed) == 1


def test_a_log_that_could_not_be_written_is_an_error(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(Recorder, "close", lambda _: ["can.log: full", "axis-ra.csv: full"])
    with pytest.raises(LogError, match=r"can\.log: full"):
        go(tmp_path, lambda *_: None, SHORT)


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(LogError, match=r"file/out: cannot be made: Not a directory"):
        go(tmp_path / "file" / "out", lambda *_: None)


def test_a_folder_may_be_there_and_those_above_it_need_not(tmp_path: Path) -> None:
    text = "time_limit: 1 s\n" + SHORT
    for _ in range(2):
        assert go(tmp_path / "a" / "b", lambda *_: None, text).summary["simulated_s"] == 1.0


def test_a_run_has_its_page_unless_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pages: list[Path] = []
    monkeypatch.setattr("scenarios.run.report.html.write", lambda outcome, *_: pages.append(outcome.folder))
    scenario = convert(parse("time_limit: 1 s\n" + SHORT, tmp_path / "test.yaml"))
    result = runner.run(scenario, plant_model(scenario.plant, tmp_path), tmp_path, lambda *_: None)
    assert pages == [tmp_path]
    assert not runner.Result({}, [], tmp_path, result.outcome).interrupted


def test_traces_go_to_the_end_of_the_run(plain: runner.Result) -> None:
    for name in ("truth-ra", "truth-dec", "host"):
        rows = traces.read(plain.folder / f"{name}.parquet", (), 0.0, 1e9)
        assert rows["t_s"][-1] == pytest.approx(plain.summary["simulated_s"], abs=0.3)


def test_another_format_of_the_frames_begins_when_the_run_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[tuple[Path, str, str]] = []
    monkeypatch.setattr(runner, "convert", lambda *each: given.append(each))
    go(tmp_path, lambda *_: None, "time_limit: 1 s\n" + SHORT + "logs: {can: mf4}\n")
    ((file, kind, start),) = given
    assert (file, kind) == (tmp_path / "can.log", "mf4")
    assert datetime.fromisoformat(start) == datetime(2026, 2, 10, 14, tzinfo=UTC)


def test_another_format_of_the_frames_is_told(tmp_path: Path) -> None:
    told: Told = []
    go(tmp_path, lambda *each: told.append(each), "time_limit: 1 s\n" + SHORT + "logs: {can: asc}\n")
    assert told[-2:] == [("writing the report", 1.0, 0.0), ("writing can.asc", 1.0, 0.0)]
    assert (tmp_path / "can.asc").stat().st_size > 1000


class Clock:
    """The machine's: a second passes with each piece, and as long as somebody sleeps."""

    def __init__(self) -> None:
        self.now_s, self.slept_s = 100.0, list[float]()

    def perf_counter(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.slept_s.append(seconds)
        self.now_s += seconds


@pytest.mark.parametrize(
    ("speed", "slept_s", "factor"), [(None, [], 0.5), (0.25, [2.0] * 3, 0.25), (0.5, [], 0.5), (4.0, [], 0.5)]
)
def test_a_run_is_held_back_to_the_speed_it_is_given(
    speed: float | None, slept_s: list[float], factor: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A piece takes two seconds here: half of real time."""
    clock, told = Clock(), Told()
    monkeypatch.setattr(runner, "time", clock)

    class Slow(Session):
        def advance(self, t_ns: int) -> None:
            super().advance(t_ns)
            clock.now_s += 2.0

    monkeypatch.setattr(runner, "Session", Slow)
    scenario = convert(
        parse("time_limit: 3 s\n" + SHORT.replace("for: 1 s", "for: 9 s"), tmp_path / "a.yaml")
    )
    scenario = dataclasses.replace(scenario, speed=speed)
    model = plant_model(scenario.plant, tmp_path)
    result = runner.run(scenario, model, tmp_path, lambda *e: told.append(e), runner.Way(report=False))
    assert clock.slept_s == slept_s
    assert [each for _, _, each in told[1:-1]] == pytest.approx([factor] * 3)
    assert result.summary["wall_s"] == pytest.approx(3.0 / factor)
    assert result.summary["real_time_factor"] == pytest.approx(factor)


class Order:
    """In place of a snapshot: notes what it is given."""

    at_ns = 1_500_000_000

    def __init__(self) -> None:
        self.began: list[Any] = []
        self.taken: list[tuple[int, int]] = []

    def begin(self, session: Session, begun: object) -> None:
        self.began.append((session.network.queue.now_ns, begun))

    def due(self, t_ns: int) -> bool:
        return not self.taken and self.at_ns <= t_ns

    def take(self, session: Session, state: Progress) -> None:
        self.taken.append((session.network.queue.now_ns, state.t_ns))


def test_a_snapshot_is_taken_at_its_time_and_changes_nothing(plain: runner.Result, tmp_path: Path) -> None:
    order = Order()
    result = go(tmp_path, lambda *_: None, snapshot=order)
    assert order.began == [(0, None)]
    assert order.taken == [(1_500_000_000, 1_000_000_000)]
    assert result.summary["trace_digest"] == plain.summary["trace_digest"]
    assert result.outcome.bus == plain.outcome.bus


def test_logs_reach_the_disk_every_ten_seconds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    at_s: list[float] = []
    now: list[float] = [0.0]
    monkeypatch.setattr(Recorder, "flush", lambda _: at_s.append(now[-1] + 1.0))
    text = "time_limit: 21 s\n" + SHORT.replace("for: 1 s", "for: 99 s")
    result = go(tmp_path, lambda _words, t_s, _factor: now.append(t_s), text)
    assert at_s == [10.0, 20.0]
    assert result.summary["simulated_s"] == 21.0
    assert not result.passed


def test_a_time_limit_within_a_second_ends_the_last_piece(tmp_path: Path) -> None:
    result = go(tmp_path, lambda *_: None, "time_limit: 1.25 s\n" + SHORT)
    assert [t_s for t_s, _, _ in result.outcome.bus] == [1.0, 1.25]


def verdict(passed: bool) -> Verdict:
    return Verdict(name="a", value=2.0 if passed else 0.0, limit=1.0, unit="")


def test_a_result_passes_if_all_of_it_does(plain: runner.Result) -> None:
    for verdicts in ([], [True], [True, False], [False]):
        result = dataclasses.replace(plain, verdicts=[verdict(each) for each in verdicts])
        assert result.passed is (False not in verdicts)


STEPS = """\
name: long
start_utc: 2026-02-10T14:00:00Z
steps:
  - {name: up, power_on: {}}
  - goto: {target: Pollux}
  - track: {for: 100 s}
  - pointing_run: {stars: 10}
  - park: {}
  - {name: beside, after: up, wait: {for: 1000 s}}
"""


def test_a_bar_is_as_long_as_the_steps_in_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """A move takes 40 s, as does each star; what has no length takes one."""
    totals: list[tuple[str, float]] = []
    lines: list[tuple[float, str]] = []

    @contextmanager
    def shown(name: str, total: float) -> Iterator[Callable[[float, str], None]]:
        totals.append((name, total))
        yield lambda t_s, text: lines.append((t_s, text))

    monkeypatch.setattr(runner, "shown", shown)
    scenario = convert(parse(STEPS, Path("long.yaml")))
    with runner.bar(scenario) as show:
        show("starting", 0.0, 0.0)
        show("x" * 50, 3.0, 12.4)
    with runner.bar(dataclasses.replace(scenario, steps=())):
        pass
    assert totals == [("long", 1.0 + 40.0 + 100.0 + 400.0 + 40.0), ("long", 1.0)]
    assert lines == [(0.0, "starting"), (3.0, "x" * 40 + ", 12× real time")]


def test_a_pointing_run_looks_at_forty_stars_unless_told() -> None:
    assert runner._estimate_s("pointing_run", {}) == 1600.0
    assert runner._estimate_s("goto", {"for": 7}) == 7.0
    assert runner._estimate_s("wait", {}) == 1.0
