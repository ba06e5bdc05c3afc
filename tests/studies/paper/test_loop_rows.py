"""E1 to E6, E11, E13 and E15: the runs that each commands, and its figures of an axis that is known."""

from collections.abc import Callable

import numpy as np
import pytest

from plant.model import load
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper.experiments import closed, identify, opened
from scenarios.studies.paper.experiments.experiment import Experiment, Figures
from scenarios.studies.paper.experiments.identify import averaged_step
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.starts import STARTS, Benches, Start, others, viscous_only, with_inertia
from tests.studies.paper.commanded import Command, Commanded
from tests.studies.paper.synthetic import log_of

PLANTS = {"low": load(LOW), "high": load(HIGH)}
Commands = list[list[Command]]
SPEEDS = (15.0, 100.0, 600.0, 700.0, 800.0, 900.0, 1000.0, 3600.0, 7200.0, 10800.0)


def measured(row: Experiment, make: Callable[[], Commanded] = Commanded) -> tuple[Figures, Commands]:
    """Figures of a row, and what each of its benches was commanded."""
    made: list[Commanded] = []

    def bench(*_: object) -> Commanded:
        made.append(make())
        return made[-1]

    found = row.measure(Benches(bench, PLANTS, STARTS[0]))
    return found, [each.commands for each in made]


def fast(speed: float) -> Commanded:
    return Commanded(lambda effort: 10.0 * effort, lambda at: speed * at)


def test_closed_loops_settle_before_they_count() -> None:
    assert measured(closed.low_preload)[1] == [[("closed", 15.0, 265.0)]]  # 240 s: a turn of the motor
    slews = [[("closed", speed, 13.0)] for speed in (3600.0, 7200.0, 10800.0)]
    assert measured(closed.slow_slews)[1] == slews
    every = [[("closed", speed, 37.0 if speed < 100 else 20.0)] for speed in SPEEDS]
    assert measured(closed.negligible)[1] == every
    assert measured(closed.both_preloads)[1] == [
        [("closed", speed, 16.0)] for speed in (600.0, 1000.0, 7200.0)
    ]
    pairs = [[("closed", speed, 16.0), ("open", speed / 10, 16.0)] for speed in SPEEDS[2:7]]
    assert measured(closed.higher_speeds)[1] == pairs
    assert measured(closed.high_preload)[1] == [[("closed", 15.0, 85.0)]] * 3
    assert measured(closed.low_gains)[1] == [[("closed", 15.0, 160.0)]] * 7
    opens = [[("closed", speed, 74.0), ("open", speed / 10, 74.0)] for speed in (600.0, 1000.0)]
    assert measured(opened.higher_speeds, Wavy)[1] == opens


def test_figures_of_an_axis_that_is_too_quick_by_a_tenth() -> None:
    quick = lambda: fast(1.1)  # noqa: E731
    found = measured(closed.low_preload, quick)[0]
    assert found == pytest.approx(
        {"peak": 10.0, "true peak": 10.0, "true peak of 1 s means": 10.0, "true rms": 0.0}, abs=1e-9
    )
    assert measured(closed.slow_slews, quick)[0] == pytest.approx({f"peak {k}": 10.0 for k in (1, 2, 3)})
    over = {f"{speed:g}": 0.1 * speed / max(1.0, 0.01 * speed) for speed in SPEEDS}
    wanted = {"worst": 10.0, "worst raw": 10.0}
    wanted |= {f"{of} {speed}": value for of in ("at", "raw") for speed, value in over.items()}
    assert measured(closed.negligible, quick)[0] == pytest.approx(wanted)
    assert list(wanted)[2:] == [name for name, _ in closed.negligible.beside][-20:]


class Wavy(Commanded):
    """A ripple of 0.3 Hz: 6 % in closed loop, twice that in open loop."""

    def _log(self, rate: float, effort: float, seconds: float) -> Log:
        swing = 0.12 if self.commands[-1][0] == "open" else 0.06
        t = np.arange(round(seconds * 100)) * 0.01
        wave = rate * (1.0 + swing * np.sin(2 * np.pi * 0.3 * t))
        return log_of(wave, np.full(t.size, effort))


def test_ripples_of_both_loops_are_compared() -> None:
    found = measured(opened.higher_speeds, Wavy)[0]
    assert 12.0 <= found["peak 600"] < 15.0 and 6.0 <= found["closed"] < 7.5  # more where it begins and ends
    assert found["ratio"] == pytest.approx(2.0)
    assert measured(closed.higher_speeds, Wavy)[0]["ripple"] == pytest.approx(0.5, rel=1e-6)
    assert closed.ripple(np.arange(50.0) + 2.0 * np.tile([1.0, -1.0], 25)) == pytest.approx(2.0, rel=0.01)


def test_E6_without_a_run_that_moves_has_no_figures() -> None:
    assert measured(opened.slowest, lambda: Commanded(lambda _: 0.0))[0] == {}


def test_starts_are_the_same_every_time_and_within_the_travel() -> None:
    found = others(40)
    assert found == others(40) and len(set(found)) == 40 and others(0) == ()
    assert all(85.0 <= each.angle_deg <= 275.0 and 10 <= each.seed < 100_000 for each in found)
    assert Start(180.0, 1).steps == 1 << 28 and Start(90.0, 1).steps == 1 << 27


def test_plants_without_coulomb_friction_and_with_another_inertia() -> None:
    smooth = viscous_only(PLANTS["low"]).axes.ra.friction
    assert 0.0 < smooth.coulomb.si < 1.0 and 0.0 < smooth.stiction.si < 1.0
    assert smooth.viscous == PLANTS["low"].axes.ra.friction.viscous
    axis, heavy = PLANTS["low"].axes.ra, with_inertia(PLANTS["low"], 1.5).axes.ra
    rotors = 2.0 * axis.motor.rotor_inertia.si * 360.48864**2
    assert heavy.inertia.si + rotors == pytest.approx(1.5 * (axis.inertia.si + rotors), rel=1e-6)


class Shown(Commanded):
    """Counts follow the effort at once, and the first rows of a run still show the effort before."""

    lag, before = 1, 0.0

    def _log(self, rate: float, effort: float, seconds: float) -> Log:
        log = super()._log(rate, effort, seconds)
        log.effort[: self.lag], log.counts[: self.lag] = self.before, self.before * 2.0
        log.counts[self.lag :] = 2.0 * effort
        self.before = effort
        return log


def test_steps_up_and_down_have_one_mean_response_per_step_of_effort() -> None:
    bench = Shown()
    response = averaged_step(lambda: bench)
    assert response == pytest.approx(np.full(100, 2.0))  # from the first row that shows the effort
    assert bench.commands[:2] == [("closed", 600.0, 6.0), ("open", 60, 6.0)]
    steps = bench.commands[2:]
    assert [at for _, at, _ in steps] == [70, 60] * 10  # 15 % of 60, as a multiple of ten
    assert all(seconds >= 1.3 for _, _, seconds in steps)
    assert {round(seconds * 1000) % 10 for _, _, seconds in steps[1::2]} == {5}  # a step up half a row later


def test_a_step_that_the_log_does_not_show_is_an_error() -> None:
    class Blind(Shown):
        def open_loop(self, effort: int, seconds: float) -> Log:
            self.lag = 100_000 if effort == 70 else 1
            return super().open_loop(effort, seconds)

    with pytest.raises(ValueError, match=r"^the log does not show the step to an effort of 70$"):
        averaged_step(Blind)
    assert identify.PHASES == 10
