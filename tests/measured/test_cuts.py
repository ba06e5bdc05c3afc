"""Measured logs, cut or thinned: what is named is still in them. Skipped where the data folder is absent."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from calibration.command import calibrate
from tests.measured.cases import CASES, DATA
from tests.measured.truth import WRONG, judge, say

Cut = Callable[[list[int]], list[int]]
CUTS: dict[str, Cut] = {
    "first half": lambda rows: rows[: len(rows) // 2],
    "last four fifths": lambda rows: rows[len(rows) // 5 :],
    "every second row": lambda rows: rows[::2],
}
LOGS = ("xl330", "ur10e_j2", "servo_output", "servo_cogging")
GUIDE = ("phd2_01", "phd2_02", "phd2_03", "phd2_04", "phd2_06", "phd2_07")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/measured is absent: no measured data"),
]


def written(log: Path, cut: Cut, folder: Path) -> Path:
    """The log with its head and some of its rows."""
    lines = log.read_text(errors="ignore").splitlines(keepends=True)
    rows = [k for k, line in enumerate(lines) if line.strip()[:1].isdigit() or line.strip()[:1] in ("-", ".")]
    kept = set(cut(rows)) | (set(range(len(lines))) - set(rows))
    file = folder / log.name
    file.write_text("".join(line for k, line in enumerate(lines) if k in kept))
    return file


# a guide log's rows are frames, and a guide pulse in a frame that is left out is lost
WANTED = [
    *((k, c) for k in LOGS for c in CUTS),
    *((k, c) for k in GUIDE for c in ("first half", "last four fifths")),
]


@pytest.mark.parametrize(("key", "cut"), WANTED)
def test_a_cut_log_gets_no_wrong_name(tmp_path: Path, key: str, cut: str) -> None:
    case = next(c for c in CASES if c.key == key)
    logs = [written(log, CUTS[cut], tmp_path) for log in case.logs]
    assert calibrate(logs, case.rig, [], tmp_path / "out", plots=False, replay=False) == 0
    data = json.loads((tmp_path / "out" / "report.json").read_text())
    needs = [replace(sign, size=None) for sign in case.needs]  # of fewer moves a size is another one
    judged, why = judge(data, needs, case.may)
    assert judged != WRONG, f"{'; '.join(map(say, data['effects']))}: {why}"
