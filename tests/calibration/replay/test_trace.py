"""A run given to the loop again: its command, its plant, and what comes back in the log's units."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.balances.frame import Frame
from calibration.replay.gains import Gains
from calibration.replay.trace import Loop, _held, before_start, repeats, ticks
from plant.effects.signals import ANGLE, CURRENT, MOTOR, RATE, TIME
from plant.model import PlantModel, load, with_effects
from tests.calibration.logs import effect
from tests.calibration.replay.frames import ARCSEC, PERIOD_S, frame

NAN = float("nan")
MODEL = with_effects(load("low_preload"), "ra", ())


def loop(f: Frame, gains: Gains | None = None) -> Loop:
    return Loop(frame=f, axis="ra", per_ampere=50.0, gains=gains)


def test_what_is_measured_is_in_the_traces_units() -> None:
    ia, ib = np.array([1.0, 2.0, 6.0, 1.0]), np.array([0.5, 0.5, 0.5, 6.0])
    columns: dict[str, Any] = {
        "velocity": np.full(5, 3.0 * ARCSEC),
        "position": np.full(5, 7.0 * ARCSEC),
    }
    f = frame(1, 4, current_a=np.array([0.0, *ia]), current_b=np.array([0.0, *ib]),
              **columns)  # fmt: skip
    got = loop(f).measured(f.run == 1)
    assert np.array_equal(got.torque, [25.0, 75.0, NAN, NAN], equal_nan=True)
    assert got.velocity == pytest.approx(np.full(4, 3.0)) and got.position == pytest.approx(np.full(4, 7.0))
    for name in ("current_a", "current_b", "velocity"):
        bare = replace(f, columns=f.columns | {name: np.full(5, NAN)})
        less = loop(bare).measured(f.run == 1)
        assert np.isnan(less.velocity if name == "velocity" else less.torque).all()
        assert len(less.velocity) == len(less.torque) == 4


N = 40


def log_of(n: int) -> Any:
    k = np.arange(float(n))
    truth = {"duty_a": np.full(n, 0.25), "duty_b": np.full(n, 0.5)}
    return SimpleNamespace(
        adc_a=np.where(k < 5, 0.0, 100.0), adc_b=np.full(n, 20.0), truth=truth, velocity=2.0 * k,
        position=(k + 2.0**29 - 3) % 2.0**29,
    )  # fmt: skip


def ran(monkeypatch: pytest.MonkeyPatch, f: Frame, rows: np.ndarray, nudge: np.ndarray | None = None) -> Any:
    """What the loop was given, and the trace."""
    given: dict[str, Any] = {}

    def simulate(
        model: PlantModel, axis: str, duration_s: float, command: Any, adc_counts_per_A: float
    ) -> Any:
        given.update(model=model, axis=axis, duration_s=duration_s, command=command, per=adc_counts_per_A)
        return log_of(int(rows.sum()))

    monkeypatch.setattr("plant.loop.simulate", simulate)
    given["trace"] = loop(f).again(MODEL, rows, np.zeros(int(rows.sum())) if nudge is None else nudge)
    return SimpleNamespace(**given)


def moving(speed: float, effort: float = 0.2) -> Frame:
    return frame(
        20, N, position=5.0 + speed * PERIOD_S * np.arange(20.0 + N), setpoint=np.full(20 + N, 30.0 * ARCSEC),
        effort=np.full(20 + N, effort),
    )  # fmt: skip


def test_a_run_begins_as_the_log_does(monkeypatch: pytest.MonkeyPatch) -> None:
    f = moving(100.0 * ARCSEC)
    got = ran(monkeypatch, f, f.run == 1, np.arange(float(N)))
    assert (got.axis, got.per) == ("ra", pytest.approx(1 / 0.0061)) and got.duration_s == pytest.approx(
        N * PERIOD_S
    )
    c = got.command
    assert c.start_rate == pytest.approx(100.0) and c.start_s == pytest.approx(0.2)
    first = f.columns["position"][20]
    assert c.start_steps == pytest.approx(first / (0.0024 * ARCSEC) + 0.5)
    assert c.effort == pytest.approx(np.full(N, 600.0)) and c.history.shape[:2] == (2, 20)
    # five rows are driven by the effort; both ticks of a row have the set point and its nudge
    assert np.isnan(c.setpoint[:10]).all()
    assert c.setpoint[10:] == pytest.approx(np.repeat(30.0 + np.arange(float(N)), 2)[10:])


def test_a_run_that_begins_without_effort_or_speed_is_closed_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    f = moving(2.9 * ARCSEC, 0.003)
    c = ran(monkeypatch, f, f.run == 1).command
    assert np.isfinite(c.setpoint).all() and c.start_rate == 0.0
    f = moving(-3.1 * ARCSEC, -0.0031)
    c = ran(monkeypatch, f, f.run == 1).command
    assert np.isnan(c.setpoint[:10]).all() and c.start_rate == pytest.approx(-3.1)
    f.columns["setpoint"][:] = NAN
    assert ran(monkeypatch, f, f.run == 1).command.setpoint is None


def test_currents_speeds_and_counts_come_back_in_the_logs_units(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ripple of V d (1 - d) / 2 L f is on a current that flows, where the PWM's edge samples it."""
    f = moving(0.0)
    got = ran(monkeypatch, f, f.run == 1).trace
    motor, pwm = MODEL.axes.ra.motor, MODEL.controller.pwm_frequency.si
    ripple = 24.0 / (2 * motor.inductance.si * pwm)
    a, b = 100.5 * 0.0061 - ripple * 0.1875, 20.5 * 0.0061 - ripple * 0.25
    assert got.torque == pytest.approx(50.0 * (np.where(np.arange(N) < 5, 0.0, a) - b))
    assert got.ripple == pytest.approx(50.0 * ripple * (np.where(np.arange(N) < 5, 0.0, 0.1875) - 0.25))
    assert got.velocity == pytest.approx(2.0 * np.arange(N) * 0.0115 / 0.005)
    assert np.diff(got.position) == pytest.approx(np.full(N - 1, 0.0024))


def test_the_plant_has_the_runs_supply_split_warmth_and_gains() -> None:
    f = frame(20, N, temperature=8.0 + 0.05 * PERIOD_S * np.arange(20.0 + N))
    f.runs[1].scales.update(supply_V=36.0, counter_torque=0.2)
    f.runs[0].scales["supply_V"] = 12.0
    made = loop(f, Gains(1.5, 0.25))._prepared(MODEL, f.run == 1, 0.2)
    assert (made.supply.voltage.si, made.controller.counter_split.si) == (36.0, 0.2)
    assert (made.controller.kp.value, made.controller.ki.value) == (1.5, 0.25)
    assert made.environment.warming.si == pytest.approx(0.05)
    assert made.environment.temperature.value == pytest.approx(8.0)  # at the session's begin
    cold = loop(frame(20, N, temperature=np.full(20 + N, NAN)))._prepared(MODEL, f.run == 1, 0.2)
    assert cold.environment == MODEL.environment and cold.controller.kp == MODEL.controller.kp
    one = np.full(20 + N, NAN)
    one[30] = 5.0
    assert (
        loop(frame(20, N, temperature=one))._prepared(MODEL, f.run == 1, 0.2).environment == MODEL.environment
    )


def test_warmth_before_the_run_is_in_the_depth_and_what_does_not_repeat_is_left_out() -> None:
    warm = effect("friction_warmup", depth=(0.4, "1"), time_constant=(100.0, "s"))
    mesh = effect("gear_mesh", "mesh3", amplitude=(12.0, "N m"), phase=(0.7, "rad"))
    noise = effect("position_noise", sigma=(1.0, "arcsec"))
    f = frame(N)
    for start_s, share in ((0.0, 1.0), (50.0, np.exp(-0.5))):
        made = loop(f)._prepared(with_effects(MODEL, "ra", [warm, mesh]), f.run == 0, start_s).axes.ra.effects
        assert [e.name for e in made] == ["friction_warmup", "gear_mesh"]
        assert made[0].parameters["depth"].value == pytest.approx(0.4 * share)
        assert made[0].parameters["time_constant"].value == 100.0 and made[1] == mesh
    assert repeats(mesh) and noise.enabled


def test_what_came_before_a_run_is_its_history() -> None:
    rate = 200.0 * ARCSEC
    f = frame(30, N, position=rate * PERIOD_S * np.arange(30.0 + N), current_a=np.full(30 + N, 2.0),
              current_b=np.full(30 + N, 1.0))  # fmt: skip
    got = before_start(f, f.run == 1)
    assert got is not None and got.shape[:2] == (2, 30)
    for motor, current in ((0, 2.0), (1, 1.0)):
        rows = got[motor]
        assert (
            rows[:, TIME] == pytest.approx(PERIOD_S * np.arange(30)) and (rows[:, CURRENT] == current).all()
        )
        assert rows[:, RATE] == pytest.approx(np.full(30, rate)) and (rows[:, MOTOR] == motor).all()
        assert rows[:, ANGLE] == pytest.approx(f.columns["position"][:30])
    assert before_start(f, f.run == 0) is None
    assert before_start(frame(1, N), np.arange(1 + N) >= 1) is None
    assert before_start(frame(2, N), np.arange(2 + N) >= 2) is not None
    f.session = f.run.copy()
    assert before_start(f, f.run == 1) is None


def test_a_run_of_three_rows_begins_with_the_speed_of_all_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    f = frame(
        3, position=np.array([1.0, 2.0, 6.0]), setpoint=np.full(3, ARCSEC), effort=np.array([0.5, 0.0, 0.0])
    )
    c = ran(monkeypatch, f, f.run == 0).command
    assert c.start_rate * ARCSEC == pytest.approx(5.0 / 5 / PERIOD_S) and np.isnan(c.setpoint).all()
    assert c.history is None and c.start_s == 0.0


def test_a_set_point_stays_in_force_where_rows_are_missing() -> None:
    present = np.array([False, True, True, False, False, True])
    x = np.array([9.0, 1.0, 2.0, 7.0, NAN, 3.0])
    assert np.array_equal(_held(x, present), [NAN, 1.0, 2.0, 2.0, 2.0, 3.0], equal_nan=True)
    x[1] = NAN
    assert np.isnan(_held(x, present)[:2]).all()
    assert _held(np.array([4.0, 9.0]), np.array([True, False])).tolist() == [4.0, 4.0]


@pytest.mark.parametrize(
    ("wanted", "out"),
    [
        ([0, 2, 4], [0, 1, 2, 3, 4, 4]),
        ([0, -2, -4], [0, -1, -2, -3, -4, -4]),
        ([0, 2, 4.9], [0, 1, 2, 3.45, 4.9, 4.9]),
        ([0, 2, 6], [0, 0, 2, 2, 6, 6]),  # twice the step is no ramp
        ([0, 2, 3], [0, 0, 2, 2, 3, 3]),
        ([5, 5, 5], [5, 5, 5, 5, 5, 5]),
        ([0, 4, 4], [0, 0, 4, 4, 4, 4]),
    ],
)
def test_ticks_between_rows_are_the_ramps_mean(wanted: list[float], out: list[float]) -> None:
    assert ticks(np.array(wanted, dtype=float)) == pytest.approx(out)
