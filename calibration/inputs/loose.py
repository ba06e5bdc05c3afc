"""Every column of a file that no rig file describes. For each it says what it holds and what its name says of
channel and unit. It also says what a rig file must say of the file."""

import re
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from calibration.arrays import Array
from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import is_axis_log
from calibration.inputs.guidelog import is_guide_log
from calibration.inputs.matlab import columns_of, read_matlab
from calibration.inputs.recordings import RECORDINGS
from calibration.inputs.shapes import ISO, is_stamp
from calibration.inputs.text import Heading, Long, check_file, heading, load_utf8, plain, read_long, split

_UNIT = re.compile(r"\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_PART = re.compile(r"[^\W\d_]+")
_RATE = re.compile(r"_([a-z]+)_(?:per_)?(s2?)$")
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])")

SHORT = 2  # characters of a name that is a unit by itself: longer than m, s, in. ASSUMPTION
LOOKED_AT = 200  # rows that are enough to say what a column holds. ASSUMPTION
SIGNALS = 64  # words that name the signals of a long table. ASSUMPTION
# of the rows, from which on a word that is another one than in the row before is a signal's name. ASSUMPTION
TURNS = 0.3


@dataclass
class Loose:
    """A table whose file needs a rig file.

    columns: (n,) each, by what a rig file calls them. stamp: the one of them that holds stamps in words.
    fields: the rig file's fields that the file needs. words: columns that hold words.
    """

    columns: dict[str | int, Array]
    stamp: str | int | None = None
    fields: dict[str, Any] = field(default_factory=dict)
    words: list[str] = field(default_factory=list)


def read_loose(path: Path) -> Loose:
    """Raises CalibrationInputError for a file that is no table, or that needs no rig file."""
    check_file(path)
    if path.suffix.lower() in (".mat", ".npz"):
        names = columns_of(path)
        return Loose(dict(read_matlab(path, names)[0].items()) if names else {})
    if path.suffix.lower() in RECORDINGS:
        raise CalibrationInputError(path, "is a recording: give its channels in a rig file, none is drafted")
    text = load_utf8(path)
    if is_axis_log(text) or is_guide_log(text):
        what = f"says itself what it holds: schmidt calibrate {path.name} --out DIR"
        raise CalibrationInputError(path, what)
    h = heading(path, text)
    if h.first != h.at and any(plain(f) is None and not _is_stamp(f) for f in h.fields):
        return _of_text(h, {})
    names = [f"column{k + 1}" for k in range(len(h.fields))]
    return _of_text(heading(path, text, tuple(names)), {"names": names})


def _of_text(h: Heading, fields: dict[str, Any]) -> Loose:
    some = [split(row, h.mark) for row in h.lines[h.first : h.first + LOOKED_AT] if row.strip()]
    found = Loose({}, fields=fields)
    signals, refused = "", None
    for k, name in enumerate(h.fields):
        held = [row[k] for row in some if len(row) > k and row[k]]
        clear = name.isprintable() and plain(name) is None  # a name that is a number would be read as one
        column = name if clear and h.fields.count(name) == 1 else k
        form = {str(column): (ISO, "")} if held and all(_is_stamp(x) for x in held) else {}
        try:
            got = h.read([column], form)
        except CalibrationInputError as error:
            refused = refused or error
            found.words.append(name)
            changes = np.mean([a != b for a, b in pairwise(held)]) if held[1:] else 0.0
            signals = name if 2 <= len(set(held)) <= SIGNALS and changes > TURNS else signals
            continue
        found.columns[column] = got[str(column)]
        found.stamp = column if form else found.stamp
    if refused is not None and found.columns.keys() <= {found.stamp}:
        raise refused
    named = all(isinstance(c, str) for c in found.columns)
    if signals and not fields and named and len(found.columns) == 2:
        return _of_long(h, found, signals, sorted({row[h.fields.index(signals)] for row in some}))
    return found


def _of_long(h: Heading, found: Loose, name: str, signals: list[str]) -> Loose:
    """Of a table with a row per reading, on the stamps of a signal that has most."""
    first, second = found.columns
    time, value = (second, first) if found.stamp == second else (first, second)
    long = {"name": name, "value": str(value)}
    stamps = {str(time): (ISO, "")} if found.stamp == time else {}
    timed = Long(name, str(time), str(value), compete=len(signals))
    columns, _ = read_long(h, [*signals, time], timed, stamps)
    return Loose(dict(columns.items()), found.stamp, {"long": long})


def _is_stamp(word: str) -> bool:
    return plain(word) is None and is_stamp(word)


class Said(NamedTuple):
    """Channel ("" where the name says none), its unit and the factor to it; `asked`: not measured;
    `angle`: of something that turns."""

    channel: str = ""
    unit: str = ""
    scale: float = 1.0
    asked: bool = False
    angle: bool = False


@cache
def _table() -> dict[str, dict[str, Any]]:
    return dict(yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8")))


def said(name: str | int) -> Said:
    """What a header says: "Position [mm]", "torque_Nm", "goalPos (deg)"; a place says nothing."""
    if isinstance(name, int):
        return Said()
    words, units = _table()["words"], _table()["units"]
    bracket = _UNIT.search(name)
    inside = "" if not bracket or bracket[1][:1].isdigit() or bracket[1].startswith(":") else bracket[1]
    parts = [p.lower() for p in _PART.findall(_HUMP.sub("_", _UNIT.sub("", name)))]
    ends = [p.lower() for p in _PART.findall(name)]
    last = ends[-1] if ends and (len(ends) > 1 or len(ends[0]) > SHORT) else ""
    last = "" if last in words["asked"] else last
    if (rate := _RATE.search(name.lower())) and (per := "/".join(rate.groups())) in units:
        last = per  # speed_deg_s
    hint, unit, scale = units.get(inside.lower() or last, ("", inside, 1.0))
    told = [channel for channel, known in words.items() if set(parts) & set(known)]
    told = [channel for channel in told if channel not in ("count", "label") or len(parts) == 1]
    channel = next((c for c in told if c not in ("asked", "angle")), "")
    alike = {hint, channel} <= {"current", "force", "effort", "normal"}
    channel = channel if not hint or alike else hint
    return Said(channel, unit, float(scale), "asked" in told, "angle" in told)
