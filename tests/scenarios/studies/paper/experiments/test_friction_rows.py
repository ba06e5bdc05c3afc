"""E7, E8, E12 and E14 of benches that are arithmetic: which runs they ask for, and their figures."""

import numpy as np
import pytest

from plant.parts import PlantModel
from scenarios.studies.paper.experiments import friction
from scenarios.studies.paper.experiments.friction import Noise
from scenarios.studies.paper.friction_map import FrictionFit, MapPoint, ripple_free
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.rundown import Coasting
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, GEAR_RATIO, TABLE_2, drive
from scenarios.studies.paper.starts import Benches
from tests.scenarios.studies.paper.bench import HIGH, LOW, StubBench, benches, log_of

FIT = FrictionFit(200.0, 600.0, 4e-4, 1.0, 7000.0)


def test_E7_tells_deviations_in_percent_and_the_points_of_the_region(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fit is 1.1 times Table 2, in the unit that it has there; low has three points, high two."""

    def measured(_b: Benches, preload: str, _n: Noise) -> tuple[list[MapPoint], FrictionFit | None]:
        table, model = TABLE_2[preload], {"low": LOW, "high": HIGH}[preload].axes.ra.friction
        unit, vs = model.coulomb.value / model.coulomb.si, table["stribeck_rate"]
        shares = (0.24, 0.25, 1.0, 3.0, 3.1) if preload == "low" else (0.3, 2.9, 3.2)
        sizes = (table["coulomb"] / unit, table["stiction"] / unit, vs, 0.7, table["viscous"])
        fit = FrictionFit(*(1.1 * each for each in sizes)) if preload == "low" else None
        return [MapPoint(share * vs, 1.0, 1.0) for share in shares], fit

    monkeypatch.setattr(friction, "friction_map", measured)
    found = friction.table_2.measure(benches(lambda *_: log_of(0.0)))
    assert found == {
        **{f"low {name}": pytest.approx(10.0) for name in TABLE_2["low"]},
        "low exponent": pytest.approx(0.77), "region": 2.0,
    }  # fmt: skip


def test_E8_measures_three_inertias_by_eight_run_downs(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is found is 1.02 times the plant's own, whatever the factor."""
    asked: list[tuple[float, float]] = []
    factors: list[float] = []
    monkeypatch.setattr(friction, "friction_map", lambda *_: ([], FIT))

    def fall(_bench: StubBench, setpoint: float, turns: float) -> Log:
        asked.append((setpoint, turns))
        return log_of(1.0)

    monkeypatch.setattr(friction, "run_down", fall)

    def other(model: PlantModel, factor: float) -> PlantModel:
        factors.append(factor)
        return model

    def fitted(logs: list[Log], setpoints: list[float], fit: FrictionFit, sheet: object) -> Coasting:
        assert len(logs) == 8 and setpoints == [each for each, _ in asked[:8]]
        return Coasting(inertia=1.02 * 1760.0, damping=1.0, late_s=0.0)

    monkeypatch.setattr(friction, "with_inertia", other)
    monkeypatch.setattr(friction, "fit_run_downs", fitted)
    found = friction.inertia.measure(benches(lambda *_: log_of(0.0)))
    speeds = [(way * speed, turns) for speed in (7200, 2400) for way in (1, -1) for turns in (0, 0.25)]
    assert asked == speeds * 3 and factors == [0.8, 1.2]
    off = {"off 1": 2.0, "off 0.8": 27.5, "off 1.2": -15.0}
    assert found == {
        k: pytest.approx(v) for k, v in (off | {f"J {x}": 1795.2 for x in (1, 0.8, 1.2)}).items()
    }
    monkeypatch.setattr(friction, "friction_map", lambda *_: ([], None))
    assert friction.inertia.measure(benches(lambda *_: log_of(0.0))) == {}


def test_E12_is_the_slope_over_table_2_and_the_rise(monkeypatch: pytest.MonkeyPatch) -> None:
    """200 N m and 1.5 times the viscous friction: half the ripple is nothing at a full duty."""
    sheet = drive(LOW)

    def run(_bench: StubBench, speed: float) -> Log:
        torque = 200.0 + 1.5 * 6700.0 * abs(speed) * ARCSEC
        amperes = torque / (sheet.torque_constant * GEAR_RATIO)
        pulls = sheet.ripple * sheet.split * (1.0 - sheet.split)
        pair = (amperes, pulls) if speed > 0 else (pulls, amperes)
        return log_of(speed, 1.0, float(np.sign(speed)) * 3000.0, pair)

    monkeypatch.setattr(friction, "map_run", run)
    found = friction.viscous_branch.measure(benches(lambda *_: log_of(0.0)))
    low, high = (200.0 + 1.5 * 6700.0 * each * ARCSEC for each in (600.0, 1000.0))
    assert found == {"slope": pytest.approx(1.5), "rise": pytest.approx((high / low - 1.0) * 100.0)}


@pytest.mark.parametrize(("size", "gone_at", "end"), [(300, None, 280), (300, 200, 180), (300, 30, 40)])
def test_E14_takes_40_samples_that_end_20_before_the_axis_goes(
    monkeypatch: pytest.MonkeyPatch, size: int, gone_at: int | None, end: int
) -> None:
    """A current of 5 A times the duty, but for the last five of these samples."""
    rows = np.arange(size)
    rate = np.where(rows >= (size if gone_at is None else gone_at), 21.0, 19.9) * COUNT_RATE
    effort = np.asarray(300.0 + rows, dtype=np.float64)
    inside = (rows >= end - 40) & (rows < end)
    lead = effort / 3000.0
    ripple = drive(HIGH).ripple * lead * (1.0 - lead)
    amperes = np.where(inside, 5.0 * lead, 99.0) + ripple
    asked: list[int] = []

    def run(_bench: StubBench, way: int) -> Log:
        asked.append(way)
        return log_of(rate, size / 100, effort, (amperes, 0.0))

    monkeypatch.setattr(friction, "break_away", run)
    found = friction.at_rest.measure(benches(lambda *_: log_of(0.0)))
    assert asked == [1]
    last = float(np.mean(5.0 * lead[end - 5 : end]))
    assert found == {"stall": pytest.approx(5.0), "break-away current": pytest.approx(last)}
    assert ripple_free(run(StubBench(lambda *_: log_of(0.0)), 1), drive(HIGH))[0][end - 1] < 5.0
