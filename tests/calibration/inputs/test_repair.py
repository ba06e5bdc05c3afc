"""Repairs: what was broken on purpose comes back, and what is sound stays as it is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.inputs.repair import repair
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import Run, signal_of

ROWS, PERIOD_S = 3000, 0.01
RIG = """rig: made up
turn: 360
columns:
  time: {column: t, unit: s}
  position: {column: q, unit: deg}
  effort: {column: u, unit: N m}
response: {channel: effort, unit: N m}
"""


def rig(folder: Path):  # type: ignore[no-untyped-def]
    path = folder / "rig.yaml"
    path.write_text(RIG, encoding="utf-8")
    return load_rig(path)


def made(seed: int, rate: float = 20.0) -> Run:
    """A drive that goes to and fro by up to 40 degrees, its effort smooth, both with sensor noise."""
    rng = np.random.default_rng(seed)
    t = PERIOD_S * np.arange(ROWS)
    q = 40 * np.sin(rate / 40 * t) + 0.001 * rng.standard_normal(ROWS)
    u = 2 * np.cos(rate / 40 * t) + 0.02 * rng.standard_normal(ROWS)
    return recorded(q, u, t)


def recorded(q: np.ndarray, u: np.ndarray, t: np.ndarray) -> Run:
    r = Run("a", Path("a"), "a", {"t": t, "position": q, "effort": u}, period_s=PERIOD_S)
    r.signals = {c: signal_of(c, c, "", x, 0) for c, x in r.columns.items()}
    return r


@pytest.mark.parametrize("seed", range(5))
def test_a_sound_record_is_left_as_it_is(tmp_path: Path, seed: int) -> None:
    r = made(seed)
    before = {c: x.copy() for c, x in r.columns.items()}
    repair(r, rig(tmp_path))
    assert not r.repairs
    for c, x in before.items():
        assert np.array_equal(r.columns[c], x), c


@pytest.mark.parametrize("seed", range(5))
def test_spikes_are_left_out_and_nothing_else(tmp_path: Path, seed: int) -> None:
    r = made(seed)
    at = np.random.default_rng(seed).choice(np.arange(10, ROWS - 10), 6, replace=False)
    r.columns["effort"][at] += 30.0
    repair(r, rig(tmp_path))
    assert set(np.flatnonzero(np.isnan(r.columns["effort"]))) == set(at.tolist())
    assert [(x.kind, x.channel, x.rows) for x in r.repairs] == [("spike", "effort", 6)]


@pytest.mark.parametrize("start", [0.0, 100.0, 359.0])
def test_a_circle_that_nobody_declared_is_joined(tmp_path: Path, start: float) -> None:
    t = PERIOD_S * np.arange(ROWS)
    true = start + 100.0 * t
    r = recorded(true % 360.0, 2 + 0.02 * np.random.default_rng(1).standard_normal(ROWS), t)
    repair(r, rig(tmp_path))
    assert np.diff(r.columns["position"]) == pytest.approx(np.diff(true))
    (found,) = r.repairs
    assert (found.kind, found.size) == ("wrap", 360.0)
    assert found.rows == int(true[-1] // 360.0) - int(true[0] // 360.0)


@settings(max_examples=15, deadline=None)
@given(at=st.integers(300, ROWS - 300), size=st.floats(5.0, 200.0), sign=st.sampled_from([-1.0, 1.0]))
def test_a_counter_that_lost_its_zero_is_joined(
    tmp_path_factory: pytest.TempPathFactory, at: int, size: float, sign: float
) -> None:
    r = made(3)
    true = r.columns["position"].copy()
    r.columns["position"][at:] += sign * size
    repair(r, rig(tmp_path_factory.mktemp("rig")))
    assert np.diff(r.columns["position"]) == pytest.approx(np.diff(true), abs=0.5)
    (found,) = r.repairs
    assert found.kind == "leap"
    assert found.size == pytest.approx(sign * size, abs=0.5)


def test_an_effort_at_the_end_of_its_range_says_nothing_there(tmp_path: Path) -> None:
    r = made(4, rate=80.0)
    clipped = np.clip(r.columns["effort"], -1.5, 1.5)
    r.columns["effort"] = clipped.copy()
    repair(r, rig(tmp_path))
    assert np.array_equal(np.isnan(r.columns["effort"]), np.abs(clipped) == 1.5)
    assert [x.kind for x in r.repairs] == ["saturation"] * 2


def test_frames_that_were_lost_repeat_the_row_before_and_are_left_out(tmp_path: Path) -> None:
    r = made(5)
    at = np.array([400, 900, 1500, 2200])  # quick motion there
    at = at[np.abs(np.gradient(r.columns["position"]))[at] > 0.05]
    for c in ("position", "effort"):
        r.columns[c][at] = r.columns[c][at - 1]
    repair(r, rig(tmp_path))
    if len(at) >= 3:
        assert set(np.flatnonzero(np.isnan(r.columns["position"]))) == set(at.tolist())
        assert "repeat" in [x.kind for x in r.repairs]


def test_rows_missing_here_and_there_are_counted(tmp_path: Path) -> None:
    r = made(6)
    keep = np.ones(ROWS, dtype=bool)
    keep[np.arange(100, ROWS, 100)] = False
    r.columns = {c: x[keep] for c, x in r.columns.items()}
    repair(r, rig(tmp_path))
    (found,) = r.repairs
    assert (found.kind, found.rows) == ("lost", int((~keep).sum()))


@pytest.mark.parametrize("seed", range(4))
def test_rows_are_put_later_where_rows_are_missing_and_nobody_stamped_it(tmp_path: Path, seed: int) -> None:
    """A logger that stamps by the row's number: only the position tells. At rest nothing does."""
    rng = np.random.default_rng(seed)
    r = made(seed)
    keep = rng.random(ROWS) > 0.02
    true_s, quick = r.columns["t"][keep], np.abs(np.cos(0.5 * r.columns["t"][keep])) > 0.3
    r.columns = {c: x[keep] for c, x in r.columns.items()}
    r.columns["t"] = PERIOD_S * np.arange(int(keep.sum()))
    repair(r, rig(tmp_path))
    (found,) = r.repairs
    assert found.kind == "lost"
    told, truth = np.diff(r.columns["t"]), np.diff(true_s)
    assert np.all((told < 1.5 * PERIOD_S) | np.isclose(told, truth))  # none where none is missing
    clear = quick[1:] & (truth > 1.5 * PERIOD_S)
    assert np.isclose(told, truth)[clear].mean() > 0.9


def test_the_sum_of_a_speed_has_lost_no_rows(tmp_path: Path) -> None:
    """Twice the speed in a row is that speed: its clock does not stand."""
    r, summed = made(1), rig(tmp_path)
    step = np.diff(r.columns["position"], prepend=0.0) * np.where(np.arange(ROWS) % 50 == 25, 2.0, 1.0)
    r.columns["position"] = np.cumsum(step)
    before = r.columns["t"].copy()
    position = replace(summed.columns["position"], integrated=True)
    repair(r, replace(summed, columns={**summed.columns, "position": position}))
    assert np.array_equal(r.columns["t"], before)


def test_a_motion_in_uneven_steps_has_lost_nothing(tmp_path: Path) -> None:
    """A drive that is pushed on by half a row's way, one way and the other, in every thirtieth row."""
    r = made(3)
    push = 0.1 * (np.arange(ROWS) % 30 == 0) * np.sign(np.cos(0.5 * r.columns["t"]))
    r.columns["position"] = r.columns["position"] + np.cumsum(push)
    repair(r, rig(tmp_path))
    assert "lost" not in [x.kind for x in r.repairs]


def test_a_step_of_an_effort_through_zero_is_no_wrap(tmp_path: Path) -> None:
    """From -20 to 486 counts in a row: a register of 512 values holds either of them, not both."""
    t = PERIOD_S * np.arange(ROWS)
    counts = np.where(t < 12, -20.0, 486.0) + np.round(2 * np.sin(t))
    r = recorded(40 * np.sin(t), counts, t)
    repair(r, rig(tmp_path))
    assert not r.repairs
    assert np.array_equal(r.columns["effort"], counts)


@pytest.mark.parametrize("bits", [10, 12, 16])
def test_a_word_with_a_sign_is_read_so_wherever_the_run_begins(tmp_path: Path, bits: int) -> None:
    """Of a short word only the jump through zero tells; the first row is below it."""
    t = PERIOD_S * np.arange(ROWS)
    noise = np.random.default_rng(bits).standard_normal(ROWS)
    counts = np.round(-200 * np.cos(2 * np.pi * t / 7.0) + 2 * noise)
    r = recorded(40 * np.sin(t), counts % 2.0**bits, t)
    repair(r, rig(tmp_path))
    assert [x.kind for x in r.repairs] == ["signed"]
    assert np.array_equal(r.columns["effort"], counts)


def test_a_supply_that_breaks_down_is_no_counter(tmp_path: Path) -> None:
    """36 V fall to 13 V and come back by steps of 22 and 23 V: no length of a circle that a supply has."""
    r = made(1)
    volts = np.full(ROWS, 36.0) + 0.02 * np.random.default_rng(2).standard_normal(ROWS)
    volts[1000:1400] -= 22.6
    r.columns["supply"] = volts.copy()
    r.signals["supply"] = signal_of("supply", "supply", "V", volts, 0)
    path = tmp_path / "rig.yaml"
    path.write_text(RIG.replace("response:", "  supply: {column: s, unit: V}\nresponse:"), encoding="utf-8")
    repair(r, load_rig(path))
    assert np.array_equal(r.columns["supply"], volts)
    assert not r.repairs


@pytest.mark.parametrize("top", [250.0, 255.0, 300.0])
def test_an_effort_that_is_switched_on_and_off_is_no_counter(tmp_path: Path, top: float) -> None:
    """All of an eight-bit converter's range, or about a circle's degrees."""
    r = made(8)
    switched = np.where(np.arange(ROWS) // 100 % 2, top, 0.0)
    r.columns["effort"] = switched.copy()
    repair(r, rig(tmp_path))
    assert np.array_equal(r.columns["effort"], switched) and not r.repairs
