"""E7, E8, E12 and E14: what counts as a steady state, and figures of maps that are given."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from plant.model import load
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper.experiments import friction
from scenarios.studies.paper.experiments.experiment import Figures
from scenarios.studies.paper.experiments.friction import Noise, opened, steady
from scenarios.studies.paper.friction_map import FrictionFit, MapPoint
from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.rundown import Coasting
from scenarios.studies.paper.runs import HIGH as SPEEDS
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, ARCSEC, INERTIA, TABLE_2, drive
from scenarios.studies.paper.starts import STARTS, Benches
from tests.studies.paper.commanded import Commanded
from tests.studies.paper.synthetic import current_for, log_of
from tests.studies.paper.test_scales import SHEET

PLANTS = {"low": load(LOW), "high": load(HIGH)}
POINT = MapPoint(100.0 * ARCSEC, 200.0, 1.0, 5.0)
RUN = log_of(np.full(300, 100.0))
QUIET = Noise(1, "x", 0.0)


def benches(make: Callable[[], Commanded] = Commanded) -> Benches:
    return Benches(lambda *_: make(), PLANTS, STARTS[0])


@pytest.mark.parametrize(
    ("rate", "unrest", "passed"),
    [(104.9, 5.9, True), (95.1, 5.9, True), (105.1, 1.0, False), (94.9, 1.0, False), (100.0, 6.1, False)],
)
def test_a_steady_state_is_within_5_percent_and_known_to_3(rate: float, unrest: float, passed: bool) -> None:
    assert steady(100.0, MapPoint(rate * ARCSEC, 200.0, 1.0, unrest), (RUN, RUN)) is passed


def test_an_axis_that_stands_or_leaps_is_no_steady_state() -> None:
    still = log_of(np.repeat([100.0, 0.0, 100.0], 100))
    leaping = log_of(np.tile(np.repeat([40.0, 160.0], 10), 15))
    back = log_of(-leaping.rate)
    assert steady(100.0, POINT, (RUN, log_of(-RUN.rate)))
    assert not any(steady(100.0, POINT, (RUN, log)) for log in (still, leaping, back))


def test_noise_stays_within_the_converter_and_a_sheet_is_off_by_the_constant() -> None:
    log = replace(RUN, adc_a=np.full(300, 1022.9), adc_b=np.full(300, 0.2))
    read = Noise(3, "y").log(log)
    assert read.adc_a.max() == 1023.0 and read.adc_b.min() == 0.0
    assert not (read.adc_a % 1.0).any() and read.rate is not None
    noise = Noise(3, "y")
    assert noise.sheet(SHEET).torque_constant == SHEET.torque_constant * noise.constant
    assert noise.constant != 1.0 and QUIET.constant == 1.0 and QUIET.sheet(SHEET) == SHEET
    found = [Noise(seed, "y").constant for seed in range(60)]
    assert 0.95 <= min(found) < 0.96 and 1.04 < max(found) <= 1.05


class Loaded(Commanded):
    """Both motors' currents give 200 N m against the motion, above a speed; no steadiness below it."""

    def __init__(self, least: float = 0.0) -> None:
        super().__init__()
        self.least = least

    def _log(self, rate: float, effort: float, seconds: float) -> Log:
        log = super()._log(rate, effort, seconds)
        amperes = current_for(np.full(log.t_s.size, 200.0), drive(PLANTS["low"]).torque_constant)
        if abs(rate) < self.least:
            log = replace(log, counts=np.zeros(log.t_s.size))
        counts: Array = amperes / ADC_A_PER_COUNT
        return replace(
            log, adc_a=counts if rate > 0 else 0 * counts, adc_b=0 * counts if rate > 0 else counts
        )


def test_the_opened_loop_goes_down_by_half_steps_until_it_is_no_steady_state() -> None:
    made: list[Loaded] = []

    def make() -> Loaded:
        made.append(Loaded(least=65.0))
        return made[-1]

    begin = log_of(np.full(200, 80.0), np.full(200, 8.2)), log_of(np.full(200, -80.0), np.full(200, -9.1))
    points = list(opened(benches(make), "low", QUIET, drive(PLANTS["low"]), begin))
    efforts = [[at for kind, at, _ in bench.commands if kind == "open"] for bench in made]
    assert efforts == [[7, 7, -9], [7, 7, -8], [6, 6, -8]]  # the last at 60 and 80 arcsec/s
    assert [point.rate / ARCSEC for point in points] == pytest.approx([80.0, 75.0])
    assert {at for kind, at, _ in made[0].commands if kind == "closed"} == {80.0, -80.0}


def test_the_opened_loop_ends_where_an_effort_is_nothing() -> None:
    begin = log_of(np.full(200, 20.0), np.full(200, 2.0)), log_of(np.full(200, -20.0), np.full(200, -2.0))
    points = list(opened(benches(Loaded), "low", QUIET, drive(PLANTS["low"]), begin))
    assert [point.rate / ARCSEC for point in points] == pytest.approx([15.0, 10.0])


def given(monkeypatch: pytest.MonkeyPatch, fits: dict[str, FrictionFit | None]) -> list[tuple[str, float]]:
    """Maps of four points, two of them in the Stribeck region at low preload, and these fits."""
    asked: list[tuple[str, float]] = []

    def mapped(_: Benches, preload: str, noise: Noise) -> tuple[list[MapPoint], FrictionFit | None]:
        asked.append((preload, noise.constant))
        rates = (0.9e-4, 1.0e-4, 1.2e-3, 1.3e-3)  # a quarter of 4e-4 to thrice
        return [MapPoint(rate, 1.0, 1.0) for rate in rates], fits[preload]

    monkeypatch.setattr(friction, "friction_map", mapped)
    return asked


def test_E7_is_how_far_the_fit_is_off_table_2(monkeypatch: pytest.MonkeyPatch) -> None:
    unit = {name: PLANTS[name].axes.ra.friction.coulomb.si / TABLE_2[name]["coulomb"] for name in PLANTS}
    fits: dict[str, FrictionFit | None] = {
        "low": FrictionFit(229 * 1.1 * unit["low"], 621 * 0.9 * unit["low"], 4.4e-4, 1.3, 3350.0),
        "high": None,
    }
    asked = given(monkeypatch, fits)
    found = friction.table_2.measure(benches())
    wanted = {"coulomb": 10.0, "stiction": -10.0, "stribeck_rate": 10.0, "viscous": -50.0, "exponent": 1.3}
    points = {"region": 2.0}  # of high preload three: 1.75e-4 to 2.1e-3 would have two
    assert found == pytest.approx({f"low {name}": value for name, value in wanted.items()} | points)
    assert [name for name, _ in asked] == ["low", "high"] and len({off for _, off in asked}) == 1


def test_E8_is_how_far_each_inertia_is_off_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = given(monkeypatch, {"low": FrictionFit(1.0, 1.0, 1e-4, 1.0, 1.0)})
    runs: list[list[float]] = []

    def fitted(logs: list[Log], setpoints: list[float], fit: FrictionFit, sheet: object) -> Coasting:
        assert len(logs) == len(setpoints) and fit.viscous == 1.0 and sheet == drive(PLANTS["low"])
        runs.append(setpoints)
        return Coasting(inertia=1848.0, damping=1.0, late_s=0.0)

    monkeypatch.setattr(friction, "fit_run_downs", fitted)
    found = friction.inertia.measure(benches())
    assert INERTIA == 1760.0 and asked == [("low", 1.0)]
    off = {"off 1": 5.0, "off 0.8": 31.25, "off 1.2": -12.5}  # of 1760, 1408 and 2112
    assert found == pytest.approx(off | {f"J {factor}": 1848.0 for factor in ("1", "0.8", "1.2")})
    assert runs == [[7200.0, 7200.0, -7200.0, -7200.0, 2400.0, 2400.0, -2400.0, -2400.0]] * 3
    given(monkeypatch, {"low": None})
    assert friction.inertia.measure(benches()) == {}


class Viscous(Commanded):
    """A friction of 100 N m and 3350 N m s/rad, held by either motor."""

    def _log(self, rate: float, effort: float, seconds: float) -> Log:
        log = super()._log(rate, effort, seconds)
        torque = np.full(log.t_s.size, 100.0 + 3350.0 * abs(rate) * ARCSEC)
        counts = current_for(torque, drive(PLANTS["low"]).torque_constant) / ADC_A_PER_COUNT
        return replace(log, effort=0 * counts, adc_a=counts * (rate > 0), adc_b=counts * (rate < 0))


def test_E12_is_the_slope_and_rise_of_the_torque_over_the_higher_speeds() -> None:
    found: Figures = friction.viscous_branch.measure(benches(Viscous))
    first, last = (100.0 + 3350.0 * speed * ARCSEC for speed in (SPEEDS[0], SPEEDS[-1]))
    assert found == pytest.approx({"slope": 0.5, "rise": (last / first - 1.0) * 100.0})


class Stalled(Commanded):
    """Two milliamperes for a step of the effort, until it leaps at fifty."""

    def __init__(self) -> None:
        super().__init__(lambda effort: 100.0 if effort >= 50 else 0.0)

    def _log(self, rate: float, effort: float, seconds: float) -> Log:
        log = super()._log(rate, effort, seconds)
        duty, ripple = log.effort / 3000.0, drive(PLANTS["high"]).ripple
        return replace(log, adc_a=(6.0 * duty + ripple * duty * (1.0 - duty)) / ADC_A_PER_COUNT)


def test_E14_takes_the_current_of_a_stalled_motor_to_full_duty() -> None:
    found = friction.at_rest.measure(benches(Stalled))
    assert found == pytest.approx({"stall": 6.0, "break-away current": 6.0 * 48 / 3000}, rel=1e-6)
