"""PHD2 guide logs as PHD2 writes them: several sections per file, calibrations, drops, dithers, settling.

The open-loop drive error of a section is the raw distance plus the running sum of the earlier corrections,
times the
pixel scale (PHD2's own log analysis uses the same sum). A dither moves the star, not the drive, by the amount
that
its line tells, along the mount's axes: it is added. A new lock position that no dither tells starts a new
segment
with an offset of its own. Frames while settling are left out. PHD2 writes the distance it wanted to correct
even
when no pulse was sent (guiding disabled); such a row's RADuration is 0 and nothing is added.
"""

from __future__ import annotations

import re
from datetime import datetime
from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.readers.csvtext import plain
from calibration.readers.guidemoves import Moves, moves_of
from calibration.readers.run import Array, Run

_SCALE = re.compile(r"[Pp]ixel scale\s*=\s*([0-9.,+-]+)\s*arc-sec/px")
_BEGIN = re.compile(r"Guiding Begins at (\d{4}-\d\d-\d\d \d\d:\d\d:\d\d)")
_MOUNT = re.compile(r"^Mount\s*=\s*([^,\r\n]+)", re.MULTILINE)
_DEC = re.compile(r"\bDec\s*=\s*([0-9.+-]+)\s*deg")
_SIDE = re.compile(r"Pier side\s*=\s*(\w+)")
COLUMNS = ("Frame", "Time", "mount", "RARawDistance", "RAGuideDistance")
_TABLE = re.compile(r"\s*\"?Frame\"?,\s*\"?Time\"?,\s*\"?mount\"?,", re.IGNORECASE)
CLOCK = "clock_s"  # header key of a start in s, where a table's rig file says how it is known
MARKS = ("Mount", "AO", "DROP")
_MOST = 1e9
"""s or px; beyond any night and any camera, and sums of such numbers stay finite. ASSUMPTION."""
_NEEDED = ("Time", "RARawDistance", "RAGuideDistance")


def is_guide_log(text: str) -> bool:
    """True when the text looks like a PHD2 guide log, or like one of its guiding tables."""
    head = text[:20000]
    return "PHD2" in head[:200] or "Guiding Begins" in head or bool(_TABLE.match(head))


def read_guide_log(path: Path, text: str | None = None) -> list[Run]:
    """Every guiding section of the file as one Run with columns t (s), ra, dec (arcsec), segment.

    Sections without frames are skipped. Without a pixel scale (a bare table) the unit is pixels;
    `header['unit']`
    says so. Raises CalibrationInputError with line and column.
    """
    if text is None:
        text = path.read_text(encoding="utf-8", errors="replace")
    lines = text.splitlines()
    runs: list[Run] = []
    head: list[str] = []
    columns: list[str] | None = None
    rows: list[tuple[int, list[str]]] = []
    events: list[tuple[int, str]] = []
    guiding = bool(_TABLE.match(text))
    other: set[str] = set()
    for number, line in enumerate(lines, 1):
        if line.startswith(("Guiding Begins", "Calibration Begins")):
            other |= _close(runs, path, head, columns, rows, events)
            head, columns, rows, events = [line], None, [], []
            guiding = line.startswith("Guiding")
        elif line.startswith(("Guiding Ends", "Calibration complete")):
            other |= _close(runs, path, head, columns, rows, events)
            head, columns, rows, events, guiding = [], None, [], [], False
        elif _TABLE.match(line):
            columns = [c.strip().strip('"') for c in line.split(",")]
            missing = [c for c in COLUMNS if c not in columns]
            if missing:
                raise CalibrationInputError(path, f"the column '{missing[0]}' is missing", number)
        elif line.startswith("INFO"):
            events.append((number, line))
        elif columns is not None and guiding and line[:1].isdigit():
            if (
                number == len(lines)
                and not text.endswith(("\n", "\r"))
                and line.count(",") < len(columns) - 1
            ):
                break  # the log was copied while PHD2 was writing it
            rows.append((number, line.split(",")))
        else:
            head.append(line)
    other |= _close(runs, path, head, columns, rows, events)
    if not runs:
        raise CalibrationInputError(path, _empty(text, other), len(lines))
    return runs


def _empty(text: str, other: set[str]) -> str:
    """Why there is nothing to read."""
    if "AO" in other:
        return (
            "holds frames of an adaptive-optics unit (mount 'AO') only: it moves the star without the mount,"
            " so the drive's error cannot be summed up"
        )
    if other:
        return f"every frame is marked {', '.join(sorted(other))}: the star was never measured"
    if "Calibration Begins" in text and "Guiding Begins" not in text:
        return "holds a calibration only, no guiding section"
    return "holds no guiding section with frames"


def _number(path: Path, line: int, name: str, value: str) -> float:
    found = plain(value.strip())
    if found is None or abs(found) > _MOST:
        raise CalibrationInputError(path, f"'{value[:40]}' is not a number", line, name)
    return found


def _close(
    runs: list[Run],
    path: Path,
    head: list[str],
    columns: list[str] | None,
    rows: list[tuple[int, list[str]]],
    events: list[tuple[int, str]],
) -> set[str]:
    """Append the section as a run; the marks of frames that are no measurement of the mount."""
    if columns is None or not rows:
        return set()
    text = "\n".join(head)
    scale = _SCALE.search(text)
    track = _Track(
        path,
        columns,
        events,
        moves_of(text, events),
        _scale(path, rows[0][0], scale.group(1)) if scale else 1.0,
    )
    for line, fields in rows:
        track.take(line, fields)
    if track.rows:
        name = path.stem if not runs else f"{path.stem}#{len(runs) + 1}"
        notes = [] if scale else ["no pixel scale in the file: distances are in pixels"]
        header = _header(text, "arcsec" if scale else "px", track)
        runs.append(Run(name, path, name, track.columns_of_run(), header=header, notes=notes))
    return track.other


def _header(text: str, unit: str, track: _Track) -> dict[str, str]:
    """What a section's head tells of the mount, and how its distances were read."""
    header = {"unit": unit, "pixel_scale": f"{track.factor:g}", "drops": str(track.drops)}
    for key, pattern in (("mount", _MOUNT), ("declination_deg", _DEC), ("pier_side", _SIDE)):
        found = pattern.search(text)
        if found:
            header[key] = found.group(1).strip()
    began = _BEGIN.search(text)
    if began:
        header["start_local"] = began.group(1)
        try:
            _clock(began.group(1))
        except ValueError:
            what = f"'Guiding Begins at {began.group(1)}' is no date and time"
            raise CalibrationInputError(track.path, what) from None
    return header


class _Track:
    """The error of one section, summed up frame by frame; `rows` are t s, ra, dec, segment, dither."""

    def __init__(
        self, path: Path, columns: list[str], events: list[tuple[int, str]], moves: Moves, factor: float
    ) -> None:
        self.path, self.width, self.moves, self.factor = path, len(columns), moves, factor
        self.where = {c: k for k, c in enumerate(columns)}
        self.marks = {
            "off": [n for n, e in events if "Settling started" in e],
            "on": [n for n, e in events if "Settling complete" in e or "Settling failed" in e],
        }
        self.rows: list[tuple[float, float, float, float, float]] = []
        self.other: set[str] = set()
        self.drops = 0
        self._sum_ra = self._sum_dec = 0.0  # px, of the corrections so far
        self._before = -np.inf

    def take(self, line: int, fields: list[str]) -> None:
        """One row of the table."""
        mark = self._mark(line, fields)
        if mark != "Mount":
            self.drops += mark == "DROP"
            self.other.add(mark)
            return
        if len(fields) > self.width + 1:
            what = f"{len(fields)} fields, the header row has {self.width}: decimal commas? write points"
            raise CalibrationInputError(self.path, what, line)
        t, raw, guided = (_number(self.path, line, c, fields[self.where[c]]) for c in _NEEDED)
        self._check_time(line, t)
        raw_dec, guided_dec = (self._optional(line, fields, f"DEC{c}Distance") for c in ("Raw", "Guide"))
        if np.isfinite(raw) and not _settling(line, self.marks):
            by_ra, by_dec, new = self.moves.before(line)
            ra, dec = raw + self._sum_ra + by_ra, raw_dec + self._sum_dec + by_dec
            self.rows.append((t, ra * self.factor, dec * self.factor, float(new), by_ra * self.factor))
        self._sum_ra += self._correction(fields, "RADuration", guided)
        self._sum_dec += self._correction(fields, "DECDuration", guided_dec)

    def columns_of_run(self) -> dict[str, Array]:
        """The run's columns (n,)."""
        table = np.array(self.rows)
        return {c: table[:, k].copy() for k, c in enumerate(("t", "ra", "dec", "segment", "dither"))}

    def _mark(self, line: int, fields: list[str]) -> str:
        if len(fields) <= max(self.where[c] for c in COLUMNS):
            raise self._short(line, fields)
        mark = fields[self.where["mount"]].strip().strip('"')
        if mark not in MARKS:
            what = f"'{mark}' is none of {', '.join(MARKS)} (decimal commas? write points)"
            raise CalibrationInputError(self.path, what, line, "mount")
        return mark

    def _check_time(self, line: int, t: float) -> None:
        if not np.isfinite(t):
            raise CalibrationInputError(self.path, "is no time in s", line, "Time")
        if t < self._before:
            what = f"time goes backwards from {self._before:g} s to {t:g} s"
            raise CalibrationInputError(self.path, what, line, "Time")
        self._before = t

    def _optional(self, line: int, fields: list[str], column: str) -> float:
        at = self.where.get(column)
        if at is not None and at >= len(fields):
            raise self._short(line, fields)
        return 0.0 if at is None else _number(self.path, line, column, fields[at])

    def _short(self, line: int, fields: list[str]) -> CalibrationInputError:
        what = f"{len(fields)} fields, the header row has {self.width}"
        return CalibrationInputError(self.path, what, line)

    def _correction(self, fields: list[str], duration: str, guided: float) -> float:
        """px that a pulse moved the mount by; 0 when none was sent."""
        return guided if np.isfinite(guided) and _sent(fields, self.where.get(duration)) else 0.0


def _sent(fields: list[str], at: int | None) -> bool:
    """Whether a pulse went out; a table without durations is believed."""
    return at is None or at >= len(fields) or fields[at].strip() not in ("0", "0.0")


def _scale(path: Path, line: int, text: str) -> float:
    """The pixel scale of a section's header; a decimal comma is the writing computer's language."""
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = 0.0
    if not 0.01 < value < 100:
        raise CalibrationInputError(
            path,
            f"the section above this line has pixel scale '{text}', must be 0.01 to 100 arc-sec/px",
            line,
        )
    return value


def start_seconds(run: Run) -> float | None:
    """Clock time of the section's beginning in s, by the computer's clock; None when it is not written."""
    if CLOCK in run.header:
        return float(run.header[CLOCK])
    text = run.header.get("start_local")
    if text is None:
        return None
    return (_clock(text) - datetime(2000, 1, 1)).total_seconds()


def _clock(text: str) -> datetime:
    return datetime.strptime(text, "%Y-%m-%d %H:%M:%S")


def _settling(line: int, marks: dict[str, list[int]]) -> bool:
    started = max((n for n in marks["off"] if n < line), default=0)
    ended = max((n for n in marks["on"] if n < line), default=0)
    return started > ended
