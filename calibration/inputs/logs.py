"""Logs of any format, and the declaration of the drive behind them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.drift import sections_of
from calibration.inputs.record import Record
from calibration.inputs.stuck import check_stuck
from calibration.inputs.tables import read_table, set_starts
from calibration.inputs.telescope import telescope
from calibration.inputs.twomotors import runs_of
from calibration.readers.axis import is_axis_log, read_axis_log
from calibration.readers.guide import is_guide_log, read_guide_log
from calibration.readers.run import Run

#: what a log of each format is called
CALLED = {"axis-log": "an axis log", "phd2": "a PHD2 guide log", "table": "a table"}


@dataclass
class Drive:
    """Runs of one drive and its declaration; None only for a mount that is known by its name in a guide log.

    `records` are the tables the runs were made of; `clock` says where their starts are from.
    """

    rig: Rig | None
    runs: list[Run]
    records: list[Record] = field(default_factory=list)
    clock: str = ""

    @property
    def emulated(self) -> bool:
        """Whether the drive is the telescope's, of which the emulator has a plant."""
        return self.rig is not None and self.rig.format == "axis-log"


def read_drive(logs: list[Path], rig: Rig | None) -> Drive:
    """Read logs of one format; `rig` declares the drive, which axis logs and guide logs can do without."""
    runs: list[Run] = []
    formats: dict[str, Path] = {}
    for k, path in enumerate(logs):
        if path.resolve() in [p.resolve() for p in logs[:k]]:
            raise CalibrationInputError(path, "is given twice: a copy cannot be held out against itself")
        found, more = _read(path, rig)
        formats[found] = path
        runs += more
    if len(formats) > 1:
        (a, _), (b, second) = list(formats.items())[:2]
        raise CalibrationInputError(
            second, f"is {CALLED[b]}, the one before is {CALLED[a]}: calibrate one kind at a time"
        )
    found = next(iter(formats))
    if rig is not None and rig.format != found:
        raise CalibrationInputError(
            rig.path,
            f"format: {rig.format}, but {formats[found]} is {CALLED[found]}: declare format: {found}",
        )
    if found == "axis-log":
        return Drive(rig or telescope(_one_axis(runs)), runs)
    if found == "phd2":
        return Drive(rig, runs)
    assert rig is not None
    records = [r for r in runs if isinstance(r, Record)]
    check_stuck(records, rig)
    clock = set_starts(records, rig)
    if rig.motors is not None:
        return Drive(rig, runs_of(records, rig), records, clock)
    if rig.drifts:
        return Drive(rig, sections_of(records, rig), records, clock)
    return Drive(rig, runs, records, clock)


def _one_axis(runs: list[Run]) -> str:
    axes = {r.header["axis"]: r.path for r in runs}
    if len(axes) > 1:
        (a, first), (b, second) = list(axes.items())[:2]
        raise CalibrationInputError(
            second, f"is an axis log of {b}, {first} one of {a}: calibrate one axis at a time"
        )
    return next(iter(axes))


def _read(path: Path, rig: Rig | None) -> tuple[str, list[Run]]:
    """Format of one file, by what it looks like, and its runs."""
    if path.exists() and not path.is_file():  # a pipe may never begin, a device never end
        raise CalibrationInputError(
            path, "cannot be read (Is a directory)" if path.is_dir() else "cannot be read (no regular file)"
        )
    if path.suffix.lower() != ".mat":
        text, bad = _text(path)
        if bad is None and is_axis_log(text):
            return "axis-log", [read_axis_log(path, text)]
        if is_guide_log(text):
            return "phd2", read_guide_log(path, text)
        if bad is not None:
            raise CalibrationInputError(path, "is not UTF-8 text", bad)
        if not text.strip():
            raise CalibrationInputError(path, "is empty", 1)
    if rig is None or rig.format != "table":
        raise CalibrationInputError(
            path,
            "is neither an axis log ('# format: axis-log 1') nor a PHD2 guide log; "
            "another drive's file needs --rig FILE" + (", of format: table" if rig is not None else ""),
            1,
        )
    return "table", list(read_table(path, rig))


def _text(path: Path) -> tuple[str, int | None]:
    """The file's text, and the first line that is not UTF-8: names in a guide log may be in the computer's
    code page, its numbers are ASCII."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    try:
        text, bad = raw.decode("utf-8-sig"), None
    except UnicodeDecodeError as error:
        text, bad = raw.decode("latin-1"), error.object[: error.start].count(b"\n") + 1
    return text.replace("\r\n", "\n").replace("\r", "\n"), bad
