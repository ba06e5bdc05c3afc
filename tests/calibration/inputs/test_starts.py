"""When files begin: by their clocks, their names or their order; and what is repaired of a table."""

from dataclasses import replace
from datetime import datetime
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.inputs import tables
from calibration.inputs.run import Run
from calibration.inputs.tables import read_table, repair_tables, set_starts
from tests.calibration.inputs.made import rig
from tests.calibration.inputs.test_table_columns import PATH, declared, read, refused, rows


def started(
    *firsts: float | None, wall: dict[str, Any] | None = None, clock: bool = True
) -> tuple[str, list[Any]]:
    runs = []
    for k, first in enumerate(firsts):
        t = np.arange(3.0)
        r = Run(f"r{k}", PATH, "", {"t": t}, {"t": t + (first or 0.0)}, period_s=1.0)
        r.start_s = first if wall else None
        runs.append(r)
    given = declared() if clock else rig("position")
    return set_starts(runs, replace(given, wall_time=wall or {})), [(r.start_s, r.in_order) for r in runs]


OWN, ORDER = "the files' own clock", "the order of the files, end to end"


@pytest.mark.parametrize(
    ("firsts", "wall", "clock", "told"),
    [
        ((100.0, 50.0), {"from": "time"}, True, (OWN, [(50.0, False), (0.0, False)])),
        ((100.0, None), {"from": "name", "gap_s": 5.0}, True, (ORDER, [(0.0, False), (8.0, False)])),
        ((3.0, 0.0), None, True, (OWN, [(3.0, False), (0.0, False)])),  # one ends before the other begins
        ((2.0, 0.0), None, True, (ORDER, [(0.0, True), (3.0, True)])),
        ((0.0, 0.0, 0.0), None, True, (ORDER, [(0.0, True), (3.0, True), (6.0, True)])),
        ((7.0,), None, True, (ORDER, [(0.0, True)])),
        ((9.0, 0.0), None, False, (ORDER, [(0.0, True), (3.0, True)])),
    ],
)
def test_files_begin_by_their_clock_or_in_their_order(firsts: Any, wall: Any, clock: bool, told: Any) -> None:
    assert started(*firsts, wall=wall, clock=clock) == told


def test_a_start_is_the_clocks_or_the_names() -> None:
    timed = replace(declared(), wall_time={"from": "time"})
    assert read(rows([1, 2]), timed)[0].start_s == 5.0
    named = replace(declared(), wall_time={"from": "name", "format": "%Y-%m-%d"})
    (r,) = read(rows([1, 2]), named, Path("2024-05-01.csv"))
    assert r.start_s == datetime(2024, 5, 1).timestamp()
    assert refused(read, rows([1, 2]), named) == (
        "night one.csv: its name does not read as wall_time.format '%Y-%m-%d'"
    )
    assert read(rows([1, 2]), replace(declared(), wall_time={"gap_s": 3.0}))[0].start_s is None


def test_repairs_of_stamps_are_for_a_column_of_stamps(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[str] = []
    for name in ("read_signed", "repair", "steady_stamps"):
        monkeypatch.setattr(tables, name, lambda *_, name=name: called.append(name))
    repair_tables([Run("a", PATH, "", {})], declared())
    assert called == ["read_signed", "repair", "steady_stamps"]
    called.clear()
    repair_tables([Run("a", PATH, "", {})] * 2, rig("position"))
    assert called == ["read_signed", "repair", "repair"]


def test_infinite_numbers_are_found_where_they_are(tmp_path: Path) -> None:
    path = tmp_path / "b.csv"
    path.write_text(rows([1, 2]))
    assert read_table(path, declared())[0].rows == 2
    np.savez(tmp_path / "C.npz", t=[0.0, 1.0], q=[1.0, inf], u=[1.0, 1.0])
    assert refused(read_table, tmp_path / "C.npz", declared()).endswith(
        "column 'q': is infinite in data row 2"
    )
