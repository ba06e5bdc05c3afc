"""Readers: what is wrong is named with file, line and column; what can be repaired is repaired."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.counters import unwrap
from calibration.inputs.guidelog import read_guide_log
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.inputs.tables import read_table
from calibration.names.log_wrap import repair_wraps
from tests.calibration.logs import tiny_log


def write(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_an_axis_log_is_read_in_si_units_and_header_scales_override(tmp_path: Path) -> None:
    run = read_axis_log(write(tmp_path / "a.log", tiny_log()))
    assert run.rows == 40
    assert run.columns["effort"][0] == pytest.approx(20 / 3000)
    assert run.columns["position"][1] - run.columns["position"][0] == pytest.approx(60 * 2 * np.pi / 2**29)
    text = tiny_log().replace("# supply_V: 24\n", "# supply_V: 24\n# adc_A_per_count: 0.0122\n")
    assert read_axis_log(write(tmp_path / "b.log", text)).columns["current_a"][4] == pytest.approx(4 * 0.0122)


@pytest.mark.parametrize(
    ("change", "line", "column"),
    [
        (lambda t: t.replace("0.05,15,20", "0.05,15,twenty"), 17, "effort"),
        (lambda t: t.replace("\n0.00,", "\n\ufeff0.00,"), 12, "t"),  # a byte order mark in the middle
        (lambda t: t.replace("\n0.20,", "\n0.02,"), 32, "t"),
        (lambda t: t.replace("\n0.07,15", "\n,15"), 19, "t"),
        (lambda t: t.replace(",position,", ",position [deg],"), 11, "position [deg]"),
        (lambda t: t.replace(",position,", ",place,"), 11, None),
        (lambda t: t.replace(",adc_b,", ",adc_a,"), 11, "adc_a"),
        (lambda t: t.replace("# loop: closed", "# loop: shut"), 5, None),
        (lambda t: t.replace("# supply_V: 24", "# supply_V: 24 V"), 9, None),
        (lambda t: t.replace("# session: a\n", ""), 1, None),
        (lambda t: t.replace("# session: a\n", "# axis: dec\n"), 4, None),
        (lambda t: t.replace("0.10,15,20,", "0.10,15,"), 22, None),
    ],
)
def test_bad_input_names_file_line_and_column(
    tmp_path: Path, change: object, line: int, column: str | None
) -> None:
    path = write(tmp_path / "bad.log", change(tiny_log()))  # type: ignore[operator]
    with pytest.raises(CalibrationInputError) as caught:
        read_axis_log(path)
    assert str(caught.value).startswith(f"{path}:{line}")
    assert caught.value.column == column


def test_an_unknown_column_is_kept_out_of_the_way(tmp_path: Path) -> None:
    text = (
        "\n".join(
            line
            + ("" if line.startswith("#") or not line else ",humidity" if line.startswith("t,") else ",wet")
            for line in tiny_log().splitlines()
        )
        + "\n"
    )
    assert read_axis_log(write(tmp_path / "a.log", text)).rows == 40


def test_a_run_that_was_cut_off_is_read_up_to_its_last_whole_row(tmp_path: Path) -> None:
    assert read_axis_log(write(tmp_path / "a.log", tiny_log()[:-9])).rows == 39


def test_two_axes_and_two_kinds_in_one_call_are_refused(tmp_path: Path) -> None:
    ra, dec = write(tmp_path / "ra.log", tiny_log()), write(tmp_path / "dec.log", tiny_log(axis="dec"))
    with pytest.raises(CalibrationInputError, match="one axis at a time"):
        read_drive([ra, dec], None)
    guide = write(tmp_path / "guide.txt", GUIDE)
    with pytest.raises(CalibrationInputError, match="one kind at a time"):
        read_drive([ra, guide], None)
    with pytest.raises(CalibrationInputError, match="needs --rig"):
        read_drive([write(tmp_path / "x.csv", "a,b\n1,2\n")], None)


@pytest.mark.parametrize("rows", [0, 3, 200])
def test_a_log_too_short_gets_an_answer_with_its_reason(tmp_path: Path, rows: int) -> None:
    path = write(tmp_path / "short.log", tiny_log(rows))
    if rows == 0:
        with pytest.raises(CalibrationInputError, match="no data rows"):
            calibrate([path], None, [], tmp_path / "out")
        return
    assert calibrate([path], None, [], tmp_path / "out", plots=False) == 0
    assert '"cannot tell"' in (tmp_path / "out" / "report.json").read_text()
    assert "too few" in (tmp_path / "out" / "report.html").read_text()


def test_a_log_with_nine_tenths_of_its_packets_lost_gets_an_answer(tmp_path: Path) -> None:
    head, _, body = tiny_log(8000).partition("t,setpoint")
    names, *rows = ("t,setpoint" + body).splitlines()
    kept = [row for k, row in enumerate(rows) if (k // 25) % 10 == 0]
    path = write(tmp_path / "lost.log", head + "\n".join([names, *kept]) + "\n")
    assert calibrate([path], None, [], tmp_path / "out", plots=False) == 0
    assert "missing" in (tmp_path / "out" / "report.json").read_text()


def test_an_unknown_run_to_hold_out_names_the_nearest(tmp_path: Path) -> None:
    path = write(tmp_path / "run1.log", tiny_log())
    with pytest.raises(CalibrationInputError, match="did you mean 'run1'"):
        calibrate([path], None, ["rum1"], tmp_path / "out")


@given(st.lists(st.integers(-1000, 1000), min_size=2, max_size=60), st.integers(0, 2**29 - 1))
def test_unwrapping_gives_back_a_motion_whatever_its_start(steps: list[int], start: int) -> None:
    true = start + np.cumsum(steps)
    assert np.diff(unwrap(true % 2**29 * 1.0, 2**29)) == pytest.approx(np.diff(true))


def test_a_position_that_wraps_early_is_found_and_repaired(tmp_path: Path) -> None:
    text = tiny_log(400)
    rows = [line.split(",") for line in text.splitlines() if line[:1].isdigit()]
    for k, r in enumerate(rows):
        r[3], r[4] = str((2**24 - 40000 + 500 * k) % 2**24), "52"
    head = text[: text.index("\n", text.index("t,setpoint")) + 1]
    run = read_axis_log(write(tmp_path / "w.log", head + "\n".join(",".join(r) for r in rows) + "\n"))
    found = repair_wraps(run)
    assert found is not None and found.name == "log_wrap" and "2^24" in found.note
    assert np.diff(run.columns["position"]) == pytest.approx(500 * 2 * np.pi / 2**29)


GUIDE = """PHD2 version 2.6.3, Log version 2.5. Log enabled at 2017-02-18 20:00:00

Calibration Begins at 2017-02-18 20:01:00
Mount = X, connected
Direction,Step,dx,dy,x,y,Dist
West,0,0.0,0.0,1,1,0.0
Calibration complete, mount = X

Guiding Begins at 2017-02-18 20:31:15
Pixel scale = 2.00 arc-sec/px, Binning = 1, Focal length = 400 mm
Mount = AstroPhysicsV2,  connected, guiding enabled
Dec = 5.2 deg, Hour angle = -1.39 hr, Pier side = West, Rotator pos = N/A
Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,RADuration,RADirection,ErrorCode
1,1.0,"Mount",0,0,0.100,0,0.050,0,10,W,0
2,2.0,"Mount",0,0,0.200,0,0.000,0,0,,0
3,3.0,"DROP",,,,,,,,,3,"Star lost"
4,4.0,"Mount",0,0,0.300,0,0.100,0,10,W,0
INFO: DITHER by 1.000, 0.000, new lock pos = 5.000, 5.000
INFO: SETTLING STATE CHANGE, Settling started
5,5.0,"Mount",0,0,1.300,0,0.500,0,10,W,0
INFO: SETTLING STATE CHANGE, Settling complete
6,6.0,"Mount",0,0,0.400,0,0.000,0,0,,0
Guiding Ends at 2017-02-18 21:07:41

Guiding Begins at 2017-02-18 22:00:00
Pixel scale = 2.00 arc-sec/px, Binning = 1, Focal length = 400 mm
Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,RADuration,RADirection,ErrorCode
1,1.0,"Mount",0,0,0.500,0,0.000,0,0,,0
Guiding Ends at 2017-02-18 22:07:41
"""


@pytest.mark.parametrize("number", ["1e308", "-3e300", "9" * 308, "1e10"])
def test_a_distance_beyond_any_camera_is_none(tmp_path: Path, number: str) -> None:
    """Found by a million inputs: finite numbers whose sum, or whose arc seconds, were infinite."""
    lines = GUIDE.splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("1,"))
    for field in (5, 6, 7, 8):
        fields = lines[at].split(",")
        fields[field] = number
        text = "\n".join([*lines[:at], ",".join(fields), *lines[at + 1 :]]) + "\n"
        with pytest.raises(CalibrationInputError, match="is not a number") as caught:
            read_guide_log(write(tmp_path / "g.txt", text))
        assert str(caught.value).startswith(f"{tmp_path / 'g.txt'}:{at + 1}")


def test_a_guide_log_with_sections_drops_dither_and_settling(tmp_path: Path) -> None:
    first, second = read_guide_log(write(tmp_path / "g.txt", GUIDE))
    # raw distance plus the sum of the earlier corrections and dithers, times the pixel scale, by hand
    assert first.columns["ra"] == pytest.approx([0.2, 0.5, 0.7, 4.1])
    assert first.columns["dither"] == pytest.approx([0.0, 0.0, 0.0, 2.0])
    assert first.columns["segment"].tolist() == [0, 0, 0, 0]
    assert first.header["mount"] == "AstroPhysicsV2"
    assert second.columns["ra"] == pytest.approx([1.0])
    bad = GUIDE.replace('4,4.0,"Mount",0,0,0.300', '4,4.0,"Mount",0,0,far')
    with pytest.raises(CalibrationInputError, match=":17: column 'RARawDistance'"):
        read_guide_log(write(tmp_path / "b.txt", bad))


@pytest.mark.parametrize(
    ("event", "segments"),
    [
        ("INFO: SET LOCK POSITION, new lock pos = 5.000, 5.000", [0, 0, 0, 1]),  # unknown before: a jump
        ("INFO: DITHER somewhere", [0, 0, 0, 1]),  # a dither that does not tell how far
        (f"INFO: DITHER by 1.000, 0{'9' * 400}.000", [0, 0, 0, 1]),  # nor does this; it made dec infinite
        ("INFO: Server received PAUSE", [0, 0, 0, 0]),
    ],
)
def test_a_star_that_is_moved_by_an_unknown_amount_starts_a_new_segment(
    tmp_path: Path, event: str, segments: list[int]
) -> None:
    text = GUIDE.replace("INFO: DITHER by 1.000, 0.000, new lock pos = 5.000, 5.000", event)
    assert read_guide_log(write(tmp_path / "g.txt", text))[0].columns["segment"].tolist() == segments


def test_a_lock_position_that_is_written_again_moves_nothing(tmp_path: Path) -> None:
    text = GUIDE.replace("Pier side = West", "Pier side = West\nLock position = 7.0, 8.0").replace(
        "INFO: DITHER by", "INFO: SET LOCK POSITION, new lock pos = 7.000, 8.000\nINFO: DITHER by"
    )
    first = read_guide_log(write(tmp_path / "g.txt", text))[0]
    assert first.columns["segment"].tolist() == [0, 0, 0, 0]
    assert first.columns["ra"][-1] == pytest.approx(4.1)


RIG = """rig: bench
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: turn, wrap: 10}
  effort: {column: u, unit: V}
response: {channel: effort, unit: N, gain: 2.0}
stages:
  - {name: motor, period: 1.0}
  - {name: wheel, of: motor, teeth: [10, 30]}
"""


def test_a_rig_file_maps_columns_and_resolves_teeth(tmp_path: Path) -> None:
    rig = load_rig(write(tmp_path / "rig.yaml", RIG))
    assert rig.stages[1].period == pytest.approx(3.0)
    table = write(tmp_path / "d.csv", "t,x,u\n0,9,1\n1,9.9,1\n2,0.5,1\n")
    assert read_table(table, rig)[0].columns["position"].tolist() == pytest.approx([9, 9.9, 10.5])
    with pytest.raises(CalibrationInputError, match=r"d2.csv:3: column 'u': 'one'"):
        read_table(write(tmp_path / "d2.csv", "t,x,u\n0,9,1\n1,9.9,one\n"), rig)
    with pytest.raises(CalibrationInputError, match="no such column"):
        read_table(write(tmp_path / "d3.csv", "t,x\n0,9\n"), rig)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("response:", "respons:", "unknown field 'respons'; did you mean 'response'"),
        ("channel: effort", "channel: efort", "did you mean 'effort'"),
        ("of: motor", "of: engine", "must name a stage given before it"),
        ("rig: bench", "rig: [", "is not YAML"),
    ],
)
def test_a_wrong_rig_file_names_the_field_and_the_nearest_word(
    tmp_path: Path, old: str, new: str, says: str
) -> None:
    with pytest.raises(CalibrationInputError, match=says.replace("(", r"\(")):
        load_rig(write(tmp_path / "rig.yaml", RIG.replace(old, new)))
