"""Broken files of every kind that a user writes: one line each, none hangs; pipes are refused."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from boards.c.library import load
from calibration.inputs.draft import draft
from calibration.inputs.logs import read_drive
from scenarios.campaign.table import Journal
from scenarios.doors.recording import ENTERED, SESSION
from scenarios.doors.replay import _entries, replay
from scenarios.run.mcapfile import export, summary_of
from tests.fuzz.documents import KINDS, try_all

COUNT = 300


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("kind", KINDS)
def test_no_value_hangs_or_ends_in_an_internal_error(kind: str, tmp_path: Path) -> None:
    told, wrong = try_all(kind, COUNT, 25, tmp_path)
    assert not wrong, "\n".join(wrong)
    assert told["refused"] > COUNT // 3 and told["accepted"]


@pytest.mark.parametrize("kind", ["rig", "campaign", "log"])
def test_some_of_them_in_every_run(kind: str, tmp_path: Path) -> None:
    assert not try_all(kind, 25, 2, tmp_path)[1]


READ: dict[str, tuple[str, Callable[[Path], object]]] = {
    "firmware": ("own.c", load),
    "draft": ("log.csv", draft),
    "recording to draft": ("log.mat", draft),
    "session": (SESSION, lambda file: replay(file.parent, file.parent / "again")),
    "entries": (ENTERED, lambda file: list(_entries(file))),
    "summary": ("summary.json", lambda file: summary_of(file.parent)),
    "journal": ("runs.jsonl", lambda file: Journal(file.parent, True)),
}


@pytest.mark.parametrize("what", ["pipe", "device"])
@pytest.mark.parametrize("reader", READ)
def test_a_pipe_never_begins_and_a_device_never_ends(reader: str, what: str, tmp_path: Path) -> None:
    name, read = READ[reader]
    file = tmp_path / name
    if what == "pipe":
        os.mkfifo(file)
    else:
        file.symlink_to("/dev/zero")
    with pytest.raises(ValueError, match=r"no regular file") as caught:
        read(file)
    assert "\n" not in str(caught.value) and str(tmp_path) in str(caught.value)


def test_a_loop_of_links_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "a.csv").symlink_to(tmp_path / "b.csv")
    (tmp_path / "b.csv").symlink_to(tmp_path / "a.csv")
    with pytest.raises(ValueError, match=r"a\.csv: cannot be read"):
        read_drive([tmp_path / "a.csv", tmp_path / "b.csv"], None)


def test_a_full_disk_is_named(tmp_path: Path) -> None:
    summary = {"start_utc": "2026-02-10T14:00:00+00:00", "scenario": "s", "seed": 1, "plant": "p"}
    (tmp_path / "summary.json").write_text(json.dumps(summary | {"trace_digest": "d", "faults": []}))
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    with pytest.raises(OSError, match="No space left") as caught:
        export(tmp_path, Path("/dev/full"))
    assert caught.value.filename == "/dev/full"
