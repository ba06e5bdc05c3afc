"""Pointing runs on a mount with errors: the whole chain from encoders to the sky and back."""

import csv
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from host.logs.traces import Trace
from host.procedures.pointing_run import directions
from host.sky import pointmodel
from host.sky.catalogue import star
from host.sky.observed import observe_many
from plant.model import dumps, load
from plant.mount import sky
from plant.parts import MountErrors
from scenarios.lab.snapshot.file import read
from scenarios.lab.snapshot.run import Order
from scenarios.language.document import ScenarioError, parse
from scenarios.language.load import convert
from scenarios.language.model import Scenario
from scenarios.language.plants import plant_model
from scenarios.language.programme import Record
from scenarios.run import evaluate
from scenarios.run import run as runner
from scenarios.run.outcome import Outcome
from tests.host.sky.seen import plain
from tests.scenarios.conftest import SHORT

HEAD = """\
name: pointing
start_utc: 2026-02-10T14:00:00Z
plant:
  file: low-preload-bridge
  effects: [{name: encoder_eccentricity, stage: axis}]
"""
RUN = """\
steps:
  - power_on: {}
  - name: run
    pointing_run: {stars: 24}
  - name: check
    pointing_run: {stars: 8, fit: false}
expect:
  - pointing_error: {during: run, source: truth, statistic: mean, at_least: 100 arcsec}
  - pointing_error: {during: check, source: truth, at_most: 10 arcsec}
  - pointing_error: {during: check, source: encoder, at_most: 10 arcsec}
"""


def made(text: str, folder: Path, seed: int = 1) -> Scenario:
    return convert(parse(text + f"seed: {seed}\n", folder / "pointing.yaml"))


def go(scenario: Scenario, folder: Path, way: runner.Way) -> runner.Result:
    model = plant_model(scenario.plant, folder)
    return runner.run(scenario, model, folder, lambda *_: None, way)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [31])
def test_a_run_makes_a_model_that_holds_on_other_stars(tmp_path: Path, seed: int) -> None:
    result = go(made(HEAD + RUN, tmp_path, seed), tmp_path, runner.Way())
    assert result.passed, result.verdicts
    saved = tmp_path / "pointing-model.json"
    model = pointmodel.parsed(saved.read_text(encoding="utf-8"), saved)
    assert model.stars == 24
    assert model.held_out_arcsec < 10
    declared = MountErrors()
    terms = {term.name: term.arcsec for term in model.terms}
    # The encoders' own errors of 2″ go into the zeros and terms that look alike.
    assert terms["MA"] == pytest.approx(declared.polar_azimuth.value, abs=3)
    assert terms["ME"] == pytest.approx(declared.polar_altitude.value, abs=3)
    with (tmp_path / "pointing-stars.csv").open() as file:
        assert file.readline() == "# latitude_deg: 29.366667\n"
        rows = list(csv.DictReader(file))
    assert [row["step"] for row in rows] == ["run"] * 24 + ["check"] * 8
    assert (tmp_path / "pointing-run.png").read_bytes().startswith(b"\x89PNG")
    # Loaded into another scenario, the model points from the start.
    text = (
        HEAD
        + "mount: {pointing_model: pointing-model.json}\n"
        + RUN.replace("stars: 24", "stars: 6, fit: false")
    )
    again = made(text.replace("at_least: 100", "at_most: 10"), tmp_path, seed + 1)
    (tmp_path / "again").mkdir()
    assert go(again, tmp_path / "again", runner.Way(report=False)).passed


@pytest.mark.slow
def test_a_snapshot_in_the_middle_of_a_run_goes_on_to_the_same_model(tmp_path: Path) -> None:
    text = HEAD + "steps:\n  - power_on: {}\n  - pointing_run: {stars: 6}\n  - track: {for: 2 s}\n"
    order = Order(60_000_000_000, tmp_path / "a.snapshot")
    one = go(made(text, tmp_path), tmp_path / "one", runner.Way(report=False, snapshot=order))
    whole = read(order.file)
    assert 0 < sum(kind == "seen" for kind, _ in whole["heard"]) < 6
    way = runner.Way(report=False, begun=whole)
    two = runner.run(whole["scenario"], whole["model"], tmp_path / "two", lambda *_: None, way)
    assert two.summary["trace_digest"] == one.summary["trace_digest"]
    for name in ("pointing-model.json", "pointing-stars.csv"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_pointing_error_is_of_the_sky_and_not_of_the_axes(tmp_path: Path) -> None:
    """Axes exactly on a star whose mount looks elsewhere."""
    scenario = convert(parse(SHORT, tmp_path / "short.yaml"))
    pollux = star("Pollux")
    t = np.arange(0.0, 10.0, 0.01)
    ha, dec, _, _ = observe_many(pollux, scenario.site, scenario.clock, t)
    for name, angle in (("ra", ha), ("dec", dec)):
        trace = Trace(tmp_path / f"truth-{name}.parquet", ("t_s", "angle", "rate"), {})
        trace.append(np.stack([t, angle + math.pi, 0 * t], axis=1))
        trace.close()
    record = Record(scenario.steps[0], 0.0, 9.9, star=pollux)
    given: dict[str, Any] = {"during": scenario.steps[0].name, "axis": "sky", "statistic": "mean"}
    straight = Outcome(tmp_path, scenario, [record], {})
    assert evaluate.pointing_error(straight, given) == pytest.approx(0.0, abs=0.002)
    looked = sky(ha, dec, scenario.site.latitude_rad, MountErrors())
    half = (
        np.sin((looked[1] - dec) / 2) ** 2
        + np.cos(dec) * np.cos(looked[1]) * np.sin((looked[0] - ha) / 2) ** 2
    )
    apart = float(np.mean(np.degrees(2 * np.arcsin(np.sqrt(half))))) * 3600
    bent = Outcome(tmp_path, scenario, [record], {}, errors=MountErrors())
    assert apart > 60
    assert evaluate.pointing_error(bent, given) == pytest.approx(apart, rel=1e-3)


@pytest.mark.parametrize("count", [6, 40, 100])
def test_directions_are_within_reach_all_over_the_sky_and_other_ones_every_time(count: int) -> None:
    scenario = convert(parse(SHORT, Path("short.yaml")))
    places = directions(count, scenario, 1.0)
    assert len(places) == len(set(places)) == count
    assert all(each.altitude_rad > scenario.horizon_rad for each in places)
    assert all(scenario.mount.ra.within(each.hour_angle_rad) for each in places)
    if count > 6:
        # Stars of a quarter of the azimuths are between a sixth and a third of all.
        quarters = np.bincount([int(each.azimuth_rad // (math.pi / 2)) for each in places], minlength=4)
        assert quarters.min() > count / 6
        assert quarters.max() < count / 3
    assert not set(places) & set(directions(count, scenario, 2.0))


def test_a_mount_has_errors_unless_the_scenario_takes_them_away(tmp_path: Path) -> None:
    assert plant_model({"file": "low-preload"}, tmp_path).mount == MountErrors()
    model = plant_model({"file": "low-preload", "overrides": {"mount.collimation": 7}}, tmp_path)
    assert model.mount is not None
    assert model.mount.collimation.value == 7
    without: dict[str, Any] = {"file": "low-preload", "mount": False}
    assert plant_model(without, tmp_path).mount is None
    with pytest.raises(ScenarioError, match=r"no number at 'mount\.collimation'"):
        plant_model(without | {"overrides": {"mount.collimation": 7}}, tmp_path)


def test_a_mount_that_the_plant_file_declares_stays_and_can_be_taken_away(tmp_path: Path) -> None:
    file = tmp_path / "own.yaml"
    errors = "mount:\n  collimation: {value: 5, unit: arcsec, source: measured}\n"
    file.write_text(dumps(load("low_preload")) + errors)
    own = plant_model({"file": str(file)}, tmp_path).mount
    assert own is not None and own.collimation.value == 5
    assert plant_model({"file": str(file), "mount": False}, tmp_path).mount is None


def test_errors_of_the_mount_move_no_axis(tmp_path: Path) -> None:
    """The trace, axes and bus, is the same to the last bit; only the sky is another."""
    text = HEAD + "steps:\n  - power_on: {}\n  - goto: {target: Pollux}\n  - name: f\n    track: {for: 5 s}\n"
    text += "expect: [{pointing_error: {during: f, settle: 3 s, source: truth, statistic: mean,"
    text += " at_least: 0 arcsec}}]\n"
    digests, errors = [], []
    for number, given in enumerate((text, text.replace("plant:\n", "plant:\n  mount: false\n"))):
        result = go(made(given, tmp_path), tmp_path / str(number), runner.Way(report=False))
        digests.append(result.summary["trace_digest"])
        errors.append(result.verdicts[-1].value)
    assert digests[0] == digests[1]
    assert errors[0] > 60 > 10 > errors[1]


def test_a_model_file_of_a_scenario_is_checked(tmp_path: Path) -> None:
    text = SHORT + "mount: {pointing_model: model.json}\n"
    file = tmp_path / "model.json"
    for make, said in (
        (lambda: None, "there is no such file"),
        (lambda: os.mkfifo(file), "it is no regular file"),
        (lambda: file.write_text("[" * 100_000), "is not JSON"),
        (lambda: file.write_text("{}"), "expected a JSON object with the format"),
    ):
        file.unlink(missing_ok=True)
        make()
        with pytest.raises(ScenarioError, match=rf"mount: .*model.json: .*{said}") as caught:
            convert(parse(text, tmp_path / "short.yaml"))
        assert "\n" not in str(caught.value)
    file.unlink()
    plain(MA=60.0).save(tmp_path / "model.json")
    assert convert(parse(text, tmp_path / "short.yaml")).mount.model == plain(MA=60.0)
