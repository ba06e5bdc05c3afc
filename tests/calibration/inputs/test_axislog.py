"""The axis log's columns in SI, as log-format.md has them, and every row that is refused, with its line."""

from datetime import UTC, datetime
from math import pi
from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import (
    _check_names,
    is_axis_log,
    read_axis_log,
)
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
