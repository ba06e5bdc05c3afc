"""Tables as people keep them: with commas, with ISO stamps, as JSON, a row per reading."""

import json
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

import numpy as np
from scipy.ndimage import map_coordinates

from tests.blind.world.made import Array, Rng

GERMAN = "%d.%m.%Y %H:%M:%S.%f"


@dataclass
class Column:
    """A signal in the file's own units, and the rig file's words about it (`unit`, `words`)."""

    channel: str
    name: str
    unit: str
    values: Array
    form: str = "%.6g"
    words: tuple[str, ...] = ()
    every: int = 1  # a long table has only each such row of it

    def told(self) -> str:
        """Its line of the rig file."""
        return ", ".join([f"column: {self.name}", f'unit: "{self.unit}"', *self.words])

    def text(self) -> list[str]:
        """Its cells."""
        return [self.form % x for x in self.values]


@dataclass
class Log:
    """One file: seconds from its start, and the columns."""

    t: Array
    columns: list[Column]
    start_s: float = 0.0  # of the file, after the first one's start


@dataclass(frozen=True)
class Style:
    """How a table is written. time: s, ms, iso, german, none. shape: comma, semicolon, tab, lines (JSON, an
    object per line), lists (JSON, an object of lists), long (name, stamp, value), long_lines (JSON)."""

    time: str = "s"
    shape: str = "comma"

    @property
    def ending(self) -> str:
        return {"lines": "jsonl", "lists": "json", "long_lines": "jsonl", "tab": "txt"}.get(self.shape, "csv")


DAY = datetime(2024, 3, 9, 20, 15, 7, tzinfo=UTC)


def stamps(t: Array, style: Style) -> list[str]:
    """Cells of the time column."""
    if style.time == "iso":
        return [(DAY + timedelta(seconds=float(x))).strftime("%Y-%m-%dT%H:%M:%S.%fZ") for x in t]
    if style.time == "german":
        return [(DAY + timedelta(seconds=float(x))).strftime(GERMAN) for x in t]
    return [f"{x * 1e3:.3f}" for x in t] if style.time == "ms" else [f"{x:.6f}" for x in t]


def encode(column: Column, bits: int) -> Column:
    """Sign-magnitude words: the bit `bits` is the sign (Dynamixel's present load has ten bits of size)."""
    words = np.abs(np.round(column.values)) + np.where(column.values < 0, 2.0**bits, 0.0)
    return replace(column, values=words, form="%d", words=(*column.words, f"sign_bit: {bits}"))


def write(log: Log, style: Style, rng: Rng) -> str:
    """The file's text."""
    at = log.start_s if style.time in ("iso", "german") else 0.0
    if style.shape in ("long", "long_lines"):
        return _long(log, style, rng, at)
    names = [c.name for c in log.columns]
    cells = [c.text() for c in log.columns]
    if style.time != "none":
        names, cells = ["t", *names], [stamps(at + log.t, style), *cells]
    if style.shape == "lists":
        return json.dumps({n: [_cell(x) for x in c] for n, c in zip(names, cells, strict=True)})
    rows = zip(*cells, strict=True)
    if style.shape == "lines":
        return "".join(json.dumps(dict(zip(names, map(_cell, r), strict=True))) + "\n" for r in rows)
    mark = {"semicolon": ";", "tab": "\t"}.get(style.shape, ",")
    return "".join(mark.join(r) + "\n" for r in [tuple(names), *rows])


def _long(log: Log, style: Style, rng: Rng, at: float) -> str:
    """A row per reading; every signal is read by a clock of its own, a part of a row late."""
    rows: list[tuple[float, str, str]] = []
    step = float(np.median(np.diff(log.t)))
    for k, column in enumerate(log.columns):
        shift = 0.0 if k == 0 else float(rng.uniform(0.0, 0.9)) * step
        seen = log.t[:: column.every] + shift
        # at the reading's own moment, in the file's quantum: a spline, as a line would halve the noise
        row = np.interp(seen, log.t, np.arange(len(log.t)))
        read = map_coordinates(column.values, [row], order=5, mode="nearest")
        if column.form == "%d":
            read = np.round(read)
        rows += [(float(x), column.name, column.form % y) for x, y in zip(seen, read, strict=True)]
    rows.sort()
    when = stamps(at + np.array([r[0] for r in rows]), style)
    if style.shape == "long_lines":
        return "".join(
            json.dumps({"at": _cell(t), "signal": n, "value": float(v)}) + "\n"
            for t, (_, n, v) in zip(when, rows, strict=True)
        )
    return "at,signal,value\n" + "".join(f"{t},{n},{v}\n" for t, (_, n, v) in zip(when, rows, strict=True))


def _cell(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def told(columns: list[Column], style: Style, period_s: float, more: list[str]) -> list[str]:
    """The rig file's lines about the table. more: channels that have no column of their own."""
    lines = []
    if style.shape in ("long", "long_lines"):
        lines.append("long: {name: signal, value: value}")
    if style.shape in ("semicolon", "tab"):
        lines.append(f"delimiter: {style.shape}")
    if style.time == "none":
        lines.append(f"sample_period_s: {period_s!r}")
    lines.append("columns:")
    name = "at" if style.shape.startswith("long") else "t"
    how = {"ms": ", scale: 0.001", "iso": ", format: iso", "german": f', format: "{GERMAN}"'}.get(
        style.time, ""
    )
    if style.time != "none":
        lines.append(f"  time: {{column: {name}, unit: s{how}}}")
    lines += [f"  {c.channel}: {{{c.told()}}}" for c in columns]
    return lines + [f"  {line}" for line in more]
