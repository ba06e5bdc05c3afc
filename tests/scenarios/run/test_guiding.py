"""Autoguide steps: frames against the truth, the log against PHD2's conventions and the finder."""

import csv
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.inputs.guidelog import read_guide_log
from host.camera.models import GUIDE
from host.sky.catalogue import star
from host.sky.observed import observe_many
from scenarios.lab.eye import NOISE_ARCSEC
from scenarios.lab.snapshot.file import read
from scenarios.lab.snapshot.run import Order
from scenarios.language.document import ScenarioError, parse
from scenarios.language.load import convert
from scenarios.language.model import check_targets
from scenarios.language.plants import plant_model
from scenarios.native import compiled
from scenarios.run import run as runner

HEAD = """\
name: guiding
seed: 7
start_utc: 2026-02-10T14:00:00Z
plant:
  file: low-preload-bridge
  effects:
    - {name: encoder_eccentricity, axis: ra, stage: roller, harmonic: 2, parameters: {amplitude: {value: 12, unit: arcsec}}}
"""  # noqa: E501
STEPS = """\
steps:
  - power_on: {}
  - goto: {target: Pollux}
  - name: guide
    autoguide: {for: 60 s, by: rate}
expect:
  - guiding_error: {during: guide, statistic: rms, at_most: 2 arcsec}
"""
RIG = """\
rig: the telescope behind its guide log, RA driven at the motors
format: phd2
stages:
  - {name: roller, period_s: 1758.45, kind: encoder_eccentricity}  # half a turn: 86164.09 s over 2 x 24.5
"""


def go(text: str, folder: Path, **way: Any) -> runner.Result:
    scenario = convert(parse(text, folder / "guiding.yaml"))
    model = plant_model(scenario.plant, folder)
    return runner.run(scenario, model, folder, lambda *_: None, runner.Way(report=False, **way))


def rows(log: Path) -> list[dict[str, str]]:
    """Frames of a guide log's first table."""
    text = log.read_text().split("\n\n")[1]
    return list(csv.DictReader(line for line in text.splitlines() if re.match(r"Frame,|\d", line)))


@pytest.fixture(scope="module")
def guided(tmp_path_factory: pytest.TempPathFactory) -> runner.Result:
    return go(HEAD + STEPS, tmp_path_factory.mktemp("guided"))


def away(result: runner.Result, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a step: time s, and how far the star truly was west and north of where the telescope looked, ″."""
    outcome, pollux = result.outcome, star("Pollux")
    record = outcome.record(name)
    assert record.start_s is not None and record.end_s is not None
    t, hour_angle, declination = outcome.pointed(record.start_s, record.end_s)
    place = observe_many(pollux, outcome.scenario.site, outcome.scenario.clock, t)
    west = np.degrees(place[0] - hour_angle) * 3600 * math.cos(pollux.declination_rad)
    return t, west, np.degrees(place[1] - declination) * 3600


def test_frames_are_where_the_plant_says_that_the_star_stood(guided: runner.Result) -> None:
    record = guided.outcome.record("guide")
    assert guided.passed and len(record.guided) > 15
    t, west, north = away(guided, "guide")
    middle = np.array([each.t_s - 1.0 for each in record.guided])  # of exposures of 2 s
    for k, true in enumerate((west, north)):
        seen = np.array([each.off[k] for each in record.guided])
        error = seen - np.interp(middle, t, true)
        assert np.std(error) < 1.5 * NOISE_ARCSEC
    assert np.ptp(west) > 1.0  # it had something to do


def test_distances_pulses_and_directions_agree_as_in_a_log_of_phd2(guided: runner.Result) -> None:
    log = guided.folder / "guiding.txt"
    text = log.read_text()
    assert text.startswith("PHD2 version ")
    rates = [float(re.search(rf" {axis}Rate = ([0-9.]+)", text)[1]) for axis in "xy"]  # type: ignore[index]
    assert rates[1] * GUIDE.pixel_arcsec == pytest.approx(15.041067 / 2, abs=0.01)
    sent = 0
    for row in rows(log):
        for name, rate, ways in (("RA", rates[0], "WE"), ("DEC", rates[1], "SN")):
            distance, raw = float(row[f"{name}GuideDistance"]), float(row[f"{name}RawDistance"])
            assert float(row[f"{name}Duration"]) * 1e-3 * rate == pytest.approx(abs(distance), abs=0.005)
            if distance:
                sent += 1
                assert row[f"{name}Direction"] == ways[distance < 0] and distance * raw > 0
    assert sent > 10
    (run,) = read_guide_log(log)
    assert run.header["unit"] == "arcsec" and run.rows == len(guided.outcome.record("guide").guided)


@pytest.mark.skipif(compiled(), reason="snapshots are taken of the plain source")
@pytest.mark.slow
def test_a_snapshot_in_the_middle_goes_on_to_the_same_log(tmp_path: Path) -> None:
    order = Order(60_000_000_000, tmp_path / "a.snapshot")
    one = go(HEAD + STEPS, tmp_path / "one", snapshot=order)
    whole = read(order.file)
    way = runner.Way(report=False, begun=whole)
    two = runner.run(whole["scenario"], whole["model"], tmp_path / "two", lambda *_: None, way)
    assert two.summary["trace_digest"] == one.summary["trace_digest"]
    assert (tmp_path / "one/guiding.txt").read_bytes() == (tmp_path / "two/guiding.txt").read_bytes()


@pytest.mark.slow
def test_the_axes_go_on_with_the_star_whatever_follows(tmp_path: Path) -> None:
    steps = "".join(
        f"  - {{name: {name}, {what}}}\n"
        for name, what in (
            ("motors", "autoguide: {for: 61.3 s, by: rate}"),
            ("rest", "wait: {for: 20 s}"),
            ("encoders", "autoguide: {for: 30 s}"),
            ("again", "autoguide: {for: 30 s, exposure: 0.5 s}"),
            ("follow", "track: {for: 30 s}"),
        )
    )
    result = go(HEAD + "steps:\n  - power_on: {}\n  - goto: {target: Pollux}\n" + steps, tmp_path)
    assert result.passed and not result.summary["error_log_entries"]
    names = ("motors", "rest", "encoders", "again", "follow")
    seen = np.array([[np.median(side[-500:]) for side in away(result, name)[1:]] for name in names])
    assert np.abs(seen - seen[0]).max() < 3.0  # a pulse that stayed on would make 150″ of the rest


def test_guiding_beyond_the_horizon_is_refused(tmp_path: Path) -> None:
    text = HEAD + "steps:\n  - goto: {target: Pollux}\n  - autoguide: {for: 11 h}\n"
    with pytest.raises(ScenarioError, match="Pollux"):
        check_targets(convert(parse(text, tmp_path / "a.yaml")))


def test_guiding_without_a_star_is_refused_in_one_line(tmp_path: Path) -> None:
    result = go(HEAD + "steps:\n  - power_on: {}\n  - autoguide: {for: 5 s}\n", tmp_path)
    assert not result.passed and not (tmp_path / "guiding.txt").exists()
    assert "go to one first" in (tmp_path / "errors.log").read_text()


@pytest.mark.parametrize("words", ["exposure: 0 s", "exposure: 2 min", "aggressiveness: 150 %", "by: worm"])
def test_nonsense_is_refused_before_anything_moves(tmp_path: Path, words: str) -> None:
    with pytest.raises(ScenarioError, match="autoguide"):
        convert(parse(HEAD + f"steps:\n  - autoguide: {{for: 5 s, {words}}}\n", tmp_path / "a.yaml"))


@pytest.mark.slow
def test_an_oval_roller_comes_back_from_the_guide_log_by_name(
    tmp_path: Path, schmidt: Callable[..., Any]
) -> None:
    go(HEAD + STEPS.replace("60 s", "2 h"), tmp_path / "night")
    (tmp_path / "rig.yaml").write_text(RIG)
    log = tmp_path / "night" / "guiding.txt"
    done = schmidt("calibrate", log, "--rig", tmp_path / "rig.yaml", "--out", tmp_path / "found")
    assert done.returncode == 0 and "lacks encoder_eccentricity on roller" in done.stdout, done.stdout
    found = re.search(r"amplitude [0-9.]+ \(([0-9.]+) to ([0-9.]+)\) arcsec", done.stdout)
    assert found is not None
    low, high = map(float, found.groups())
    on_sky = 12 * math.cos(star("Pollux").declination_rad)  # what is injected is of the axis
    assert low < on_sky < high
