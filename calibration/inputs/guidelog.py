"""PHD2 guide logs as PHD2 writes them: several sections per file, calibrations, drops, dithers, settling.

The open-loop drive error of a section is the raw distance plus the running sum of the earlier corrections,
times the pixel scale. PHD2's own log analysis uses the same sum. A dither moves the star, not the drive, by
the amount in its line, along the mount's axes: it is added. A new lock position without a dither starts a new
segment with an offset of its own. Frames while settling are left out. PHD2 writes the distance it wanted to
correct even when no pulse was sent (guiding disabled). Such a row's RADuration is 0 and nothing is added.
"""

import re
from dataclasses import dataclass, field
from datetime import datetime
from math import inf, isfinite
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.inputs.run import Run
from calibration.inputs.text import COMMAS, load_text, plain, split
from calibration.inputs.thresholds import LARGEST_FIELD, PIXEL_SCALES, SAME_PX

_PX = r"([+-]?(?:[0-9]{1,9}(?:\.[0-9]*)?|\.[0-9]+))(?![0-9.])"
_DITHER = re.compile(rf"DITHER by {_PX}, {_PX}")
_LOCK = re.compile(rf"[Ll]ock pos(?:ition)?\s*=\s*{_PX}, {_PX}")
_SCALE = re.compile(r"[Pp]ixel scale\s*=\s*([0-9.,+-]+)\s*arc-sec/px")
_HEAD = re.compile(r"\W*PHD2 version")
_TABLE = re.compile(r"\s*\"?Frame\"?,\s*\"?Time\"?,\s*\"?mount\"?,", re.IGNORECASE)
_MOUNT = re.compile(r"^Mount\s*=\s*([^,\r\n]+)", re.MULTILINE)
_START = re.compile(r"Guiding Begins at (\d{4}-\d\d-\d\d \d\d:\d\d:\d\d)")
COLUMNS = ("Frame", "Time", "mount", "RARawDistance", "RAGuideDistance")
MARKS = ("Mount", "AO", "DROP")


def is_guide_log(text: str) -> bool:
    """True when the text looks like a PHD2 guide log, or like one of its guiding tables."""
    head = text[:20000]
    return "Guiding Begins" in head or bool(_HEAD.match(head) or _TABLE.match(head))


def read_guide_log(path: Path, text: str | None = None) -> list[Run]:
    """Every guiding section of the file as one Run with columns t (s), ra, dec (arcsec), segment, dither.

    Sections without frames are skipped. Without a pixel scale (a bare table) the unit is pixels;
    `header['unit']` says so. Raises CalibrationInputError with line and column.
    """
    text = load_text(path)[0] if text is None else text
    lines = text.splitlines()
    sections = [_Section(path, bool(_TABLE.match(text)))]
    for number, line in enumerate(lines, 1):
        now = sections[-1]
        if line.startswith(("Guiding Begins", "Calibration Begins")):
            sections.append(_Section(path, line.startswith("Guiding"), [line]))
        elif line.startswith(("Guiding Ends", "Calibration complete")):
            sections.append(_Section(path, False))
        elif _TABLE.match(line):
            now.begin(number, split(line, ","))
        elif line.startswith("INFO"):
            now.event(line)
        elif now.columns and now.guiding and line[:1].isdigit():
            cut = number == len(lines) and not text.endswith(("\n", "\r"))
            if cut and line.count(",") < len(now.columns) - 1:
                break  # the log was copied while PHD2 was writing it
            now.frame(number, line.split(","))
        else:
            now.head.append(line)
    told = enumerate((section for section in sections if section.rows), 1)
    runs = [section.run(path.stem if k == 1 else f"{path.stem}#{k}") for k, section in told]
    if not runs:
        other = {mark for section in sections for mark in section.other}
        raise CalibrationInputError(path, _empty(text, other), len(lines))
    return runs


def _empty(text: str, other: set[str]) -> str:
    """Why there is nothing to read."""
    if "AO" in other:
        unit = "an adaptive-optics unit (mount 'AO') only: it moves the star without the mount"
        return f"holds frames of {unit}, so the drive's error cannot be summed up"
    if other:
        return f"every frame is marked {', '.join(sorted(other))}: the star was never measured"
    if "Calibration Begins" in text and "Guiding Begins" not in text:
        return "holds a calibration only, no guiding section"
    return "holds no guiding section with frames"


@dataclass
class _Section:
    """A section as far as it is read: where the star was sent, and the error summed up frame by frame.

    `rows` are t s; ra, dec px; segment; dither px. `at` is where the sums of corrections and dithers stand.
    """

    path: Path
    guiding: bool
    head: list[str] = field(default_factory=list)
    columns: list[str] = field(default_factory=list)
    first: int = 0  # line of the first frame
    rows: list[tuple[float, float, float, float, float]] = field(default_factory=list)
    other: set[str] = field(default_factory=set)  # marks of frames that are no measurement of the mount
    time: float = -inf
    corrected: complex = 0j  # px, ra + i dec
    dithered: complex = 0j
    jumps: int = 0  # of unknown size
    lock: complex | None = None
    settling: bool = False

    def begin(self, line: int, columns: list[str]) -> None:
        """The header row of the table."""
        if missing := [c for c in COLUMNS if c not in columns]:
            raise CalibrationInputError(self.path, f"the column '{missing[0]}' is missing", line)
        self.columns = columns

    def event(self, text: str) -> None:
        """A dither, a new lock position (PHD2 writes the old one before a dither), or settling."""
        if "Settling started" in text:
            self.settling = True
        if "Settling complete" in text or "Settling failed" in text:
            self.settling = False
        if "SET LOCK" not in text and "DITHER" not in text:
            return
        dither, place = _px(_DITHER, text), _px(_LOCK, text)
        lock = _px(_LOCK, "\n".join(self.head)) if self.lock is None else self.lock
        if dither is not None:
            self.dithered += dither
        elif place is None or lock is None or abs(place - lock) > SAME_PX:
            self.jumps += 1
        self.lock = lock if place is None else place

    def frame(self, line: int, fields: list[str]) -> None:
        """One row of the table."""
        self.first = self.first or line
        row = dict(zip(self.columns, fields, strict=False))
        wide = f"{len(fields)} fields, the header row has {len(self.columns)}"

        def number(name: str) -> float:  # 0 where the table has no such column
            if name in self.columns and name not in row:
                raise CalibrationInputError(self.path, wide, line)
            found = plain(row.get(name, "0").strip())
            if found is None or abs(found) > LARGEST_FIELD:
                raise CalibrationInputError(self.path, f"'{row[name][:40]}' is not a number", line, name)
            return found

        def sent(duration: str, guided: float) -> float:  # 0 where no pulse was; a table without is trusted
            pulse = row.get(duration, "").strip() not in ("0", "0.0")
            return guided if isfinite(guided) and pulse else 0.0

        if not row.keys() >= {*COLUMNS}:
            raise CalibrationInputError(self.path, wide, line)
        mark = row["mount"].strip().strip('"')
        if mark not in MARKS:
            what = f"'{mark}' is none of {', '.join(MARKS)}{COMMAS}"
            raise CalibrationInputError(self.path, what, line, "mount")
        if mark != "Mount":
            self.other.add(mark)
            return
        if len(fields) > len(self.columns) + 1:
            raise CalibrationInputError(self.path, wide + COMMAS, line)
        t = number("Time")
        raw = complex(number("RARawDistance"), number("DECRawDistance"))
        ra, dec = number("RAGuideDistance"), number("DECGuideDistance")
        if not t >= self.time or not isfinite(t):
            back = f"time goes backwards from {self.time:g} s to {t:g} s"
            raise CalibrationInputError(self.path, back if isfinite(t) else "is no time in s", line, "Time")
        self.time = t
        if isfinite(raw.real) and not self.settling:
            star = raw + self.corrected + self.dithered
            self.rows.append((t, star.real, star.imag, float(self.jumps), self.dithered.real))
        self.corrected += complex(sent("RADuration", ra), sent("DECDuration", dec))

    def run(self, name: str) -> Run:
        """The section's frames, in arcsec where the head gives the pixel scale."""
        text = "\n".join(self.head)
        scale = _SCALE.search(text)
        said = scale[1] if scale else "1"
        factor = plain(said.replace(",", ".")) or 0.0  # a decimal comma is the writing computer's language
        if not PIXEL_SCALES[0] < factor < PIXEL_SCALES[1]:
            what = f"the section above this line has pixel scale '{said}', must be 0.01 to 100 arc-sec/px"
            raise CalibrationInputError(self.path, what, self.first)
        header = {"unit": "arcsec" if scale else "px"}
        if mount := _MOUNT.search(text):
            header["mount"] = mount[1].strip()
        start, start_s = _START.search(text), None
        if start:
            try:
                start_s = (datetime.fromisoformat(start[1]) - datetime(2000, 1, 1)).total_seconds()
            except ValueError:
                what = f"the section above this line: '{start[0]}' is no date and time"
                raise CalibrationInputError(self.path, what, self.first) from None
        scaled = (np.array(self.rows) * (1.0, factor, factor, 1.0, factor)).T.copy()
        columns = dict(zip(("t", "ra", "dec", "segment", "dither"), scaled, strict=True))
        notes = [] if scale else ["no pixel scale in the file: distances are in pixels"]
        return Run(name, self.path, name, columns, header=header, notes=notes, start_s=start_s)


def _px(pattern: re.Pattern[str], text: str) -> complex | None:
    found = pattern.search(text)
    return complex(float(found[1]), float(found[2])) if found else None
