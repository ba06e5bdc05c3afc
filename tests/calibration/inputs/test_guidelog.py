"""A guide log's sections, frames, dithers and jumps, summed up by hand, and what is refused of them."""

from datetime import datetime
from pathlib import Path

import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.guidelog import is_guide_log, read_guide_log
from calibration.inputs.run import Run

PATH = Path("night.txt")
BEGIN = "Guiding Begins at 2026-01-01 20:00:00\n"
SCALE = "Pixel scale = 2.00 arc-sec/px, Binning = 1\n"
MOUNT = "Mount = A Mount , connected\n"
NAMES = (
    "Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,RADuration,"
    "RADirection,DECDuration\n"
)
HEAD = BEGIN + SCALE + MOUNT + NAMES
END = "Guiding Ends at 2026-01-01 21:00:00\n"
LOCK = "INFO: SET LOCK POSITION, new lock pos = {}, {}\n"


def frame(
    k: float, ra: str = "0", dec: str = "0", sent: str = "0,0", pulse: str = "1", mark: str = '"Mount"'
) -> str:
    return f"{k:.0f},{k},{mark},0,0,{ra},{dec},{sent},{pulse},W,{pulse}\n"


def read(text: str) -> list[Run]:
    return read_guide_log(PATH, text)


def column(text: str, name: str) -> list[float]:
    found: list[float] = read(text)[0].columns[name].tolist()
    return found


def refused(text: str) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        read(text)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "is_one"),
    [
        ("PHD2 version 2.6", True),
        ("\ufeff\n PHD2 version 2.6", True),
        ("t,PHD2 version", False),
        ("PHD2,t", False),
        ("x" * 19_986 + "Guiding Begins", True),
        ("x" * 19_987 + "Guiding Begins", False),
        (NAMES, True),
        (' "frame", "TIME", Mount,x', True),
        ("t,x\n" + NAMES, False),
        ("", False),
    ],
)
def test_a_guide_log_is_known_by_its_head(text: str, is_one: bool) -> None:
    assert is_guide_log(text) is is_one


def test_the_error_is_the_raw_distance_and_every_correction_before_it() -> None:
    text = (
        HEAD
        + frame(1, "0.5", "0.25", "0.25,-1")
        + frame(2, "1", "0", "2,4", "0")
        + frame(3, "0.125", "1")
        + END
    )
    (run,) = read(text)
    assert run.columns["t"].tolist() == [1.0, 2.0, 3.0]
    assert run.columns["ra"].tolist() == [1.0, 2.5, 0.75]  # the second one sent no pulse
    assert run.columns["dec"].tolist() == [0.5, -2.0, 0.0]
    assert run.columns["segment"].tolist() == run.columns["dither"].tolist() == [0.0] * 3
    assert run.header == {"unit": "arcsec", "mount": "A Mount"} and run.notes == []
    assert run.start_s == (datetime(2026, 1, 1, 20) - datetime(2000, 1, 1)).total_seconds()
    assert (run.name, run.session, run.path) == ("night", "night", PATH)


@pytest.mark.parametrize("pulse", ["0", "0.0", " 0 "])
def test_a_distance_without_a_pulse_moves_nothing(pulse: str) -> None:
    assert column(HEAD + frame(1, "0", "0", "1,1", pulse) + frame(2) + END, "ra") == [0.0, 0.0]


def test_a_table_without_durations_is_trusted_and_one_without_dec_has_none() -> None:
    names = "Frame,Time,mount,RARawDistance,RAGuideDistance\n"
    (run,) = read(names + '1,1,"Mount",0,1.5\n2,2,Mount,0.25,\n3,3,Mount,0.5,0\n')
    assert run.columns["ra"].tolist() == [0.0, 1.75, 2.0] and run.columns["dec"].tolist() == [0.0] * 3
    assert run.header == {"unit": "px"} and run.start_s is None
    assert run.notes == ["no pixel scale in the file: distances are in pixels"]


def test_sections_are_runs_of_their_own_and_empty_ones_none() -> None:
    later = HEAD.replace("20:00:00", "22:00:00").replace("2.00", "4,00")
    calibration = "Calibration Begins at 2026-01-01 19:00:00\n" + NAMES + frame(1) + "Calibration complete\n"
    text = calibration + HEAD + END + HEAD + frame(1, "1") + END + frame(9, "9") + later + frame(1, "1") + END
    runs = read(text)
    assert [(r.name, r.session, r.columns["ra"].tolist()) for r in runs] == [
        ("night", "night", [2.0]),
        ("night#2", "night#2", [4.0]),
    ]


def test_a_section_that_never_ends_goes_to_the_next_one() -> None:
    assert [r.rows for r in read(HEAD + frame(1) + HEAD + frame(1) + frame(2))] == [1, 2]


def test_a_dither_moves_the_star_and_not_the_drive() -> None:
    dither = "INFO: DITHER by 1.500, -0.500, new lock pos = 5.000, 5.000\n"
    text = HEAD + frame(1) + dither + frame(2, "-1.5", "0.5") + dither + frame(3, "-3", "1") + END
    assert column(text, "ra") == column(text, "dec") == [0.0] * 3
    assert column(text, "dither") == [0.0, 3.0, 6.0] and column(text, "segment") == [0.0] * 3


@pytest.mark.parametrize(
    ("lines", "segment"),
    [
        (LOCK.format("7.005", "8.0"), 0.0),  # within a hundredth of a pixel
        (LOCK.format("7.02", "8.0"), 1.0),
        (LOCK.format("7.0", "8.02"), 1.0),
        (LOCK.format("9.0", "8.0") + LOCK.format("9.0", "8.0"), 1.0),  # written again
        (LOCK.format("9.0", "8.0") + LOCK.format("7.0", "8.0"), 2.0),
        ("INFO: DITHER by 1.0, 0.0, new lock pos = 9.0, 8.0\n" + LOCK.format("9.0", "8.0"), 0.0),
        ("INFO: DITHER by 1.0, 0.0\n" + LOCK.format("7.0", "8.0"), 0.0),  # without a place the lock stays
        ("INFO: SET LOCK POSITION somewhere\n", 1.0),
        ("INFO: new lock pos = 9.0, 8.0\n", 0.0),
        ("SET LOCK POSITION, new lock pos = 9.0, 8.0\n", 0.0),  # no event
    ],
)
def test_a_new_lock_position_is_a_jump_where_it_is_another_one(lines: str, segment: float) -> None:
    head = HEAD.replace(MOUNT, MOUNT + "Lock position = 7.000, 8.000, Star position = 7.0, 8.0\n")
    assert column(head + frame(1) + lines + frame(2) + END, "segment") == [0.0, segment]


@pytest.mark.parametrize("end", ["Settling complete", "Settling failed"])
def test_frames_while_it_settles_are_left_out_and_their_corrections_are_not(end: str) -> None:
    started, ended = (f"INFO: SETTLING STATE CHANGE, {what}\n" for what in ("Settling started", end))
    text = HEAD + frame(1) + started + frame(2, "5", "0", "1,0") + ended + frame(3) + END
    assert column(text, "t") == [1.0, 3.0] and column(text, "ra") == [0.0, 2.0]


def test_a_lost_star_is_no_frame_and_a_star_without_a_place_none_either() -> None:
    lost = '2,2,"DROP",,,,,,,,,\n'
    text = HEAD + frame(1) + lost + frame(3, "nan", "0", "0.5,0") + frame(4, "1", sent=",") + frame(5) + END
    assert column(text, "t") == [1.0, 4.0, 5.0] and column(text, "ra") == [0.0, 3.0, 1.0]
