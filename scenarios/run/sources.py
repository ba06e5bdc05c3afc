"""What a run has left in its folder, in the order of time: frames, logs, truth, faults, verdicts."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from bus.protocol.page import DBC_PATH
from plant.yamltext import read_text

_BATCH = 4096
"""Rows of a Parquet file at a time."""
_LINE_LOGS = {
    "commands": ("utc", "t_s", "node", "command", "result"),
    "errors": ("utc", "t_s", "where", "what"),
}
NUMBER = {"type": "number"}
TEXT = {"type": "string"}
_KINDS = {bool: "boolean", int: "number", float: "number", str: "string", dict: "object", list: "array"}


class Source(NamedTuple):
    """Entries of one topic in the order of time. properties: of the JSON schema, by field."""

    topic: str
    properties: dict[str, dict[str, Any]]


class Entry(NamedTuple):
    """t_ns: simulated, since the start."""

    t_ns: int
    source: Source
    values: dict[str, Any]


def sources(folder: Path, summary: dict[str, Any]) -> list[Iterator[Entry]]:
    """All that is there; each one sorted by time."""
    found = [_frames(path) for path in (folder / "can.log", folder / "can.log.zst") if path.exists()][:1]
    found += [_axis_log(path) for path in sorted(folder.glob("axis-*.csv"))]
    found += [_parquet(path) for path in sorted(folder.glob("*.parquet"))]
    found += [
        _lines(folder / f"{name}.log", name) for name in _LINE_LOGS if (folder / f"{name}.log").exists()
    ]
    return [*found, *_of_summary(summary)]


def _frames(path: Path) -> Iterator[Entry]:
    """Every frame by its name in the DBC; one that is not in it as its bytes."""
    import can
    from cantools.database import Database, load_file

    known = load_file(DBC_PATH, strict=True)
    assert isinstance(known, Database)
    by_id: dict[int, Any] = {message.frame_id: message for message in known.messages}
    made: dict[str, Source] = {}
    for message in by_id.values():
        fields = {
            signal.name: NUMBER | ({"description": f"unit {signal.unit}"} if signal.unit else {})
            for signal in message.signals
        }
        sender, _, what = message.name.rpartition("_")
        made[message.name] = Source(f"/can/{sender}/{what}", fields)
    raw = Source("/can/other", {"identifier": TEXT, "data": TEXT})
    with _text(path) as text, can.CanutilsLogReader(text) as reader:
        for frame in reader:
            t_ns = round(frame.timestamp * 1e6) * 1000
            known_one = None if frame.is_remote_frame else by_id.get(frame.arbitration_id)
            try:
                values = (
                    None if known_one is None else known_one.decode(bytes(frame.data), decode_choices=False)
                )
            except (ValueError, KeyError):  # cantools' errors: too short, an opcode that is none
                values = None
            if values is None or known_one is None:
                body = {"identifier": f"{frame.arbitration_id:X}", "data": bytes(frame.data).hex()}
                yield Entry(t_ns, raw, body)
            else:
                yield Entry(t_ns, made[known_one.name], values)


def _text(path: Path) -> TextIO:
    if path.suffix != ".zst":
        return path.open(encoding="ascii")
    import pyarrow

    return io.TextIOWrapper(pyarrow.input_stream(str(path), compression="zstd"), encoding="ascii")


def _axis_log(path: Path) -> Iterator[Entry]:
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        source = Source(f"/{path.stem.replace('-', '/')}", dict.fromkeys(rows.fieldnames or (), NUMBER))
        for row in rows:
            values = {name: float(text) if text else None for name, text in row.items()}
            yield Entry(round((values["t"] or 0.0) * 1e9), source, values)


def _parquet(path: Path) -> Iterator[Entry]:
    """Traces of the plant (truth) and of the host."""
    from pyarrow import parquet

    file = parquet.ParquetFile(path)
    source = Source(f"/{path.stem.replace('-', '/')}", dict.fromkeys(file.schema_arrow.names, NUMBER))
    for batch in file.iter_batches(_BATCH):
        for row in batch.to_pylist():
            yield Entry(round(row["t_s"] * 1e9), source, row)


def _lines(path: Path, name: str) -> Iterator[Entry]:
    """A text log of the host: fields behind two blanks."""
    fields = _LINE_LOGS[name]
    source = Source(f"/{name}", {field: NUMBER if field == "t_s" else TEXT for field in fields})
    with path.open(encoding="utf-8") as file:
        for line in file:
            if not line.startswith("#"):
                values: dict[str, Any] = dict(
                    zip(fields, line.rstrip("\n").split("  ", len(fields) - 1), strict=False)
                )
                values["t_s"] = float(values["t_s"])
                yield Entry(round(values["t_s"] * 1e9), source, values)


def _of_summary(summary: dict[str, Any]) -> list[Iterator[Entry]]:
    """Steps when they begin, faults when they first act (or should have), verdicts at the end."""
    end_s = summary["simulated_s"]
    groups: dict[str, tuple[list[dict[str, Any]], Callable[[dict[str, Any]], Any]]] = {
        "steps": (summary["steps"], lambda each: each["start_s"]),
        "faults": (summary.get("faults", []), lambda each: each["first_s"] or each["at_s"]),
        "verdicts": (summary["expectations"], lambda _: end_s),
    }
    found = []
    for name, (each, when) in groups.items():
        schema = _schema(each)
        source = Source(f"/{name}", schema.get("properties", {}))
        timed = [(end_s if when(one) is None else when(one), one) for one in each]
        entries = [Entry(round(t_s * 1e9), source, _fitted(one, schema)) for t_s, one in timed]
        found.append(iter(sorted(entries, key=lambda entry: entry.t_ns)))
    return found


def _schema(values: list[Any]) -> dict[str, Any]:
    """The JSON schema of all these values; text where they are of several kinds.

    Foxglove wants one type for each property, and knows no null.
    """
    there = [value for value in values if value is not None]
    kinds = {_KINDS[type(value)] for value in there} or {"number"}
    if kinds == {"object"}:
        names = {name: None for value in there for name in value}
        fields = {name: _schema([value.get(name) for value in there]) for name in names}
        return {"type": "object", "properties": fields}
    if kinds == {"array"}:
        return {"type": "array", "items": _schema([one for value in there for one in value])}
    return {"type": kinds.pop()} if len(kinds) == 1 else TEXT


def _fitted(value: Any, schema: dict[str, Any]) -> Any:
    """The value as its schema has it: what is None is left out."""
    if schema["type"] == "object":
        fields = schema["properties"]
        return {name: _fitted(one, fields[name]) for name, one in value.items() if one is not None}
    return json.dumps(value) if schema is TEXT and not isinstance(value, str) else value


def summary_of(folder: Path) -> dict[str, Any]:
    """summary.json of a run; raises ValueError where there is none."""
    try:
        found: dict[str, Any] = json.loads(read_text(folder / "summary.json"))
    except FileNotFoundError:
        raise ValueError(f"{folder}: no summary.json: give the output folder of schmidt run") from None
    except ValueError as error:
        raise ValueError(f"{folder / 'summary.json'}: {error}") from None
    return found
