"""Guide logs that cannot be read, each with its place, and those that just can."""

from pathlib import Path

import pytest

from calibration.inputs.guidelog import read_guide_log
from tests.calibration.inputs.test_guidelog import END, HEAD, column, frame, read, refused


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "night.txt:0: holds no guiding section with frames"),
        (HEAD + END, "night.txt:5: holds no guiding section with frames"),
        ("Calibration Begins at x\n", "night.txt:1: holds a calibration only, no guiding section"),
        ("Calibration Begins at x\n" + HEAD, "night.txt:5: holds no guiding section with frames"),
        (
            HEAD + frame(1, mark="AO") + frame(2, mark="DROP"),
            "night.txt:6: holds frames of an adaptive-optics unit (mount 'AO') only: it moves "
            "the star without "
            "the mount, so the drive's error cannot be summed up",
        ),
        (
            HEAD + frame(1, mark='"DROP"'),
            "night.txt:5: every frame is marked DROP: the star was never measured",
        ),
        (
            HEAD + frame(1, mark="Camera"),
            "night.txt:5: column 'mount': 'Camera' is none of Mount, AO, DROP: decimal commas? write points",
        ),
        (HEAD + "1,1,\n", "night.txt:5: 3 fields, the header row has 12"),
        (
            HEAD + frame(1)[:-1] + ",1,2\n",
            "night.txt:5: 14 fields, the header row has 12: decimal commas? write points",
        ),
        (HEAD + "1,1,Mount,0,0,0,0,0\n", "night.txt:5: 8 fields, the header row has 12"),
        (HEAD + frame(1, "far"), "night.txt:5: column 'RARawDistance': 'far' is not a number"),
        (
            HEAD + frame(1, "0", "x" * 50),
            f"night.txt:5: column 'DECRawDistance': '{'x' * 40}' is not a number",
        ),
        (HEAD + frame(1, "1000000001"), "night.txt:5: column 'RARawDistance': '1000000001' is not a number"),
        (
            HEAD + frame(1, "-1000000001"),
            "night.txt:5: column 'RARawDistance': '-1000000001' is not a number",
        ),
        (HEAD + frame(2) + frame(1.5), "night.txt:6: column 'Time': time goes backwards from 2 s to 1.5 s"),
        (HEAD + "1,,Mount,0,0,0,0,0,0,1,W,1\n", "night.txt:5: column 'Time': is no time in s"),
        (
            HEAD.replace("mount,", "telescope,") + frame(1),
            "night.txt:5: holds no guiding section with frames",
        ),
        (HEAD.replace("RAGuideDistance", "RAGuide"), "night.txt:4: the column 'RAGuideDistance' is missing"),
        (
            HEAD.replace("2.00", "0.01") + frame(1),
            "night.txt:5: the section above this line has pixel scale '0.01', must be 0.01 to 100 arc-sec/px",
        ),
        (
            HEAD.replace("2.00", "100") + "x\n" + frame(1) + frame(2),
            "night.txt:6: the section above this line has pixel scale '100', must be 0.01 to 100 arc-sec/px",
        ),
        (
            HEAD.replace("2.00", "1,2,3") + frame(1),
            "night.txt:5: the section above this line has pixel scale '1,2,3', must be 0.01 to "
            "100 arc-sec/px",
        ),
        (
            HEAD.replace("-01-01 20", "-13-01 20") + frame(1),
            "night.txt:5: the section above this line: 'Guiding Begins at 2026-13-01 20:00:00' "
            "is no date and time",
        ),
    ],
)
def test_what_cannot_be_read_says_why_and_where(text: str, says: str) -> None:
    assert refused(text) == says


def test_limits_themselves_are_read() -> None:
    assert column(HEAD + frame(1, "1000000000") + frame(1) + END, "ra") == [2e9, 0.0]  # and one time twice
    assert column(HEAD + frame(1)[:-1] + ",1\n" + END, "ra") == [0.0]  # one field too many
    assert column(HEAD.replace("2.00", "0.011") + frame(1, "1") + END, "ra") == pytest.approx([0.011])


def test_a_log_that_is_being_written_ends_with_its_last_whole_frame() -> None:
    assert read(HEAD + frame(1) + "2,2,Mount,0,0,0.").pop().rows == 1
    assert read(HEAD + frame(1) + frame(2)[:-1]).pop().rows == 2
    assert refused(HEAD + frame(1) + "2,2,Mount,0,0,0.\n").startswith("night.txt:6: 6 fields")


def test_a_file_is_read_by_its_path(tmp_path: Path) -> None:
    (tmp_path / "g.txt").write_text(HEAD + frame(1) + END)
    assert read_guide_log(tmp_path / "g.txt")[0].name == "g"
