"""Before, after and wrong: figures of three runs whose answers are known, and what each run is given."""

import contextlib
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bus.units import ARCSEC_PER_RAD
from host.logs.traces import Trace
from scenarios.language.configure import Compensation, Line
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.model import Scenario
from scenarios.language.programme import Record
from scenarios.run import compared
from scenarios.run import run as runner
from scenarios.run.outcome import Outcome
from tests.scenarios.conftest import Command

TEXT = """\
name: held
start_utc: 2026-02-10T14:00:00Z
steps:
  - firmware: {use: fine}
  - power_on: {}
  - name: short one
    set_rate: {axis: ra, rate: 15 arcsec/s, for: 20 s}
  - name: held one
    set_rate: {axis: ra, rate: 15 arcsec/s, for: 130 s}
"""
TABLE = Compensation("ra", (Line(360.0, 3.0, 4.0),), 50.0, 14.0)
SWING_HZ = 0.2
SWINGS = {"before": 1.2, "wrong": 0.5, "after": 0.1}
"""arcsec/s, amplitude about 15 arcsec/s."""


def scenario() -> Scenario:
    return convert(parse(TEXT, Path("held.yaml")))


def outcome(folder: Path, swing: float) -> Outcome:
    """RA at 15 arcsec/s with a sine about it: whole periods behind the settling time."""
    folder.mkdir(parents=True, exist_ok=True)
    made = scenario()
    t = np.arange(0.0, 152.0, 0.01)
    rate = (15.0 + swing * np.sin(2 * np.pi * SWING_HZ * t)) / ARCSEC_PER_RAD
    trace = Trace(folder / "truth-ra.parquet", ("t_s", "angle", "rate"), {})
    trace.append(np.stack([t, np.zeros_like(t), rate], axis=1))
    trace.close()
    steps = {step.name: step for step in made.steps}
    records = [Record(steps["short one"], 1.0, 21.0), Record(steps["held one"], 21.0, 151.0)]
    return Outcome(folder, made, records, {})


@pytest.fixture
def outcomes(tmp_path: Path) -> dict[str, Outcome]:
    return {name: outcome(tmp_path / name, swing) for name, swing in SWINGS.items()}


def test_rate_and_angle_of_known_swings(outcomes: dict[str, Outcome]) -> None:
    gains = list(compared._gains(outcomes, "ra"))
    assert [(gain.step, gain.run) for gain in gains] == [("held one", name) for name in compared.LABELS]
    for gain in gains:
        swing = SWINGS[gain.run]
        assert gain.peak == pytest.approx(swing, rel=1e-3)
        assert gain.rms == pytest.approx(swing / math.sqrt(2), rel=1e-3)
        # the rate's integral by hand; the sum of samples is half a sample of 10 ms off at most
        assert gain.angle == pytest.approx(swing / (2 * math.pi * SWING_HZ), abs=swing * 0.005)


def test_a_step_shorter_than_its_settling_says_nothing(outcomes: dict[str, Outcome]) -> None:
    assert "short one" not in {gain.step for gain in compared._gains(outcomes, "ra")}


def test_a_run_whose_trace_has_a_hole_there_is_left_out_alone(outcomes: dict[str, Outcome]) -> None:
    late = outcomes["wrong"].records[1]
    outcomes["wrong"].records[1] = Record(late.step, 500.0, 700.0)
    assert [gain.run for gain in compared._gains(outcomes, "ra")] == ["before", "after"]


def test_lines_name_all_three(outcomes: dict[str, Outcome]) -> None:
    gains = list(compared._gains(outcomes, "ra"))
    text = list(compared.lines(gains))
    assert text[0].startswith(
        "held one, without the table: true rate peak 1.200, rms 0.849 arcsec/s; angle ±"
    )
    assert ["with it 20% too small and 0.2 rad off" in line for line in text].count(True) == 1


def test_a_plot_has_a_row_for_each_run_on_one_scale(outcomes: dict[str, Outcome]) -> None:
    gains = list(compared._gains(outcomes, "ra"))
    shorter = gains[0]._replace(step="short one", t_s=gains[0].t_s[:50])
    views = compared.draw([shorter, *gains]).axes
    assert len(views) == 6
    places = [view.get_subplotspec().get_geometry() for view in views]  # type: ignore[union-attr]
    assert places == [(3, 2, place, place) for place in range(6)]
    top = 1.1 * gains[0].peak, 1.1 * float(np.abs(gains[0].path).max())
    for view, gain, column in zip(views, np.repeat(np.arange(3), 2), [0, 1] * 3, strict=True):
        assert view.get_ylim() == (-top[column], top[column])  # smaller has to look smaller
        (line,) = view.get_lines()
        drawn = np.asarray(line.get_ydata())
        values = (gains[gain].rate, gains[gain].path)[column]
        assert (drawn.max(), drawn.min()) == (values.max(), values.min())
        assert view.get_xlabel() == ("time, s" if gain == 2 else "")
        assert view.get_ylabel() == ("arcsec/s", "arcsec")[column]
    words = [view.get_title(loc="left") for view in views]
    assert words[0] == "without the table: rate, peak 1.200"
    assert words[1] == f"without the table: angle, ±{gains[0].angle:.3f}"
    colours = [view.get_lines()[0].get_color() for view in views]
    assert len(set(colours)) == 3 and colours[::2] == colours[1::2]


def test_time_counts_from_the_settling_and_an_angle_from_its_middle(outcomes: dict[str, Outcome]) -> None:
    gain = next(compared._gains(outcomes, "ra"))
    assert gain.t_s[0] == pytest.approx(0.0, abs=0.011)
    assert gain.t_s[-1] == pytest.approx(100.0, abs=0.011)  # 130 s less 30 s of settling
    assert gain.path.mean() == pytest.approx(0.0, abs=1e-9)
    assert (gain.path.max(), gain.path.min()) == pytest.approx((gain.angle, -gain.angle), rel=0.02)


@pytest.mark.parametrize(("seconds", "count"), [(39.9, 0), (40.0, 3)])
def test_ten_seconds_behind_the_settling_are_enough(
    outcomes: dict[str, Outcome], seconds: float, count: int
) -> None:
    for each in outcomes.values():
        each.records[1] = Record(each.records[1].step, 20.0, 20.0 + seconds)
    assert len(list(compared._gains(outcomes, "ra"))) == count


def test_a_drift_is_no_swing(tmp_path: Path) -> None:
    """A rate that is off by a constant is told by its peak, and adds up to no angle."""
    steady = outcome(tmp_path / "steady", 0.0)
    rows = np.arange(0.0, 152.0, 0.01)
    trace = Trace(tmp_path / "steady" / "truth-ra.parquet", ("t_s", "angle", "rate"), {})
    trace.append(np.stack([rows, rows * 0.0, np.full_like(rows, 18.0 / ARCSEC_PER_RAD)], axis=1))
    trace.close()
    for gain in compared._gains(dict.fromkeys(compared.LABELS, steady), "ra"):
        assert (gain.peak, gain.rms) == pytest.approx((3.0, 3.0))
        assert gain.angle == pytest.approx(0.0, abs=1e-9)


@pytest.fixture
def stubbed(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The runner, replaced by one that notes what it is given; `stop`: run that is interrupted."""
    seen: dict[str, Any] = {"runs": [], "stop": None}

    def run(part: Scenario, _model: object, folder: Path, _progress: object) -> runner.Result:
        seen["runs"].append((part, folder))
        names = ("before", "wrong", "after")
        name = names[len(seen["runs"]) - 1]
        return runner.Result({}, [], folder, outcome(folder, SWINGS[name]), seen["stop"] == name)

    monkeypatch.setattr(runner, "run", run)
    monkeypatch.setattr("scenarios.run.report.html.write", lambda *given: seen.update(page=given))
    return seen


@contextlib.contextmanager
def quiet(_scenario: Scenario) -> Iterator[Callable[[str, float, float], None]]:
    yield lambda _text, _now, _end: None


def test_each_run_gets_its_table_and_its_folder(stubbed: dict[str, Any], tmp_path: Path) -> None:
    result, gains = compared.run(scenario(), None, tmp_path, TABLE, quiet)  # type: ignore[arg-type]
    assert [folder for _, folder in stubbed["runs"]] == [tmp_path / "before", tmp_path / "wrong", tmp_path]
    before, wrong, after = (
        [step.arguments["table"] for step in part.steps if step.action == "compensation"]
        for part, _ in stubbed["runs"]
    )
    assert (before, after) == ([], [TABLE])
    line = wrong[0].lines[0]
    # 20 % smaller, 0.2 rad on: by hand, as complex amplitudes
    turned = 0.8 * complex(3.0, -4.0) * complex(math.cos(0.2), math.sin(0.2))
    assert (line.cosine, -line.sine) == pytest.approx((turned.real, turned.imag))
    assert wrong[0].friction_steps == pytest.approx(40.0)
    assert [step.action for step in stubbed["runs"][2][0].steps[:3]] == [
        "firmware",
        "compensation",
        "power_on",
    ]
    assert result.folder == tmp_path
    assert [row["run"] for row in stubbed["page"][3][0]] == list(compared.LABELS.values())
    assert len(gains) == 3


@pytest.mark.parametrize(("stop", "runs"), [("before", 1), ("wrong", 2), ("after", 3)])
def test_an_interrupted_run_ends_it_and_compares_nothing(
    stubbed: dict[str, Any], tmp_path: Path, stop: str, runs: int
) -> None:
    stubbed["stop"] = stop
    result, gains = compared.run(scenario(), None, tmp_path, TABLE, quiet)  # type: ignore[arg-type]
    assert (result.interrupted, gains, len(stubbed["runs"])) == (True, [], runs)
    assert "page" not in stubbed


@pytest.mark.slow
def test_the_command_prints_before_after_and_wrong(schmidt: Command, tmp_path: Path) -> None:
    """An empty table: three runs of one thing."""
    (tmp_path / "held.yaml").write_text(TEXT.replace("130 s", "45 s").replace("20 s", "2 s"))
    (tmp_path / "table.yaml").write_text(
        "format: schmidt-compensation 1\naxis: ra\nlines: []\nfriction: {steps: 0, travel_arcsec: 14}\n"
    )
    done = schmidt("run", "held.yaml", "--compensation", "table.yaml", "--out", "out")
    assert done.returncode == 0, done.stderr
    text = [line for line in done.stdout.splitlines() if line.startswith("held one, ")]
    assert [line.split(":")[0] for line in text] == [f"held one, {name}" for name in compared.LABELS.values()]
    peaks = [float(line.split("peak ")[1].split(",")[0]) for line in text]
    assert peaks[1] == peaks[2]  # 20 % off nothing is nothing
    assert peaks[0] == pytest.approx(peaks[1], abs=0.05)  # commands come later, the routine costs 2 us more
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "without the table" in page
    assert (tmp_path / "out" / "compensation.png").stat().st_size > 10_000
