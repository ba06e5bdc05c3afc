"""Logs of any format, and the declaration of the drive behind them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from os.path import realpath
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import is_axis_log, read_axis_log
from calibration.inputs.declaration import Rig
from calibration.inputs.guidelog import is_guide_log, read_guide_log
from calibration.inputs.rigfile import telescope
from calibration.inputs.run import Run
from calibration.inputs.stuck import check_stuck
from calibration.inputs.tables import READERS, read_table, repair_tables, set_starts
from calibration.inputs.text import check_file, load_text
from calibration.inputs.twomotors import runs_of

#: what a log of each format is called
CALLED = {"axis-log": "an axis log", "phd2": "a PHD2 guide log", "table": "a table"}


@dataclass
class Drive:
    """Runs of one drive and its declaration; None only for a mount that is known by its name in a guide log.

    `records` are the tables the runs were made of; `clock` says where their starts are from.
    """

    rig: Rig | None
    runs: list[Run]
    records: list[Run] = field(default_factory=list)
    clock: str = ""


def read_drive(logs: list[Path], rig: Rig | None) -> Drive:
    """Read logs of one format; `rig` declares the drive, which axis logs and guide logs can do without."""
    runs: list[Run] = []
    formats: dict[str, Path] = {}
    for k, path in enumerate(logs):
        if realpath(path) in map(realpath, logs[:k]):  # Path.resolve raises at a loop of links
            raise CalibrationInputError(path, "is given twice: a copy cannot be held out against itself")
        found, more = _read(path, rig)
        formats[found] = path
        runs += more
    found = _only(formats, lambda kind: CALLED[kind], "kind")
    if rig is not None and rig.format != found:
        what = f"format: {rig.format}, but {formats[found]} is {CALLED[found]}: declare format: {found}"
        raise CalibrationInputError(rig.path, what)
    if found == "axis-log":
        axis = _only({r.header["axis"]: r.path for r in runs}, lambda name: f"an axis log of {name}", "axis")
        return Drive(rig or telescope(axis), runs)
    if found == "phd2":
        return Drive(rig, runs)
    assert rig is not None
    repair_tables(runs, rig)
    check_stuck(runs, rig)
    clock = set_starts(runs, rig)
    if rig.motors is not None:
        return Drive(rig, runs_of(runs, rig), runs, clock)
    return Drive(rig, sections_of(runs, rig) if rig.drifts else runs, runs, clock)


def sections_of(records: list[Run], rig: Rig) -> list[Run]:
    """Tables of a position at constant rate, as the sections that a guide log has. `ra` is the response, in
    its unit. They have no dithers, and no jumps but repaired ones."""
    response = next(r for r in rig.responses if r.channel == "position")
    out = []
    for r in records:
        y = r.columns["position"] * response.gain
        good = np.isfinite(y)
        columns = {"t": r.columns["t"][good], "ra": y[good], "segment": np.zeros(int(good.sum()))}
        header = {"unit": response.unit, "mount": rig.name}
        notes = [f"{r.name}, {x.channel}: {x.note}" for x in r.repairs]
        start_s = r.start_s if rig.wall_time else None  # else only the files' order is known
        out.append(Run(r.name, r.path, r.name, columns, header=header, notes=notes, start_s=start_s))
    return out


def _only(found: dict[str, Path], called: Callable[[str], str], what: str) -> str:
    """The one key of `found`; raises CalibrationInputError where files differ in it."""
    (first, path), *others = found.items()
    for other, where in others:
        what = f"is {called(other)}, {path} is {called(first)}: calibrate one {what} at a time"
        raise CalibrationInputError(where, what)
    return first


def _read(path: Path, rig: Rig | None) -> tuple[str, list[Run]]:
    """Format of one file, by what it looks like, and its runs."""
    check_file(path)
    text = None
    if path.suffix.lower() not in READERS:
        text, bad = load_text(path)
        if bad is None and is_axis_log(text):
            return "axis-log", [read_axis_log(path, text)]
        if is_guide_log(text):
            return "phd2", read_guide_log(path, text)
        if bad is not None:
            raise CalibrationInputError(path, "is not UTF-8 text", bad)
        if not text.strip():
            raise CalibrationInputError(path, "is empty", 1)
    if rig is None or rig.format != "table":
        neither = "is neither an axis log ('# format: axis-log 1') nor a PHD2 guide log"
        form = "" if rig is None else ", of format: table"
        drafts = f"schmidt rig --new {path.name} drafts one{form}"
        what = f"{neither}. Another drive's file needs --rig FILE; {drafts}"
        raise CalibrationInputError(path, what, 1)
    return "table", read_table(path, rig, text)
