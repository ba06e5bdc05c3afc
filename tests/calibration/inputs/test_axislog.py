"""The axis log's columns in SI, as log-format.md has them, and every row that is refused, with its line."""

from datetime import UTC, datetime
from math import inf, nan, pi
from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import (
    _check_names,
    _check_time,
    _check_values,
    _fractions,
    is_axis_log,
    read_axis_log,
)  # fmt: skip
from calibration.inputs.run import Run
from tests.calibration.logs import tiny_log

ARCSEC = pi / 648_000
PATH = Path("a.log")
HEAD = tiny_log(0)[: tiny_log(0).index("t,setpoint")]  # ten lines
ALL = "t,setpoint,effort,position,velocity,adc_a,adc_b,tach_a,tach_b,aux,focus,supply,temperature,humidity"


def read(text: str) -> Run:
    return read_axis_log(PATH, text)


def rows(*given: str) -> Run:
    return read(HEAD + "\n".join([ALL, *given]) + "\n")


def test_every_column_is_in_si() -> None:
    r = rows("0.00,100,-600,1000,-7,11,12,13,-14,15,16,24.5,8,1", "0.01,0,0,1001,0,0,0,0,0,16,0,0,0,1")
    told = {
        "t": 0.0, "setpoint": 100 * ARCSEC, "effort": -0.2, "position": 1000 * 2 * pi / 2**29,
        "velocity": -7 * 1_296_000 / (4.608e6 * 735 / 30) * ARCSEC / 0.005, "current_a": 11 * 0.0061,
        "current_b": 12 * 0.0061, "motor_a": 13 * 2 * pi / 4096 / 0.010,
        "motor_b": -14 * 2 * pi / 4096 / 0.010,
        "aux": 15 * 2 * pi / (2**17 * 10.8), "focus": 16.0, "supply": 24.5, "temperature": 8.0,
    }  # fmt: skip
    assert {name: x[0] for name, x in r.columns.items()} == pytest.approx(told)
    assert set(r.raw) == set(ALL.split(",")) - {"humidity"} and r.raw["adc_a"].tolist() == [11.0, 0.0]
    assert r.scales["adc_end_A"] == pytest.approx(1022.5 * 0.0061)
    assert r.start_s == datetime(2026, 1, 15, 14, tzinfo=UTC).timestamp()
    assert (r.name, r.session, r.header["axis"]) == ("a", "a", "ra")


def test_counters_are_joined_and_a_board_that_is_not_there_is_no_column() -> None:
    a, b = f"0.00,0,0,{2**29 - 1},0,0,0,0,0,{2**17 - 1},0,0,0,0", "0.01,0,0,2,0,0,0,0,0,1,0,0,0,0"
    r = rows(a, b)
    assert np.diff(r.columns["position"]) == pytest.approx(3 * 2 * pi / 2**29)
    assert np.diff(r.columns["aux"]) == pytest.approx(2 * 2 * pi / (2**17 * 10.8))
    none = rows(a.replace(f"{2**17 - 1}", "0"), b.replace(",1,0,0,0,0", ",0,0,0,0,0"))
    assert "aux" not in none.columns and "aux" not in none.raw
    short = read(HEAD + "t,effort,position\n0,0,0\n0.01,0,1\n")
    assert set(short.columns) == {"t", "effort", "position"} and len(short.columns["t"]) == 2


def test_a_start_that_is_no_time_is_not_known() -> None:
    assert read(tiny_log(3, start_utc="yesterday")).start_s is None


def test_a_text_is_read_from_its_file(tmp_path: Path) -> None:
    (tmp_path / "b.log").write_text(tiny_log(5))
    assert read_axis_log(tmp_path / "b.log").rows == 5


@pytest.mark.parametrize(
    ("text", "is_one"),
    [
        ("# format: axis-log 1\n", True),
        ("x\n# an axis-log\n", True),
        ("format: axis-log 1\n", False),
        ("# format: x\naxis-log\n", False),
        ("#" + "x" * 3991 + "axis-log", True),
        ("#" + "x" * 3992 + "axis-log", False),  # beyond 4000 characters
    ],
)
def test_an_axis_log_is_known_by_a_comment(text: str, is_one: bool) -> None:
    assert is_axis_log(text) is is_one


def refused(call: object, *more: object) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        call(*more)  # type: ignore[operator]
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (HEAD, "a.log:11: the log ends after its header: no column row, no data"),
        (HEAD + "\n\n", "a.log:13: the log ends after its header: no column row, no data"),
        (HEAD + "\n" * 390 + "t,effort,position\n0,0,0\n", "a.log:401: no column row in the first 400 lines"),
        (HEAD + "t,effort,position", "a.log:12: the log has a column row and no data rows"),
        (HEAD + "\nt,effort,position\n\n \n", "a.log:13: the log has a column row and no data rows"),
        (
            HEAD + ",".join(map(str, range(4097))) + "\n0\n",
            "a.log:11: 4097 columns, at most 4096: is it transposed?",
        ),
        (
            HEAD + "t,effort\n0,0\n",
            "a.log:11: the column 'position' is missing; it is logged in 29-bit counts",
        ),
        (HEAD + "t,effort,position\n0,0,0\n,0,0\n,0,0\n", "a.log:13: column 't': is empty"),
        (HEAD + "t,effort,position\n0,0,0\n,0,0\n0.02,0,0\n", "a.log:13: column 't': is empty"),
        (HEAD + "t,effort,position\n0,0,0\n0.01,0,inf\n", "a.log:13: column 'position': is infinite"),
    ],
)
def test_a_log_without_rows_or_numbers_is_refused(text: str, says: str) -> None:
    assert refused(read, text) == says


def test_a_longest_header_is_one_of_399_lines_and_a_last_row_may_be_cut_off() -> None:
    assert read(HEAD + "\n" * 389 + "t,effort,position\n0,0,0\n").rows == 1
    cut = read(HEAD + "t,effort,position\n0,0,0\n0.01,0,1\n,0,9\n")
    assert cut.raw["position"].tolist() == [0.0, 1.0] and cut.rows == 2


def test_a_velocity_that_holds_still_while_the_axis_speeds_up_is_refused() -> None:
    """1 count of it is 0.00023 deg/s; the position speeds up by thousands."""
    body = "\n".join(f"{k * 0.01:.2f},20,{40 * k * k},7" for k in range(200))
    said = refused(read, HEAD + "t,effort,position,velocity\n" + body + "\n")
    assert said == (
        "a.log:12: column 'velocity': holds 7 in every row while the position moves: it measures nothing, "
        "leave it out"
    )


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (["t;effort"], "a.log:11: the columns are parted by semicolons, must be commas"),
        (["t\teffort"], "a.log:11: the columns are parted by tabs, must be commas"),
        (
            ["t", "effort", "position [deg]"],
            "a.log:11: column 'position [deg]': has another unit than the format's: 'position' is logged in "
            "29-bit counts",
        ),
        (
            ["t", "effort(V)", "position"],
            "a.log:11: column 'effort(V)': has another unit than the format's: 'effort' is logged in "
            "1/3000 of supply",
        ),
        (["t", "t", "effort", "position"], "a.log:11: column 't': appears twice: one file holds one axis"),
        (["effort", "position"], "a.log:11: the column 't' is missing; it is logged in s"),
        (["t", "position"], "a.log:11: the column 'effort' is missing; it is logged in 1/3000 of supply"),
    ],
)
def test_names_are_those_of_the_format(names: list[str], says: str) -> None:
    assert refused(_check_names, PATH, names, 11) == says


def test_names_that_the_format_does_not_have_are_left_alone() -> None:
    _check_names(PATH, ["t", "effort", "position", "focus [mm]", "wind [m/s]", "a;b"], 11)


EVEN = np.arange(102.0)


def repeated(count: int) -> np.ndarray:
    """A hundred steps, of which so many are none."""
    return np.cumsum(np.where(np.arange(101) % 100 < 100 - count, 1.0, 0.0))


@pytest.mark.parametrize(
    ("t", "period", "says"),
    [
        ([0.0, 1.0, nan], 1.0, "a.log:14: column 't': is empty"),
        ([0.0, inf, 2.0], 1.0, "a.log:13: column 't': is infinite"),
        ([0.0, 1.0, 0.5], 1.0, ""),  # half a period back
        ([0.0, 1.0, 0.49], 1.0, "a.log:14: column 't': time goes backwards from 1 s to 0.49 s"),
        ([0.0, 4.0, 3.1, 9.0], 2.0, ""),
        (100 * EVEN[:21], 1.0, ""),  # twenty steps
        (
            100 * EVEN[:22],
            1.0,
            "a.log:12: column 't': rows are 100 apart, the header says 1 s: 't' is logged in s",
        ),
        (0.01 * EVEN, 0.01, ""),
        (19.9 * EVEN, 1.0, ""),
        (
            20.0 * EVEN,
            1.0,
            "a.log:12: column 't': rows are 20 apart, the header says 1 s: 't' is logged in s",
        ),
        (0.051 * EVEN, 1.0, ""),
        (
            0.05 * EVEN,
            1.0,
            "a.log:12: column 't': rows are 0.05 apart, the header says 1 s: 't' is logged in s",
        ),
        (repeated(30), 1.0, ""),
        (
            repeated(31),
            1.0,
            "a.log:81: column 't': a third of the rows share their time with the row before: "
            "two axes in one file?",
        ),
    ],
)
def test_the_clock_is_in_s_and_goes_on(t: list[float], period: float, says: str) -> None:
    if says:
        assert refused(_check_time, PATH, np.array(t), period, 12) == says
    else:
        _check_time(PATH, np.array(t), period, 12)


def values(rows: int = 100, **columns: float | list[float]) -> dict[str, np.ndarray]:
    """Whole numbers, all but those given."""
    return {"position": np.full(rows, 7.0), "effort": np.full(rows, 100.0)} | {
        name: np.resize(np.array(x, dtype=float), rows) for name, x in columns.items()
    }


VOLTS = "a.log:12: column 'effort': never exceeds 12.5: it is logged in "
VOLTS += "1/3000 of the supply, not in V or as a fraction"


@pytest.mark.parametrize(
    ("raw", "says"),
    [
        (values(), ""),
        (values(adc_a=[1.0, inf]), "a.log:13: column 'adc_a': is infinite"),
        (values(effort=nan), "a.log:12: column 'effort': holds no number in any row"),
        (values(position=nan), "a.log:12: column 'position': holds no number in any row"),
        (values(position=[0.0, 2.0**40]), ""),
        (values(position=[0.0, -(2.0**40) - 1]), "a.log:13: column 'position': is beyond any 29-bit counter"),
        (values(effort=[0.0, 3150.0]), ""),
        (values(effort=[0.0, -3151.0]), "a.log:13: column 'effort': is beyond full scale (3000)"),
        (values(position=0.5), "a.log:12: column 'position': holds fractions: it is logged in "
                               "29-bit counts, not in an angle"),
        (values(99, position=0.5), ""),
        (values(position=[0.5, 1.0]), ""),  # half of them are whole
        (values(position=1_999_999.5), "a.log:12: column 'position': holds fractions: it is "
                                       "logged in 29-bit counts, not in an angle"),
        (values(position=[0.5, 0.25, 2e6]), ""),
        (values(effort=12.5, position=[-500.0, 501.0]), VOLTS),
        (values(effort=12.5, position=[500.0, 1500.0]), ""),
        (values(effort=[29.9, 30.0, 0.5], position=[-500.0, 501.0]), ""),
        (values(effort=12.0, position=[-500.0, 501.0]), ""),
    ],
)  # fmt: skip
def test_numbers_are_in_the_formats_units(raw: dict[str, np.ndarray], says: str) -> None:
    if says:
        assert refused(_check_values, PATH, raw, 3000.0, 12) == says
    else:
        _check_values(PATH, raw, 3000.0, 12)


def test_fractions_are_more_than_half_of_the_numbers() -> None:
    found = [_fractions(np.array(x)) for x in ([0.5, 1.5, 2.0], [0.5, 2.0], [nan, 0.5], [nan], [3.0])]
    assert found == [True, False, True, False, False]
