"""`schmidt run` and the studies: what a command line asks of the runner, and what it says of the outcome."""

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result

from scenarios.commands import running
from scenarios.lab.prepare import load
from scenarios.language.model import Scenario
from scenarios.run.evaluate import Verdict
from scenarios.run.run import Way

CLUSTER = ("--scheduler", "tcp://a:1")
SUMMARY = {"simulated_s": 2.04, "real_time_factor": 30.26, "trace_digest": "0123456789abcdefXYZ"}


class Desk:
    """The command, with a runner that runs nothing and writes down what it is asked."""

    def __init__(self, scenario: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
        self.scenario, self.model = scenario, object()
        self.changes: Any = None
        self.ways: list[Way] = []
        self.folder = Path()
        self.needed: list[str] = []
        self.plain = self.done = 0
        self.result = SimpleNamespace(verdicts=[], summary=SUMMARY, interrupted=False, passed=True)
        monkeypatch.setattr("scenarios.lab.prepare.prepare", self.prepare)
        monkeypatch.setattr("scenarios.run.run.run", self.run)
        monkeypatch.setattr("scenarios.native.finder.plain", self.made_plain)
        monkeypatch.setattr(running, "need", lambda *extras: self.needed.extend(extras))

    def prepare(self, source: Path, changes: Any) -> tuple[Scenario, object]:
        assert source == self.scenario.file
        self.changes = changes
        return self.scenario, self.model

    def made_plain(self) -> None:
        self.plain += 1

    def run(self, scenario: Scenario, model: object, folder: Path, progress: Any, way: Way) -> Any:
        assert scenario is self.scenario and model is self.model and callable(progress)
        self.ways.append(way)
        self.folder = folder
        if way.snapshot is not None:
            way.snapshot.done = bool(self.done)
        return self.result

    def __call__(self, *words: object) -> Result:
        return CliRunner().invoke(running.run, [str(each) for each in words])


@pytest.fixture
def desk(short: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(load(short), monkeypatch)


@pytest.mark.parametrize(("rate", "period_s"), [("4", 0.25), ("20", 0.05), ("0.01", 100.0)])
def test_a_rate_of_logging_is_a_period(rate: str, period_s: float, desk: Desk) -> None:
    assert desk(desk.scenario.file, "--log-rate", rate).exit_code == 0
    assert desk.changes.status_period_s == pytest.approx(period_s)
    assert desk(desk.scenario.file).exit_code == 0
    assert desk.changes.status_period_s is None


@pytest.mark.parametrize("rate", ["0.009", "20.1", "0"])
def test_a_rate_of_logging_has_bounds(rate: str, desk: Desk) -> None:
    done = desk(desk.scenario.file, "--log-rate", rate)
    assert done.exit_code == 2 and "is not in the range 0.01<=x<=20" in done.output


def test_a_run_draws_unless_told_not_to(desk: Desk) -> None:
    done = desk(desk.scenario.file)
    assert desk.needed == ["parquet", "plots"] and desk.folder == Path("out/short")
    assert desk.ways == [Way(report=True)] and not desk.plain and desk.changes.isolated is False
    told = "2.0 s simulated at 30.3 times real time, digest 0123456789abcdef, report out/short/report.html\n"
    assert done.output == told
    desk.needed.clear()
    done = desk(desk.scenario.file, "--no-report", "--isolated", "--out", "there")
    assert desk.needed == ["parquet"] and desk.folder == Path("there")
    assert desk.ways[1:] == [Way(report=False)] and desk.changes.isolated is True
    assert done.output == told.replace("report out/short/report.html", "logs in there")


def test_a_log_in_mf4_needs_the_extra_of_recordings(desk: Desk) -> None:
    desk.scenario = replace(desk.scenario, can_log="mf4")
    desk(desk.scenario.file)
    assert desk.needed == ["parquet", "plots", "recordings"]


VERDICTS = [
    (Verdict("error", 1.23456, 2.0, "arcsec", True), "ok   error: 1.235 ≤ 2 arcsec"),
    (Verdict("error", 2.5, 2.0, "arcsec", True), "MISS error: 2.5 ≤ 2 arcsec"),
    (Verdict("share", 0.5, 0.75, "1", False), "MISS share: 0.5 ≥ 0.75"),
    (Verdict("dome", None, 0.75, "deg", reason="no turn"), "MISS dome: no value ≥ 0.75 deg  (no turn)"),
]


@pytest.mark.parametrize(("verdict", "line"), VERDICTS)
def test_a_verdict_is_a_line(verdict: Verdict, line: str, desk: Desk) -> None:
    desk.result.verdicts, desk.result.passed = [verdict], verdict.passed
    done = desk(desk.scenario.file)
    assert done.output.splitlines()[0] == line and done.exit_code == (0 if verdict.passed else 1)


def test_an_interruption_is_told_with_the_time_that_was_reached(desk: Desk) -> None:
    desk.result.interrupted = True
    done = desk(desk.scenario.file)
    assert done.exit_code == 130
    assert done.output.endswith("schmidt: interrupted, logs up to t=2.0 s in out/short\n")


@pytest.mark.parametrize(("words", "file"), [((), "out/short/snapshot"), (("--snapshot", "kept"), "kept")])
def test_a_snapshot_is_ordered_at_its_time(words: tuple[str, ...], file: str, desk: Desk) -> None:
    desk.done = 1
    assert desk(desk.scenario.file, "--snapshot-at", "1.5", *words).exit_code == 0
    order = desk.ways[0].snapshot
    assert order is not None and (order.at_ns, order.file) == (1_500_000_000, Path(file))
    assert desk.plain == 1  # compiled instances cannot be taken apart
    desk.done = 0
    done = desk(desk.scenario.file, "--snapshot-at", "1.5")
    assert done.exit_code == 2 and "the run ended before 1.5 s: no snapshot" in done.output


def test_a_run_goes_on_from_a_snapshot(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = {"scenario": desk.scenario, "model": desk.model}
    monkeypatch.setattr("scenarios.lab.snapshot.run.begun", {Path("kept"): whole}.__getitem__)
    assert desk("--from", "kept").exit_code == 0
    assert desk.ways == [Way(begun=whole)] and desk.plain == 1 and desk.changes is None


@pytest.mark.parametrize(("words", "text"), [
    (("x.yaml", "--snapshot", "kept"), "--snapshot FILE needs --snapshot-at SECONDS"),
    (("x.yaml", "--from", "kept"), "--from goes on with what is in the snapshot, nothing else"),
    (("--from", "kept", "--compensation", "c"), "--from goes on with what is in the snapshot, nothing else"),
    (("--from", "kept", "--seed", "1"), "--from goes on with what is in the snapshot, nothing else"),
    ((), "Missing argument 'SCENARIO'"),
])  # fmt: skip
def test_what_does_not_go_together_is_a_usage(words: tuple[str, ...], text: str, desk: Desk) -> None:
    done = desk(*words)
    assert done.exit_code == 2 and text in done.output and not desk.ways


@pytest.mark.parametrize(("words", "firmware"), [((), "fine"), (("--firmware", "paper"), "paper")])
def test_a_compensation_takes_three_runs_of_the_fine_firmware(
    words: tuple[str, ...], firmware: str, desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenarios.run.run import bar

    asked: list[Any] = []

    def three(*given: Any) -> tuple[Any, str]:
        asked.extend(given)
        return desk.result, "gains"

    monkeypatch.setattr("scenarios.run.compared.run", three)
    monkeypatch.setattr("scenarios.run.compared.lines", lambda gains: [f"{gains} by half"])
    monkeypatch.setattr("scenarios.language.configure.load_compensation", lambda file: f"read {file}")
    done = desk(desk.scenario.file, "--compensation", "c.yaml", *words)
    assert (done.exit_code, done.output.splitlines()[0]) == (0, "gains by half")
    assert asked == [desk.scenario, desk.model, Path("out/short"), "read c.yaml", bar]
    assert desk.changes.firmware == firmware and not desk.ways
    done = desk(desk.scenario.file, "--compensation", "c.yaml", "--snapshot-at", "1")
    assert done.exit_code == 2 and "do not go together: that is three runs" in done.output


def test_without_a_compensation_the_firmware_is_the_scenarios(desk: Desk) -> None:
    desk(desk.scenario.file)
    assert desk.changes.firmware is None


def test_a_muted_board_is_compared_with_its_log(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    def compare(log: Path, run: Path, device: Any) -> Any:
        return SimpleNamespace(text=lambda: f"{log} {run} {device.name}")

    monkeypatch.setattr("scenarios.lab.muted.compare", compare)
    done = desk(desk.scenario.file, "--mute", "DISPLAY", "--feed", "can.log")
    assert done.output.splitlines()[1:] == ["can.log out/short/can.log DISPLAY"]
    assert desk.ways == [Way(mute=("DISPLAY", Path("can.log")))]


STUDIES = [
    (running.campaign, ("many.yaml",), "scenarios.campaign.run_campaign.campaign"),
    (running.campaign, ("many.yaml", *CLUSTER), "scenarios.campaign.run_campaign.campaign"),
    (running.paper, (), "scenarios.studies.paper.run_experiments.paper"),
    (running.paper, CLUSTER, "scenarios.studies.paper.run_experiments.paper"),
    (running.objective, (), "scenarios.studies.objective.run_holds.objective"),
]


@pytest.mark.parametrize(("command", "words", "place"), STUDIES)
def test_a_study_exits_with_its_status(
    command: Any, words: tuple[str, ...], place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    needed: list[str] = []
    monkeypatch.setattr(running, "need", lambda *extras: needed.extend(extras))
    module, _, name = place.rpartition(".")
    monkeypatch.setitem(sys.modules, module, SimpleNamespace(**{name: lambda options: 7}))  # imported at once
    assert CliRunner().invoke(command, words).exit_code == 7
    assert needed == ["calibrate", *(["cluster"] if CLUSTER[0] in words else [])]
