"""JSON as a table, stamps in words, and a table with a row per reading: each word by word."""

from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.shapes import is_json, is_stamp, seconds, table_of_json, wide, with_seconds

PATH = Path("a.json")
NAN = float("nan")


def refused(call: object, *more: object) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        call(*more)  # type: ignore[operator]
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "table"),
    [
        ('{"t": 0, "q": 1.5}\n\n{"t": 1, "u": true}\n', "t\tq\tu\n0\t1.5\t\n1\t\t1"),
        ('[{"t": 0}, {"t": null, "q": "a b"}]', "t\tq\n0\t\n\ta b"),
        ('{"t": [0, 1], "q": [5, 6]}', "t\tq\n0\t5\n1\t6"),
        ('{"a": {"b": [1, 2]}, "c": "x\\ty"}', "a.b.0\ta.b.1\tc\n1\t2\tx y"),
        ('{"t": 0, "q": []}', "t\n0"),
        ("[[1, 2], [3, 4]]", "0\t1\n1\t2\n3\t4"),
        ('{"t": 0}\n{"t": 1}\n{"t": 2, "q"', "t\n0\n1"),  # cut off
        ('{"a b": {"": 3}}', "a b.\n3"),
        ('{"rate": 1, "names": ["t"], "data": [[1, 2], [3, 4]]}', "data.0\tdata.1\n1\t2\n3\t4"),
        ('{"log": [{"t": 5}, {"t": 6}], "by": "me"}', "log.t\n5\n6"),
        ('{"t": [0, 1], "u": [[5], [6]]}', "t\tu.0\n0\t5\n1\t6"),
    ],
)
def test_json_is_a_column_for_every_key(text: str, table: str) -> None:
    assert is_json(text) and table_of_json(PATH, text) == table


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[]", "a.json:1: has no data rows: JSON with an object per row is needed"),
        ("[1, 2]", ""),
        ('{"t": [0, 1], "q": [5]}', "a.json:1: is JSON whose lists have different lengths"),
        ('{"t": 0}\n{"t" 1}\n{"t": 2}\n', "a.json:2: is not JSON: Expecting ':' delimiter"),
        ("{}", "a.json:1: has no data rows: JSON with an object per row is needed"),
    ],
)
def test_json_without_rows_says_so(text: str, says: str) -> None:
    if says:
        assert refused(table_of_json, PATH, text) == says
    else:
        assert table_of_json(PATH, text) == "\n1\n2"


def test_json_begins_with_a_brace_or_a_bracket() -> None:
    assert [is_json(x) for x in (" \n{", "[1", "t,{", "", " ")] == [True, True, False, False, False]


def test_a_stamp_is_in_utc_where_it_says_no_zone() -> None:
    assert seconds("1970-01-01T00:01:00", "iso") == seconds("1970-01-01T01:01:00+01:00", "iso") == 60.0
    assert seconds("02.01.1970", "%d.%m.%Y") == 86400.0
    assert [is_stamp(x) for x in ("2024-05-01", "20240501", "now", "", "1.5")] == [
        True,
        True,
        False,
        False,
        False,
    ]


def test_stamps_and_clocks_become_seconds_and_a_row_cut_off_stays() -> None:
    rows = ['"1970-01-01",5,00:01:00', "1970-01-02, 6 ,", ",7,", "1970-01-0"]
    found = with_seconds(PATH, rows, ",", (0, 2), "iso", 4, "day")
    assert found == ["60.0,5,00:01:00", "86400.0, 6 ,", ",7,", "1970-01-0"]
    assert with_seconds(PATH, rows[:1], ",", (0, None), "iso", 4, "day") == ["0.0,5,00:01:00"]
    wrong = with_seconds, PATH, [rows[0], "x,5,1"], ",", (0, 2), "iso", 4, "day"
    assert refused(*wrong) == "a.json:5: column 'day': 'x 1' is no stamp of format 'iso'"


def long(**signals: list[tuple[float, float]]) -> tuple[list[str], np.ndarray, np.ndarray]:
    rows = [(name, t, x) for name, readings in signals.items() for t, x in readings]
    return [r[0] for r in rows], np.array([r[1] for r in rows]), np.array([r[2] for r in rows])


def even(count: int, step: float = 1.0, at: float = 0.0) -> list[tuple[float, float]]:
    return [(at + step * k, 10.0 * (at + step * k)) for k in range(count)]


def test_signals_are_put_on_the_first_ones_stamps() -> None:
    found, logged = wide(PATH, *long(a=even(10), b=even(5, 2.0, 0.5)[::-1]), ["a", "b"], 1)
    assert (
        found[""].tolist() == [float(k) for k in range(10)]
        and found["a"].tolist() == (10.0 * found[""]).tolist()
    )
    assert np.array_equal(found["b"], [NAN, *(10.0 * np.arange(1, 9)), NAN], equal_nan=True)
    assert logged["b"].tolist() == [85.0, 65.0, 45.0, 25.0, 5.0]  # as they were logged


@pytest.mark.parametrize(("count", "base"), [(9, "a"), (8, "b")])
def test_the_base_is_logged_as_often_as_any_that_competes(count: int, base: str) -> None:
    signals = long(a=even(count, at=0.5), b=even(10), c=even(40, 0.1))
    assert wide(PATH, *signals, ["a", "b", "c"], 2)[0][""][0] == (0.5 if base == "a" else 0.0)


def test_a_gap_of_a_signal_is_a_gap() -> None:
    late = [(t + 6.0 * (t >= 5.0), x) for t, x in even(30)]
    found, _ = wide(PATH, *long(a=even(40), b=late), ["a", "b"], 1)
    gone = np.flatnonzero(np.isnan(found["b"])).tolist()
    assert gone == [5, 6, 7, 8, 9, 10, 36, 37, 38, 39]  # from 4 to 11, whose own readings stay


def test_readings_without_a_number_are_none_and_three_are_needed() -> None:
    names, t, x = long(a=even(10), b=[*even(3), (NAN, 1.0), (7.0, NAN)])
    assert np.isfinite(wide(PATH, names, t, x, ["a", "b"], 1)[0]["b"]).sum() == 3
    few = long(a=even(10), b=even(2))
    assert refused(wide, PATH, *few, ["a", "b"], 1) == "a.json: column 'b': has 2 rows; the table has a, b"
    assert refused(wide, PATH, *few, ["c"], 1) == "a.json: column 'c': has 0 rows; the table has a, b"
