"""Columns that a balance of volts takes up: a converter's half count, ripple, what a tick differs by."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.bridge import _sound, add_bridge, add_sampling, adopt, mean_currents, undo_sampling
from calibration.balances.problem import Problem
from calibration.balances.volts import Windings

ROWS, PERIOD_S, V, R, K, COUNT_A = 4000, 0.01, 24.0, 2.0, 0.4, 0.01
RNG = np.random.default_rng(1)
T: np.ndarray = PERIOD_S * np.arange(ROWS)
DUTY: np.ndarray = 0.4 + 0.3 * np.sin(T) + 0.05 * np.sin(17 * T)
RATE: np.ndarray = 5 + 3 * np.sin(0.7 * T)


def problem(y: np.ndarray, base: np.ndarray, names: tuple[str, ...]) -> Problem:
    label = np.zeros(len(y), dtype=np.int64)
    return Problem(
        channel="E", unit="V", y=y, base=base, base_labels=[(name, "") for name in names],
        t=0.01 * np.arange(float(len(y))), run=label, session=label, valid=label == 0,
        held=np.arange(len(y)) % 100 > 80, period_s=PERIOD_S, ar_order=0, block_s=1.0,
    )  # fmt: skip


def adopted(size: float, least: float = 0.0, noise: float = 0.1, unit: str = "1") -> list[tuple[str, str]]:
    column = np.sin(3 * T)
    y = 2.0 + size * column + noise * np.random.default_rng(2).standard_normal(ROWS)
    p = problem(y, np.ones((ROWS, 1)), ("offset",))
    adopt(p, column, "more", unit, least)
    assert p.base.shape[1] == len(p.base_labels)
    return p.base_labels[1:]


@pytest.mark.parametrize(
    ("size", "least", "taken"),
    [(0.5, 0.0, True), (-0.5, 0.0, False), (0.5, 0.6, False), (0.5, 0.4, True), (0.005, 0.0, False)],
)
def test_a_column_is_taken_up_where_it_surely_explains_and_is_positive(
    size: float, least: float, taken: bool
) -> None:
    assert adopted(size, least) == ([("more", "1")] if taken else [])
    assert adopted(size, least, unit="V") == ([("more", "V")] if taken else [])


def test_a_column_explains_25_in_log_likelihood() -> None:
    """n / 2 times log(1 + s2 / 2 / noise2) of a sine: of 3240 rows 0.18 and 0.17 of the noise's rms."""
    assert adopted(0.0155) == [] and adopted(0.0205) == [("more", "1")]


def windings(current: np.ndarray) -> Windings:
    return Windings(
        at=lambda full: full, current=current, rate=RATE, clock=T, duty=DUTY, supply=np.full(ROWS, V)
    )  # fmt: skip


def sampled(ripple: float, counts: float, sag: float = 0.0, noise: float = 0.002) -> list[str]:
    """Terms taken up where a current reads ripple / R V d (1 - d) too much and `counts` too little."""
    true = (DUTY * V - K * RATE) / R
    true = true - sag / R * DUTY * DUTY * true
    read = true + ripple / R * V * DUTY * (1 - DUTY) - counts * COUNT_A
    y = DUTY * V + noise * np.random.default_rng(3).standard_normal(ROWS)
    p = problem(y, np.column_stack([read, RATE]), ("resistance", "torque_constant"))
    add_sampling(p, windings(read), COUNT_A)
    units = {"conversion_offset": "ohm", "current_ripple": "1"}
    assert all(unit == units[name] for name, unit in p.base_labels[2:])
    if "current_ripple" in dict(p.base_labels):
        found = p.named(p.fit())
        assert found["current_ripple"].value == pytest.approx(ripple, rel=0.1)
        assert found["conversion_offset"].value == pytest.approx(counts * R, rel=0.1)
    return [name for name, _ in p.base_labels[2:]]


def test_ripple_and_half_a_count_are_taken_up_within_their_bounds() -> None:
    assert sampled(0.01, 0.5) == ["current_ripple", "conversion_offset"]
    assert sampled(0.0, 0.0) == []
    assert sampled(0.06, 0.5) == []  # more than any winding has
    assert sampled(0.01, 3.0) == []  # more than a converter rounds down


def test_a_converter_that_rounds_down_stands_alone() -> None:
    assert sampled(0.0, 0.5) == ["conversion_offset"]
    assert sampled(0.0, 0.5, noise=1.0) == []


def test_a_supply_that_gives_way_is_left_to_its_own_name() -> None:
    assert sampled(0.0, 0.0, sag=0.3) == []


@pytest.mark.parametrize(
    ("ripple", "offset", "error", "sound"),
    [
        (0.01, 1.0, 1e-4, True), (0.0039, 1.0, 1e-4, False), (0.031, 1.0, 1e-4, False),
        (0.01, 0.49, 1e-4, False), (0.01, 0.51, 1e-4, True),
        (0.01, 1.59, 1e-4, True), (0.01, 1.61, 1e-4, False), (0.01, 1.0, 0.01, False),
    ],
)  # fmt: skip
def test_bounds_of_ripple_and_offset(ripple: float, offset: float, error: float, sound: bool) -> None:
    """L / R of motors and of the converter: 0.004 to 0.03, and a quarter to 0.8 of 2 ohm."""
    p = problem(T, np.column_stack([RATE, T]), ("resistance", "torque_constant"))
    fit: Any = Some(beta=np.array([R, K, ripple, offset, -9.0]), errors=np.full(5, error))
    assert _sound(p, fit, ("current_ripple", "conversion_offset", "sag")) == sound
    assert _sound(p, fit, ("sag",))


def frame() -> Any:
    columns = {"current_a": np.array([1.0, 2.0, 0.0, 9.0]), "current_b": np.full(4, 0.5)}
    return Some(
        columns=columns, scale={"supply_V": V, "adc_A_per_count": COUNT_A, "counter_torque": 0.1}, runs=[],
        run=np.zeros(4, dtype=int), t=np.arange(4.0), saturated=lambda i: i >= 9.0,
        filled=lambda _: (np.array([0.5, 0.2, 0.5, 0.5]), None),
    )  # fmt: skip


def test_sampled_currents_become_means() -> None:
    """Less ripple V d (1 - d), plus half a count; what reads nothing or the converter's end stays."""
    f = frame()
    undo_sampling(f, 0.02)
    a = [1.0 - 0.02 * 24 * 0.25 + 0.005, 2.0 - 0.02 * 24 * 0.16 + 0.005, 0.0, 9.0]
    assert f.columns["current_a"] == pytest.approx(a)
    b = 0.5 + 0.005 - 0.02 * 24 * np.array([0.05 * 0.95, 0.02 * 0.98, 0.05 * 0.95, 0.05 * 0.95])
    assert f.columns["current_b"] == pytest.approx(b)


@pytest.mark.parametrize("ripple", [0.02, None])
def test_what_volts_have_shown_is_undone(ripple: float | None) -> None:
    names = ("resistance", "conversion_offset", *(() if ripple is None else ("current_ripple",)))
    p: Any = Some(named=lambda _: {n: Some(value=v) for n, v in zip(names, (R, 1.2, ripple), strict=False)})
    f, by_hand = frame(), frame()
    mean_currents(f, p, Some())  # type: ignore[arg-type]
    undo_sampling(by_hand, (ripple or 0.0) / R, 0.6)
    assert np.array_equal(f.columns["current_a"], by_hand.columns["current_a"])
    untouched = frame()
    none: Any = Some(named=lambda _: {"resistance": Some(value=R)})
    mean_currents(untouched, none, Some())  # type: ignore[arg-type]
    assert untouched.columns["current_a"].tolist() == [1.0, 2.0, 0.0, 9.0]


def test_a_register_that_waits_is_taken_up_where_volts_show_it() -> None:
    effort = 0.2 + 0.1 * np.sin(0.3 * T)
    share = np.abs(effort) * 0.1 * 30  # of a full scale of 30 steps the counter torque has less than one
    held = np.zeros(ROWS)
    now = 0.0
    for k in range(ROWS):
        if k == 0 or abs(share[k] - now) >= 1.0:
            now = np.floor(share[k] + 0.5)
        held[k] = now
    off = np.concatenate([np.zeros(ROWS), (held - share) / 30])
    f: Any = Some(
        t=T, run=np.zeros(ROWS, dtype=int), runs=[], get=lambda _: None,
        scale={"counter_torque": 0.1, "effort_full_scale": 30.0},
    )  # fmt: skip
    duty = np.concatenate([effort, 0.1 * effort])
    y = np.random.default_rng(3).standard_normal(2 * ROWS) * 0.05 - V * off
    p = problem(y, np.ones((2 * ROWS, 1)), ("offset",))
    w = Windings(at=lambda full: full, current=y, rate=y, clock=y, duty=duty, supply=np.full(2 * ROWS, V))
    add_bridge(p, w, f, effort)
    assert [name for name, _ in p.base_labels] == ["offset", "held_counter_register"]
    assert p.plain_fit(p.train)[0]["held_counter_register"] == pytest.approx(1.0, rel=0.05)
