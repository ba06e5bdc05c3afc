"""Names of volts: what they lose, by the duty, the current, the heat and the supply."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.volts import Counter, Windings
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.declaration import Response
from calibration.names import (
    adc_gain,
    adc_offset,
    backlash_loss,
    diode_braking,
    pwm_deadband,
    winding_heating,
)  # fmt: skip
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, drive

ROWS, R, K, V = 2000, 2.0, 0.4, 24.0
T: np.ndarray = PERIOD_S * np.arange(ROWS)
DUTY: np.ndarray = 0.3 * np.sin(2 * np.pi * T / 7)
CURRENT, RATE = 1.5 * np.cos(T), 3.0 * np.sin(T / 2)
FACTS = Facts("log", resistance=2.4, winding=2.0, per_ampere=140.0)


def volts(**more: Any) -> Scene:
    """Of one motor, behind a bridge."""
    fields: dict[str, Any] = {
        "at": lambda full: full, "current": CURRENT, "rate": RATE, "clock": T, "duty": DUTY,
        "supply": np.full(ROWS, V), "resistance": R, "constant": K,
    }  # fmt: skip
    s = drive(np.cumsum(RATE) * PERIOD_S, response=Response("voltage", "V"))
    s.windings = Windings(**fields | more)
    s.problem.channel = "E"
    return s


def two(**more: Any) -> Windings:
    """Motor A leads, B holds a tenth."""
    share = np.repeat([1.0, 0.1], ROWS)
    lagging = (share < 1).astype(float)
    counter = Counter(share=share, lagging=lagging, dragged=more.pop("dragged", 0.2 * lagging))
    duty, current = np.abs(np.tile(DUTY, 2)) * share, np.concatenate([CURRENT, 0.1 * CURRENT])
    fields: dict[str, Any] = {
        "at": lambda full: full, "current": current, "rate": np.tile(RATE, 2), "clock": np.tile(T, 2),
        "duty": duty, "supply": np.full(2 * ROWS, V), "counter": counter, "resistance": R, "constant": K,
    }  # fmt: skip
    return Windings(**fields | more)


def test_windings_count_motors_and_sum_over_them() -> None:
    one, both = volts().windings, two()
    assert one is not None and (one.count, both.count) == (1, 2) and not one.measured
    assert Windings(at=lambda x: x, current=T, rate=T, clock=T).measured
    assert both.together(np.repeat([1.0, 3.0], ROWS)) == pytest.approx(np.full(2 * ROWS, 4.0))
    assert one.together(T) == pytest.approx(T)


def test_a_diode_and_lost_teeth_are_of_the_motor_that_lags() -> None:
    s = volts()
    s.windings = w = two()
    assert w.counter is not None
    (c,) = diode_braking.columns(s)
    assert c.columns[:, 0] == pytest.approx(-K * w.counter.dragged) and c.sign == 1
    (c,) = backlash_loss.columns(s)
    assert c.columns[:, 0] == pytest.approx(w.duty * V * w.counter.lagging) and c.sign == 1
    s.windings = two(dragged=np.zeros(2 * ROWS))
    assert (
        diode_braking.columns(s) == []
        and diode_braking.columns(volts()) == backlash_loss.columns(volts()) == []
    )


def test_an_offset_is_resistance_times_a_constant() -> None:
    (c,) = adc_offset.columns(volts())
    assert c.columns[:, 0] == pytest.approx(np.full(ROWS, -R)) and c.labels == (("offset", "A"),)
    assert adc_offset.columns(drive(np.sin(T))) == [] == adc_gain.columns(volts())


def effects(name: Any, domain: str, **sizes: float) -> Any:
    given = {k: Parameter(v, "1") for k, v in sizes.items()}
    return name.to_plant(Finding(name.name, "E", domain, parameters=given), FACTS)


def test_what_readings_are_in_a_plant() -> None:
    one = effects(adc_offset.NAME, "current", offset=0.02, motor=2.0).effects
    assert [(e.parameters["offset"].value, e.parameters["motor"].value) for e in one] == [(0.02, 2.0)]
    each = effects(adc_offset.NAME, "current", offset_a=0.02, offset_b=-0.03).effects
    assert [(e.parameters["offset"].value, e.parameters["motor"].value) for e in each] == [
        (0.02, 1.0),
        (-0.03, 2.0),
    ]
    torque = effects(adc_offset.NAME, "current", offset_torque=7.0)
    assert torque.effects[0].parameters["offset"].value == pytest.approx(0.05)
    assert torque.effects[0].parameters["motor"].value == 1.0
    assert torque.remarks == ["adc_offset: the torque does not tell the motors apart, written to motor A"]
    (gain,) = effects(adc_gain.NAME, "current", gain=0.2, motor=1.0).effects
    assert gain.parameters["gain"].value == pytest.approx(1.25)
    kept = adc_gain.NAME.torque_kept
    assert kept is not None and kept(None, 0.2, T, 1.0) == pytest.approx(np.full(ROWS, 0.8))  # type: ignore[arg-type]


def test_a_winding_is_heated_by_its_own_loss() -> None:
    """R alpha R i times i squared through a lag, alpha 0.0039 per kelvin."""
    found = winding_heating.columns(volts())
    assert [c.fixed["time_constant"][0] for c in found] == [10.0, 20.0]  # the log lasts 20 s
    heat = np.zeros(ROWS)
    for k in range(1, ROWS):
        keep = np.exp(-PERIOD_S / 10.0)
        heat[k] = keep * heat[k - 1] + (1 - keep) * CURRENT[k] ** 2
    heat += 0  # from nothing at the first row
    first = CURRENT[0] ** 2
    lag = first * np.exp(-T / 10.0)
    got = found[0].columns[:, 0] / (0.0039 * R**2 * np.where(CURRENT == 0, 1, CURRENT))
    assert np.minimum(np.abs(got - heat - lag), np.abs(got - heat)).max() < 0.03
    assert found[0].sign == 1 and found[0].steps == pytest.approx((0.5,))
    apart = volts(since_run=T % 10.0)
    apart.problem.session = (T >= 10).astype(np.int64)
    files = winding_heating.columns(apart)
    names = [next(iter(c.fixed)) for c in files]
    assert names == ["time_constant"] * 2 + ["time_constant_in_run"] * 2
    assert files[2].columns[1000, 0] == pytest.approx(
        files[2].columns[0, 0], abs=1e-3 * np.abs(files[0].columns).max()
    )
    assert winding_heating.columns(drive(T)) == []


def test_a_plant_s_winding_warms_by_its_part_of_the_loop() -> None:
    (effect,) = effects(winding_heating.NAME, "time", thermal_resistance=2.0, time_constant=60.0).effects
    assert effect.parameters["thermal_resistance"].value == pytest.approx(2.0 * 1.2**2)
    assert effect.parameters["time_constant"].value == 60.0


def test_a_dead_band_takes_the_supply_the_way_of_the_duty() -> None:
    found = pwm_deadband.columns(volts())
    widest = np.quantile(np.abs(DUTY)[np.abs(DUTY) > 0], 0.5)
    knees = [c.fixed["knee"][0] for c in found]
    assert knees == [k for k in (0.003, 0.006, 0.012, 0.025, 0.05) if k < widest]
    c = found[3]
    assert c.columns[:, 0] == pytest.approx(V * np.clip(DUTY / 0.025, -1, 1))
    assert (c.sign, c.most, c.labels) == (1, 0.2, (("deadband", "1"),))
    assert c.shape is not None
    assert c.shape(np.array([9.0]))[:, 0] == pytest.approx(V * np.clip(DUTY / widest, -1, 1))
    assert c.shape(np.array([-1.0]))[:, 0] == pytest.approx(V * np.clip(DUTY / 1e-4, -1, 1))
    assert pwm_deadband.columns(volts(duty=np.zeros(0))) == [] == pwm_deadband.columns(drive(T))
    assert len(pwm_deadband.columns(volts(duty=DUTY / 40))) == 1 and not pwm_deadband.columns(
        volts(duty=0 * DUTY)
    )
    assert pwm_deadband.lacks(volts()) == ""
    assert pwm_deadband.lacks(drive(T)) == "a column of the duty: measured volts have lost it already"


def test_of_two_motors_a_dead_band_is_behind_the_split_or_before_it() -> None:
    s = volts()
    s.windings = w = two()
    s.problem.valid, s.problem.held = (np.full(2 * ROWS, flag) for flag in (True, False))
    found = pwm_deadband.columns(s)
    constants = [c for c in found if c.shape is None]
    assert [c.fixed for c in constants] == [{}, {"before_split": (1.0, "0 behind, 1 before the split")}]
    assert [c.twins for c in constants] == [("adc_offset",), ()] and all(c.sign == 1 for c in constants)
    assert w.counter is not None
    assert constants[1].columns[:, 0] == pytest.approx(V * w.counter.share)
    assert constants[0].columns[:, 0] == pytest.approx(np.full(2 * ROWS, V))
    assert constants[0].most == pytest.approx(np.quantile(w.duty, 0.01))
    behind = next(c for c in found if c.fixed.get("knee", (0,))[0] == 0.012 and "before_split" not in c.fixed)
    assert behind.columns[:, 0] == pytest.approx(V * np.clip(w.duty / 0.012, -1, 1))
    before = next(c for c in found if c.fixed.get("knee", (0,))[0] == 0.012 and "before_split" in c.fixed)
    effort = np.tile(np.abs(DUTY), 2)
    assert before.columns[:, 0] == pytest.approx(V * w.counter.share * np.clip(effort / 0.012, -1, 1))


@pytest.mark.parametrize(("knee", "name"), [(0.0449, "pwm_deadband"), (0.0451, UNKNOWN)])
def test_a_loss_that_grows_over_longer_pulses_is_no_dead_band(knee: float, name: str) -> None:
    """Up to twice the dead band, and five thousandths: 2 * 0.02 + 0.005."""
    given = {"knee": Parameter(knee, "1"), "deadband": Parameter(0.02, "1")}
    told = pwm_deadband.told(Finding("pwm_deadband", "E", "command", parameters=given))
    assert told.name == name
    why = "volts are lost in proportion to the duty up to the knee: no dead band does so"
    assert told.note == ("" if name != UNKNOWN else why)
