"""A dead band against an ADC's offset: what tells them apart, and what is said where nothing does."""

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.balances.volts import Counter, Windings
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.names import offered
from tests.calibration.axisscene import stacked

V, R, K, COUNT = (
    24.0,
    2.0,
    0.4,
    0.0061,
)  # V, ohm, V s/rad, A: as of the telescope's motors (hardware.md 1.2, 2.4)
ROWS, PERIOD_S, RATIO = 6000, 0.03, 960.0


def electrical(lost: float, offset: float, share: float) -> Selection:
    """What the channel says of two motors. lost: duty that the driver swallows; offset: counts of a converter
    that reads both; share: of the effort, for the motor that holds against."""
    rng = np.random.default_rng(11)
    t = PERIOD_S * np.arange(ROWS)
    effort = 0.12 + 0.08 * np.sin(2 * np.pi * t / 31.0) + 0.03 * np.sin(2 * np.pi * t / 7.3)
    duty = np.concatenate([effort, share * effort])
    spin = np.concatenate([1.5 + 1.2 * np.sin(2 * np.pi * t / 47.0), np.zeros(ROWS)])
    true = (np.maximum(duty - lost, 0.0) * V - K * spin) / R
    current = true + COUNT * (offset + 0.3 * rng.standard_normal(2 * ROWS))
    lagging = np.repeat([0.0, 1.0], ROWS)
    run = np.tile(np.repeat(np.arange(4), ROWS // 4), 2)
    problem = Problem(
        channel="E", unit="V", y=duty * V, base=np.column_stack([current, spin]),
        base_labels=[("resistance", "ohm"), ("torque_constant", "N m/A")],
        t=np.tile(t, 2), run=run, session=np.zeros(2 * ROWS, dtype=np.int64),
        valid=np.ones(2 * ROWS, dtype=bool), held=run == 3, period_s=PERIOD_S,
        ar_order=4, block_s=3.0,
    )  # fmt: skip
    scene = stacked(
        problem, PERIOD_S * np.cumsum(spin[:ROWS]) / RATIO, {"resistance": R, "torque_constant": K}
    )
    scene.windings = Windings(
        at=lambda full: full, current=current, rate=spin, clock=problem.t,
        duty=duty, supply=np.full(2 * ROWS, V), resistance=R, constant=K,
        counter=Counter(
            share=np.where(lagging > 0, share, 1.0), lagging=lagging,
            dragged=np.zeros(2 * ROWS),
        ),
    )  # fmt: skip
    return select(problem, offered(scene), rng)


def test_pulses_shorter_than_a_dead_band_name_it() -> None:
    said = electrical(lost=0.009, offset=0.0, share=0.1)  # the lagging motor's duties are 0.1 to 2.3 %
    assert [c.candidate.name for c in said.chosen] == ["pwm_deadband"]
    assert all(not c.confounded for c in said.chosen)
    (_, size), *_ = said.fitted
    assert size[0] == pytest.approx(0.009, rel=0.02)


def test_an_offset_is_no_dead_band_where_pulses_are_short() -> None:
    said = electrical(lost=0.0, offset=-8.0, share=0.1)
    assert {c.candidate.name for c in said.chosen} == {"adc_offset"}


def test_long_pulses_cannot_tell_one_from_the_other() -> None:
    said = electrical(lost=0.004, offset=0.0, share=0.5)  # no duty below 0.4 %
    found = said.chosen[0].candidate
    names = {found.name, *found.twins, *(c.candidate.name for c in said.chosen[0].confounded)}
    assert len(said.chosen) == 1
    assert names == {"pwm_deadband", "adc_offset"}
