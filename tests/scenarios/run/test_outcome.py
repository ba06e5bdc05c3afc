"""What a run's files give back, and what is written of pointing and guiding; all made by hand."""

import csv
import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from host.logs.traces import Trace
from host.procedures.autoguide import Guided
from host.procedures.pointing_run import Visit
from host.sky import pointread
from host.sky.catalogue import star
from host.sky.observed import observe_many
from host.sky.pointmodel import PointingModel
from host.sky.pointstars import Sighting
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.programme import Record
from scenarios.run import outcome as module
from scenarios.run.outcome import Outcome

SCENARIO = convert(
    parse(
        """\
name: by hand
start_utc: 2026-02-10T14:00:00Z
steps:
  - {name: first, wait: {for: 1 s}}
  - {name: second, wait: {for: 1 s}}
""",
        Path("hand.yaml"),
    )
)
POLLUX = star("Pollux")
QUARTER = 1 << 27
"""Of a turn of the absolute encoder, which reads 2^29 steps."""
LONG = 20_000
"""Rows of RA's trace; far more than an overview has."""


def trace(path: Path, columns: tuple[str, ...], *values: np.ndarray) -> None:
    made = Trace(path, columns, {})
    made.append(np.stack(values, axis=1))
    made.close()


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """RA's zero is a quarter of a turn on, declination's half; RA's trace is one row longer."""
    folder = tmp_path_factory.mktemp("left")
    mount = dataclasses.replace(
        SCENARIO.mount,
        ra=dataclasses.replace(SCENARIO.mount.ra, zero_steps=QUARTER),
        dec=dataclasses.replace(SCENARIO.mount.dec, zero_steps=2 * QUARTER),
    )
    t = np.arange(LONG) * 0.01
    rate, angle = np.zeros(LONG), np.full(LONG, 2.0)
    rate[777], rate[1234], angle[4321], angle[9876] = 9.0, -9.0, 7.0, -7.0
    columns = ("t_s", "angle", "rate")
    trace(folder / "truth-ra.parquet", columns, t, angle, rate)
    trace(folder / "truth-dec.parquet", columns, t[:-1], angle[:-1] + 1.0, rate[:-1])
    (folder / "axis-ra.csv").write_text("# by hand\nt,setpoint,velocity\n1,9,10\n2,9,20\n3,9,30\n4,9,40\n")
    return Outcome(folder, dataclasses.replace(SCENARIO, mount=mount), [], {})


def test_an_angle_counts_from_the_zero_of_its_axis(left: Outcome) -> None:
    t, angle, rate = left.truth("ra", 1.0, 1.02)
    assert t.tolist() == [1.0, 1.01, 1.02]
    assert angle == pytest.approx(2.0 - math.pi / 2)
    assert rate.tolist() == [0.0, 0.0, 0.0]
    assert left.truth("dec", 1.0, 1.0)[1] == pytest.approx(3.0 - math.pi)


@pytest.mark.parametrize("first", ["rate", "angle"])
def test_an_overview_keeps_what_it_is_asked_to_keep(left: Outcome, first: str) -> None:
    t, angle, rate = left.overview("ra", first)
    assert 3000 < len(t) == len(angle) == len(rate) < 5000
    kept = {"rate": [7.77, 12.34], "angle": [43.21, 98.76]}[first]
    peaks = t[np.abs(rate) > 1.0] if first == "rate" else t[np.abs(angle - 2.0 + math.pi / 2) > 1.0]
    assert peaks == pytest.approx(kept)
    if first == "angle":
        assert (angle.max(), angle.min()) == pytest.approx((7.0 - math.pi / 2, -7.0 - math.pi / 2))
    else:
        assert (rate.max(), rate.min()) == (9.0, -9.0)


def test_an_overview_is_of_rates_unless_told(left: Outcome) -> None:
    assert np.ptp(left.overview("ra")[2]) == 18.0


def test_the_telescope_looks_somewhere_where_both_axes_are_known(left: Outcome) -> None:
    t, hour_angle, declination = left.pointed(0.0, 1e9)
    assert len(t) == len(hour_angle) == len(declination) == LONG - 1
    assert hour_angle[0] == pytest.approx(2.0 - math.pi / 2)
    assert declination[0] == pytest.approx(3.0 - math.pi)


def test_an_axis_log_has_the_rows_of_the_window_and_its_ends(left: Outcome) -> None:
    rows = left.axis_log("ra", 2.0, 3.0)
    assert {name: column.tolist() for name, column in rows.items()} == {"t": [2, 3], "velocity": [20, 30]}
    assert len(left.axis_log("ra", 5.0, 6.0)["t"]) == 0


@pytest.mark.slow
def test_a_star_is_where_it_is_observed_between_two_seconds_too(left: Outcome) -> None:
    """Through the lower meridian, where an hour angle comes back to -pi."""
    t = np.arange(0.0, 86_400.0, 600.3)
    hour_angle, declination = left.star_places(POLLUX, t)
    exact, exact_declination, altitude, _ = observe_many(POLLUX, SCENARIO.site, SCENARIO.clock, t)
    off = np.remainder(hour_angle - exact + math.pi, 2 * math.pi) - math.pi
    up = altitude > math.radians(25.0)  # refraction bends most below
    assert up.sum() > 50
    assert np.degrees(np.abs(off[up])).max() * 3600 < 1e-6
    assert np.degrees(np.abs(declination - exact_declination)[up]).max() * 3600 < 1e-6
    assert np.diff(hour_angle).min() > 0.0


@pytest.mark.parametrize("t_s", [10.0, 10.5])
def test_a_moment_is_enough_for_a_star(left: Outcome, t_s: float) -> None:
    exact, _, _, _ = observe_many(POLLUX, SCENARIO.site, SCENARIO.clock, np.array([t_s]))
    assert left.star_places(POLLUX, np.array([t_s]))[0] == pytest.approx(exact, abs=1e-10)


def test_the_same_stretch_is_observed_once(left: Outcome, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[np.ndarray] = []

    def noting(*given: object) -> tuple[np.ndarray, ...]:
        asked.append(given[-1])  # type: ignore[arg-type]
        return observe_many(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "observe_many", noting)
    fresh = dataclasses.replace(left, _places={})
    for star_, t_s in ((POLLUX, 3.25), (POLLUX, 3.75), (star("Capella"), 3.25), (POLLUX, 4.25)):
        fresh.star_places(star_, np.array([t_s, t_s + 20.0]))
    assert len(asked) == 3
    assert asked[0][0] <= 3.25 and asked[0][-1] >= 23.25
    assert np.diff(asked[0]) == pytest.approx(1.0)
    assert "array" not in repr(fresh)  # what was kept is nobody's to read


def test_a_step_has_a_window_from_its_settling_to_its_end() -> None:
    left = Outcome(Path(), SCENARIO, [Record(SCENARIO.steps[0], 2.0, 10.0), Record(SCENARIO.steps[1])], {})
    assert left.window(left.record("first")) == (2.0, 10.0)
    assert left.window(left.record("second")) is None


def sighting(degrees: float) -> Sighting:
    """A star at these hour angle and half this declination; the axes stand a degree and two on."""
    turn = 4 * QUARTER
    return Sighting(
        hour_angle_rad=math.radians(degrees),
        declination_rad=math.radians(degrees / 2),
        ra_steps=QUARTER + round((degrees + 1) / 360 * turn),
        dec_steps=2 * QUARTER + round((degrees / 2 + 2) / 360 * turn),
    )


def test_stars_of_a_pointing_run_are_a_table_that_calibration_reads(left: Outcome, tmp_path: Path) -> None:
    visits = tuple(
        Visit(t_s=k + 0.125, star=POLLUX, sighting=sighting(degrees))
        for k, degrees in enumerate((10.0, -20.0), 1)
    )
    model = PointingModel(
        terms=(), latitude_rad=0.5, stars=2, before_arcsec=0.0, after_arcsec=0.0, held_out_arcsec=0.0
    )
    records = [Record(SCENARIO.steps[0]), Record(SCENARIO.steps[1], visits=visits, model=model)]
    module.write_runs(dataclasses.replace(left, folder=tmp_path, records=records))
    lines = (tmp_path / "pointing-stars.csv").read_text(encoding="utf-8").splitlines()
    latitude = math.degrees(SCENARIO.site.latitude_rad)
    assert lines[0] == f"# latitude_deg: {latitude:.6f}"
    head, *rows = csv.reader(lines[1:])
    assert head == ["step", "t_s", "hour_angle_deg", "declination_deg", "ra_reading_deg", "dec_reading_deg"]
    assert [row[:2] for row in rows] == [["second", "1.12"], ["second", "2.12"]]
    wanted = [[10.0, 5.0, 11.0, 7.0], [-20.0, -10.0, -19.0, -8.0]]
    assert [[float(each) for each in row[2:]] for row in rows] == [pytest.approx(w, abs=1e-6) for w in wanted]
    assert pointread.read(tmp_path / "pointing-stars.csv")
    assert (tmp_path / "pointing-model.json").exists()


def test_a_run_without_a_pointing_run_or_a_guide_camera_leaves_neither_file(tmp_path: Path) -> None:
    outcome = Outcome(tmp_path, SCENARIO, [Record(SCENARIO.steps[0], 0.0, 1.0, star=POLLUX)], {})
    module.write_runs(outcome)
    module.write_guiding(outcome)
    assert list(tmp_path.iterdir()) == []


def test_every_step_that_has_guided_is_a_section_of_the_guide_log(tmp_path: Path) -> None:
    frame = Guided(t_s=62.0, off=(0.0, 0.0), sent=(0.0, 0.0), pulses_s=(0.0, 0.0))
    steps = [
        dataclasses.replace(SCENARIO.steps[0], name=name, action="autoguide", arguments=given)
        for name, given in (
            ("plain", {"for": 1.0}),
            ("slow", {"for": 1.0, "exposure": 5.0, "aggressiveness": 0.5}),
            ("blind", {"for": 1.0}),
        )
    ]
    records = [
        Record(steps[0], 60.0, 70.0, star=POLLUX, guided=(frame,)),
        Record(steps[1], 61.0, 70.0, star=POLLUX, guided=(frame,)),
        Record(steps[2], 61.0, 70.0, star=POLLUX),
        Record(steps[0], None, None, star=POLLUX, guided=(frame,)),
        Record(steps[0], 61.0, 70.0, guided=(frame,)),
    ]
    module.write_guiding(Outcome(tmp_path, SCENARIO, records, {}))
    text = (tmp_path / "guiding.txt").read_text(encoding="utf-8")
    lines = text.splitlines()
    assert lines[0].startswith("PHD2 version 2.6, written by schmidt ")
    assert lines[0].endswith("Log enabled at 2026-02-10 14:00:00")
    assert text.count("PHD2") == 1
    assert [line for line in lines if line.startswith("Guiding Begins")] == [
        "Guiding Begins at 2026-02-10 14:01:00",
        "Guiding Begins at 2026-02-10 14:01:01",
    ]
    assert [line for line in lines if line.startswith("Exposure")] == [
        "Exposure = 2000 ms",
        "Exposure = 5000 ms",
    ]
    assert [line.split("Aggression = ")[1][:5] for line in lines if line.startswith("X guide")] == [
        "0.700",
        "0.500",
    ]
    assert [line.split(",")[1] for line in lines if line.startswith("1,")] == ["2.000", "1.000"]
