"""A table through its rig file: what becomes of every column, of the clock and of the files' starts."""

from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Response, Rig
from calibration.inputs.run import Repair, Run
from calibration.inputs.tables import of_file, over_time, read_table, signed
from tests.calibration.inputs.made import rig

PATH = Path("night one.csv")


def declared(**columns: Column) -> Rig:
    return rig(
        **({"time": Column("s", "t"), "position": Column("deg", "q"), "effort": Column("V", "u")} | columns)
    )


def read(text: str, given: Rig | None = None, path: Path = PATH) -> list[Run]:
    return read_table(path, given or declared(), text)


def rows(q: list[Any], u: list[Any] | None = None, t: list[Any] | None = None) -> str:
    k = range(len(q))
    cells = zip(t or [5 + 0.5 * x for x in k], q, u or [1.0] * len(q), strict=True)
    return "t,q,u\n" + "\n".join(",".join(map(str, row)) for row in cells) + "\n"


def refused(call: object, *more: object) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        call(*more)  # type: ignore[operator]
    return str(caught.value)


def test_columns_have_the_rigs_unit_and_the_clock_begins_at_zero() -> None:
    (r,) = read(rows([1, 2, 4]), declared(position=Column("deg", "q", scale=-2.0, offset=0.5)))
    assert r.columns["position"].tolist() == [-1.5, -3.5, -7.5] and r.columns["t"].tolist() == [0.0, 0.5, 1.0]
    assert r.raw["q"].tolist() == [1.0, 2.0, 4.0] and r.raw["t"][0] == 5.0
    assert (r.name, r.session, r.period_s, r.header, r.start_s) == (
        "night one",
        "night one",
        0.5,
        {"rig": "bench"},
        None,
    )
    assert set(r.columns) == {"t", "position", "effort"} and r.logged == {}
    told = r.signals["position"], r.signals["time"]
    assert [(s.column, s.unit, s.low, s.high, s.missing, s.wraps) for s in told] == [
        ("q", "deg", -7.5, -1.5, 0, 0), ("t", "s", 0.0, 1.0, 0, 0)
    ]  # fmt: skip
    assert read(rows([1]))[0].period_s == 1.0 and read(rows([1]))[0].rows == 1


def test_a_file_without_a_clock_has_even_rows() -> None:
    plain = rig("effort", position=Column("deg", "q"))
    (r,) = read("q,effort\n1,2\n3,4\n", replace(plain, sample_period_s=0.25))
    assert r.columns["t"].tolist() == [0.0, 0.25] and r.period_s == 0.25
    assert read("q,effort\n1,2\n3,4\n", plain)[0].columns["t"].tolist() == [0.0, 1.0]


def test_a_counter_is_joined_before_its_scale_and_its_wraps_are_counted() -> None:
    (r,) = read(rows([8, 1, 4, 9]), declared(position=Column("deg", "q", wrap=10.0, scale=0.5)))
    assert r.columns["position"].tolist() == [4.0, 5.5, 7.0, 9.5] and r.signals["position"].wraps == 1


@pytest.mark.parametrize(
    ("text", "columns", "says"),
    [
        (rows([1, 2], ["", ""]), {}, "column 'u': holds no number in any row"),
        (rows([1, "inf"]), {}, "column 'q': is infinite in data row 2"),
        (rows([1, 2, -2e60]), {}, "column 'q': is beyond 1e+60 in data row 3"),
        (rows([1, 2], t=[0, ""]), {}, "column 't': is empty in data row 2"),
        (rows([1, 2], t=[1, 1]), {}, "column 't': does not advance"),
        (
            rows([1, -2]),
            {"position": Column("deg", "q", sign_bit=3)},
            "column 'q': is signed already: leave sign_bit out",
        ),
        (
            rows([1, 2]),
            {"position": Column("deg", "q", files={"day*": 2.0})},
            "column 'q': 'files' has no number for night one",
        ),
    ],
)
def test_a_wrong_column_is_named(text: str, columns: dict[str, Column], says: str) -> None:
    assert refused(read, text, declared(**columns)) == f"night one.csv: {says}"


def test_as_large_a_number_as_there_may_be_is_read() -> None:
    assert read(rows([1, 1e60]))[0].columns["position"][1] == 1e60


def test_a_late_column_tells_of_earlier_times() -> None:
    given = declared(effort=Column("V", "u", delay_s=0.25), time=Column("s", "t", delay_s=9.0))
    (r,) = read(rows([1, 2, 3], [0.0, 4.0, 8.0]), given)
    assert r.columns["effort"].tolist() == [2.0, 6.0, 8.0] and r.logged["effort"].tolist() == [0.0, 4.0, 8.0]
    assert r.columns["t"].tolist() == [0.0, 0.5, 1.0]


def test_a_number_of_the_file_and_of_the_time_stands_for_a_column() -> None:
    steps = Column(
        "N", files={"day*": 3.0, "night*": 2.0}, steps=((0.5, 1.0), (1.0, 4.0)), scale=0.5, offset=1.0
    )
    (r,) = read(rows([1, 2, 3]), declared(load=steps))
    assert r.columns["load"].tolist() == [0.0, 2.0, 8.0]
    assert (r.signals["load"].column, r.signals["load"].high) == ("", 8.0)
    where = Column("deg", "q", files={"night*": 2.0}, integrated=True)
    (r,) = read(rows([1, 3, 5]), declared(position=where))
    assert r.columns["position"].tolist() == [0.0, 2.0, 6.0]


def test_a_column_parts_the_runs_and_a_clock_that_starts_again_does() -> None:
    labelled = declared()
    labelled.runs["column"] = "run"
    runs = read("t,q,u,run\n0,1,1,7\n1,2,2,7\n2,9,2,8\n3,8,2,8\n", labelled)
    assert [(r.name, r.columns["position"].tolist()) for r in runs] == [
        ("night one{1}", [1.0, 2.0]), ("night one{2}", [9.0, 8.0])
    ]  # fmt: skip
    two = read(rows([1, 2, 3, 4, 5, 6], t=[0, 1, 2, 0, 1, 2]))
    assert [(r.name, r.columns["position"].tolist()) for r in two] == [
        ("night one{1}", [1.0, 2.0, 3.0]), ("night one{2}", [4.0, 5.0, 6.0])
    ]  # fmt: skip


def test_stray_rows_are_told() -> None:
    t = [float(k) for k in range(200)]
    t[50] = 3.0
    (r,) = read(rows(t, t=t))
    note = "1 rows are left out: stamps that leap back or ahead, or nothing in the row"
    assert r.repairs == [Repair("leap", "time", 1, 1.0, note)] and r.rows == 199


def test_a_long_table_keeps_the_stamps_of_what_is_explained() -> None:
    lines = [f"{t / 10},q,{t}" for t in range(12)] + [f"{t / 10 + 0.05},u,{2 * t}" for t in range(11)]
    columns = {"position": Column("deg", "q"), "effort": Column("V", "u", scale=0.5)}
    long = replace(declared(**columns), long={"name": "n", "value": "v"})
    (r,) = read("t,n,v\n" + "\n".join(lines) + "\n", long)
    assert r.raw["t"] == pytest.approx(0.05 + 0.1 * np.arange(11))  # the effort's own
    assert r.columns["position"] == pytest.approx(0.5 + np.arange(11))
    assert r.logged["effort"].tolist() == list(range(11)) and r.logged["position"].tolist() == list(range(12))
    plain = replace(long, responses=(Response("position", "deg"),))
    assert read("t,n,v\n" + "\n".join(lines) + "\n", plain)[0].raw["t"][0] == 0.0


@pytest.mark.parametrize(
    ("words", "bit", "numbers"),
    [([0.0, 5.0, 8.0, 13.0, nan], 3, [0.0, 5.0, -0.0, -5.0, nan]), ([1.0, 2.0, 3.0], 1, [1.0, -0.0, -1.0])],
)
def test_a_sign_is_a_bit_of_its_own(words: list[float], bit: int, numbers: list[float]) -> None:
    assert np.array_equal(signed(PATH, np.array(words), bit, "q"), numbers, equal_nan=True)


def test_the_first_number_that_fits_a_files_name_is_its() -> None:
    assert of_file(PATH, Column("N"), "x") == 1.0
    assert of_file(PATH, Column("N", files={"*one": 2.0, "*": 3.0}), "x") == 2.0
    assert of_file(Path("day.csv"), Column("N", files={"*one": 2.0, "*": 3.0}), "x") == 3.0


def test_steps_begin_at_their_times_and_a_rate_is_summed_by_trapezes() -> None:
    t = np.array([0.0, 1.0, 2.0, 4.0])
    where = Column("N", steps=((1.0, 2.0), (2.0, 3.0)))
    assert over_time(where, t, np.ones(4)).tolist() == [0.0, 2.0, 3.0, 3.0]
    assert over_time(Column("N", integrated=True), t, np.array([1.0, nan, 3.0, 5.0])).tolist() == [
        0.0,
        1.5,
        4.0,
        12.0,
    ]
