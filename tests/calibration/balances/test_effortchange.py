"""The command residual: the gains of a loop made here, rows where no rate is followed, and pulses."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.effortchange import ROUNDING, incremental_law, pulses, resting, usual_regime
from calibration.finding import Finding
from plant.units import ARCSEC

ROWS, KP, KI, FULL, COUNT_ARCSEC, TICK_S = 6000, 3.0, 0.25, 3000.0, 0.0115, 0.005
RUN = np.repeat([0, 1], ROWS // 2)


def loop(gain: float = 1.0) -> Any:
    """A log of the paper's incremental law at 5 ms, of which every second tick is a row, in two runs."""
    rng = np.random.default_rng(5)
    ticks = 2 * ROWS
    wanted = np.cumsum(rng.normal(0, 0.3, ROWS)) + 40.0
    wanted = np.append(np.repeat(wanted, 2)[1:], wanted[-1])  # a row's is that of the tick before, too
    counts = np.round(wanted + rng.normal(0, 3.0, ticks))
    error = wanted - counts
    change = KP * np.diff(error, prepend=0.0) + KI * error
    effort = 400.0 + gain * np.cumsum(change)
    per_count = COUNT_ARCSEC * ARCSEC
    columns = {
        "setpoint": wanted[::2] * per_count / TICK_S,
        "velocity": counts[::2] * per_count / TICK_S,
        "position": np.cumsum(counts)[::2] * per_count,
        "effort": effort[::2] / FULL,
    }
    return frame(columns)


def frame(columns: dict[str, np.ndarray]) -> Any:
    rows = len(columns["effort"])
    return Some(
        columns=columns,
        get=columns.get,
        filled=lambda name: (columns[name], None),
        transients=lambda: np.zeros(rows, dtype=bool),
        scale={
            "velocity_window_s": TICK_S, "velocity_arcsec_per_count": COUNT_ARCSEC, "effort_full_scale": FULL
        },
        run=RUN[:rows], session=RUN[:rows], t=0.01 * np.arange(rows), period_s=0.01,
    )  # fmt: skip


def gains(law: Any) -> np.ndarray:
    p = law.problem
    return np.linalg.lstsq(p.base[p.valid], p.y[p.valid], rcond=None)[0]


def test_gains_are_those_of_the_law_that_made_the_log() -> None:
    """dU = Kp (E - E'') + Ki (E + E'): of an error, the tick's between, the row before and its between."""
    law = incremental_law(loop(), np.zeros(ROWS, dtype=bool))
    assert law is not None
    assert gains(law) == pytest.approx([KP + KI, KI, -KP, 0.0], abs=1e-6)
    assert law.labels == [(f"gain_{k}", "1/3000 per count") for k in range(4)]
    assert law.problem.unit == "1/3000" and law.problem.channel == "S"
    rows = law.problem.valid
    assert not rows[[0, 1, ROWS // 2]].any() and rows.sum() > 0.99 * ROWS  # of every run the first is none
    assert set(law.rates) == {"set_point_limit", "rate_limit"}


def test_an_effort_in_whole_steps_has_their_rounding_as_floor() -> None:
    """Of a difference of two even roundings: sqrt(2 / 12) steps."""
    plain = loop()
    law = incremental_law(plain, np.zeros(ROWS, dtype=bool))
    assert law is not None and law.problem.floor == 0.0
    plain.columns["effort"] = np.round(plain.columns["effort"] * FULL) / FULL
    law = incremental_law(plain, np.zeros(ROWS, dtype=bool))
    assert law is not None and law.problem.floor == ROUNDING == pytest.approx(0.408, abs=1e-3)


def test_rows_at_full_effort_and_in_transients_say_nothing_of_the_law() -> None:
    given = loop()
    effort = given.columns["effort"]
    effort[2000:2100] = 1.0
    quick = np.zeros(ROWS, dtype=bool)
    quick[4000:4100] = True
    given.transients = lambda: quick
    law = incremental_law(given, np.zeros(ROWS, dtype=bool))
    assert law is not None
    assert not law.problem.valid[2000:2100].any() and not law.problem.valid[4000:4100].any()
    assert law.problem.valid[1900:1999].all() and law.problem.valid[4101:4200].all()


@pytest.mark.parametrize("gone", ["setpoint", "velocity"])
def test_without_set_point_or_velocity_there_is_no_law(gone: str) -> None:
    given = loop()
    del given.columns[gone]
    assert incremental_law(given, np.zeros(ROWS, dtype=bool)) is None


def test_a_few_rows_are_no_law() -> None:
    given = loop()
    for name, column in given.columns.items():
        column[100:] = np.nan if name == "velocity" else column[100:]
    assert incremental_law(given, np.zeros(ROWS, dtype=bool)) is None


def test_at_rest_and_on_the_ramp_into_it_no_rate_is_followed() -> None:
    """Two rows after it, too; a ramp that ends above nothing is followed, and so is one that rises."""
    setpoint = np.array([5.0, 5.0, 4.0, 2.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 1.0, -1.0, -0.5, 0.0])
    run = np.zeros(16, dtype=np.int64)
    expected = [False, True, True, True, True, True, True, True, *[False] * 5, True, True, True]
    assert resting(setpoint, run).tolist() == expected


def test_another_run_has_no_ramp_into_this_one_s_rest() -> None:
    setpoint = np.array([9.0, 8.0, 7.0, 0.0, 0.0])
    assert resting(setpoint, np.array([0, 0, 0, 1, 1])).tolist() == [False, False, False, True, True]
    assert resting(setpoint, np.zeros(5, dtype=np.int64)).tolist() == [True] * 5


@pytest.mark.parametrize(
    ("rows", "expected"), [((600, 200, 100), 0), ((100, 600, 200), 1), ((100, 200, 600), 2)]
)
def test_the_commonest_of_three_regimes_is_looked_at(rows: tuple[int, ...], expected: int) -> None:
    """A set rate; a position loop that creeps, which moves the set point at every tick; one that slews."""
    rng = np.random.default_rng(1)
    parts = [np.full(rows[0], 15.0), 50.0 + rng.normal(0, 1, rows[1]), 900.0 + rng.normal(0, 1, rows[2])]
    kept = usual_regime(np.concatenate(parts), np.ones(sum(rows), dtype=bool))
    shares = [float(np.mean(each)) for each in np.split(kept, np.cumsum(rows)[:-1])]
    assert shares[expected] > 0.9 and all(s < 0.3 for k, s in enumerate(shares) if k != expected)


def test_rows_that_are_no_good_do_not_count_for_a_regime() -> None:
    setpoint = np.concatenate([np.full(600, 15.0), 50.0 + np.random.default_rng(1).normal(0, 1, 400)])
    valid = np.arange(1000) >= 500
    kept = usual_regime(setpoint, valid)
    assert kept[650:].all() and not kept[5:500].any()


def pulsed(period: int, size: float = 20.0, jitter: float = 0.0, rows: int = 20_000) -> Finding | None:
    """Noise of rms 1 with pulses up and down again; of the gaps `jitter` is drawn anew."""
    rng = np.random.default_rng(4)
    e = rng.standard_normal(rows)
    at = np.arange(100, rows - 10, period)
    at = np.where(rng.random(len(at)) < jitter, rng.integers(0, rows - 10, len(at)), at)
    e[at] += size
    e[at + 3] -= size
    train = np.ones(rows, dtype=bool)
    problem: Any = Some(train=train, t=0.01 * np.arange(rows), period_s=0.01, unit="1/3000")
    return pulses(problem, e)


@pytest.mark.parametrize("period", [150, 400])
def test_pulses_at_a_period_are_told_with_it_and_their_size(period: int) -> None:
    found = pulsed(period)
    assert found is not None
    assert (found.name, found.channel, found.domain) == ("unknown", "S", "command")
    assert found.note == f"pulses on the command, every {0.01 * period:.2f} s"
    assert found.parameters["period"].value == pytest.approx(0.01 * period, rel=1e-3)
    assert found.parameters["size"].value == pytest.approx(20.0, rel=0.02)
    two = 2 * 20.0**2 / period
    assert found.share == pytest.approx(two / (two + 1), rel=0.1)
    assert found.evidence > 10


def test_noise_a_few_spikes_and_irregular_ones_are_no_pulses() -> None:
    assert pulsed(400, size=0.0) is None
    assert pulsed(400, rows=1500) is None
    assert pulsed(400, jitter=1.0) is None
