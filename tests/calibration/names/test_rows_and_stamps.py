"""Rows that are lost or repeat, stamps that shake, and repairs as findings."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.run import Repair
from calibration.names import clock_jitter, sample_loss
from calibration.names.columns import repairs_found
from plant.units import ARCSEC
from tests.calibration.names.test_column_faults import run, sizes

ROWS, PERIOD_S, COUNT = 1000, 0.01, 0.5 * ARCSEC
PATH: np.ndarray = 300.0 * np.arange(ROWS)  # counts


def frame(position: np.ndarray, present: np.ndarray | None = None, **columns: np.ndarray) -> Any:
    n = len(position)
    there = np.ones(n, dtype=bool) if present is None else present
    every = {"position": position, **columns}
    edges = np.flatnonzero(np.diff(np.concatenate([[1], there.astype(int), [1]])))
    gaps = [int(b - a) for a, b in edges.reshape(-1, 2)]
    return Some(t=PERIOD_S * np.arange(n), present=there, gaps=gaps, columns=every, get=every.get)


def test_lost_rows_are_a_share_with_whole_packets() -> None:
    present = np.ones(10_000, dtype=bool)
    present[1000:1025] = present[5000:5025] = False
    found = sample_loss.stamps(frame(1e-5 * np.arange(1e4), present))
    assert found is not None
    share = found.parameters["packet_loss"]
    assert share.value == pytest.approx(0.005)
    half = 1.96 * np.sqrt(0.005 * 0.995 / 400)
    assert share.low == 0.0 and share.high == pytest.approx(0.005 + half)
    assert found.note == "50 rows missing in 2 gaps (100 % of whole packets), 0 rows repeated"
    present[2000:2010] = False
    found = sample_loss.stamps(frame(1e-5 * np.arange(1e4), present))
    assert found is not None and "60 rows missing in 3 gaps (67 %" in found.note
    assert sample_loss.stamps(frame(1e-5 * np.arange(1e4))) is None
    few = np.ones(10_000, dtype=bool)
    few[500:529] = False
    assert sample_loss.stamps(frame(1e-5 * np.arange(1e4), few)) is None


@pytest.mark.parametrize("length", [1, 25])
def test_rows_that_repeat_others_while_the_axis_moves_are_taken_out(length: int) -> None:
    x = 1e-5 * np.arange(4000.0) + 1e-7 * np.sin(np.arange(4000.0))
    v = np.cos(np.arange(4000.0))
    count = 40 // length
    at = 500 + 3000 // count * np.arange(count)
    for k in at:
        for column in (x, v):
            column[k : k + length] = column[k - length : k]
    given = frame(x, velocity=v)
    found = sample_loss.stamps(given)
    assert found is not None
    rows = count * length
    assert found.parameters["repeats"].value == pytest.approx(rows / 4000)
    assert found.note == f"0 rows missing in 0 gaps (0 % of whole packets), {rows} rows repeated"
    assert np.isnan(given.columns["position"]).sum() == rows


def test_an_axis_that_stands_repeats_its_rows_and_loses_none() -> None:
    x = np.concatenate([1e-5 * np.arange(2000.0), np.full(2000, 1e-5 * 2000)])
    assert sample_loss.stamps(frame(x)) is None


def clocked(shake_s: float, rows: int = 2000) -> Any:
    rng = np.random.default_rng(1)
    t = PERIOD_S * np.arange(rows)
    smooth = 1e-3 * t + 1e-6 * t**2
    clock = smooth + shake_s * rng.standard_normal(rows)
    there = np.ones(rows, dtype=bool)
    return Some(runs=[0], run=np.zeros(rows, dtype=int), present=there, t=t, clock=clock)


def test_stamps_shake_about_a_smooth_course() -> None:
    found = clock_jitter.stamps(clocked(1e-3))
    assert found is not None
    p = found.parameters["deviation"]
    assert p.value == pytest.approx(1e-3, rel=0.05) and p.unit == "s"
    assert found.share == pytest.approx(1 - (4e-5 / p.value) ** 2)
    assert clock_jitter.stamps(clocked(3.5e-5)) is None and clock_jitter.stamps(clocked(4.5e-5)) is not None
    assert (
        clock_jitter.stamps(clocked(1e-3, 50)) is None and clock_jitter.stamps(clocked(1e-3, 51)) is not None
    )


def repaired(*fixes: Repair, files: int = 1) -> list[Finding]:
    logs = [run(PATH) for _ in range(files)]
    for k, fix in enumerate(fixes):
        logs[k % files].repairs.append(fix)
    return repairs_found(logs, ("effort",))


def test_repairs_are_findings_by_kind_and_column() -> None:
    (lost,) = repaired(Repair("lost", "all", 7, 7.0, "7 rows are missing"))
    assert (lost.name, lost.note) == ("sample_loss", "all columns: 7 rows are missing")
    assert lost.parameters == {"count": Parameter(7.0, "rows", 7.0, 7.0)} and lost.share == 0.0
    (wrap,) = repaired(Repair("wrap", "aux", 1, 256.0, "a"), Repair("wrap", "aux", 2, 256.0, "b"), files=2)
    assert (wrap.name, wrap.note) == ("log_wrap", "aux column in 2 of 2 files: a")
    assert wrap.parameters["length"] == Parameter(256.0, "rig units", 256.0, 256.0)
    assert sizes(wrap)["count"] == 3.0
    (shaken,) = repaired(Repair("jitter", "all", 8, 3.0, "a"), Repair("jitter", "all", 8, 4.0, "b"))
    assert shaken.name == "clock_jitter" and sizes(shaken)["deviation"] == pytest.approx(np.sqrt(12.5))


@pytest.mark.parametrize(
    ("kind", "channel", "rows", "told"),
    [
        ("repeat", "position", 9, False), ("repeat", "position", 10, True), ("spike", "force", 2, False),
        ("spike", "force", 3, True), ("spike", "position", 1, True), ("spike", "effort", 50, False),
        ("saturation", "force", 50, False), ("leap", "force", 50, False), ("rounded", "force", 50, False),
    ],
)  # fmt: skip
def test_a_few_repairs_may_be_chance_or_the_drive_s(kind: str, channel: str, rows: int, told: bool) -> None:
    assert len(repaired(Repair(kind, channel, rows, 1.0, "why"))) == told
