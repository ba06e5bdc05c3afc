"""A run as one MCAP file (mcap.dev) with JSON schemas: Foxglove and PlotJuggler open it as it is."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from datetime import datetime
from heapq import merge
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple, TextIO

import yaml

from bus.protocol.page import DBC_PATH
from host.logs.traces import batches
from plant.yamltext import read_text

SUMMARY = "summary.json"
NUMBER = {"type": "number"}
TEXT = {"type": "string"}
_TABLE: dict[str, Any] = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
_LINE_LOGS: dict[str, list[str]] = _TABLE["logs"]


class Source(NamedTuple):
    """Entries of one topic in the order of time. properties: of the JSON schema, by field."""

    topic: str
    properties: dict[str, dict[str, Any]]


class Entry(NamedTuple):
    """t_ns: simulated, since the start."""

    t_ns: int
    source: Source
    values: dict[str, Any]


def sources(folder: Path, summary: dict[str, Any], files: ExitStack) -> list[Iterator[Entry]]:
    """All that is there; each one sorted by time. What is open of them is closed with `files`. Raises
    ValueError, here or on the way, with the file that is broken."""
    logs = [(_frames, path) for path in (folder / "can.log", folder / "can.log.zst") if path.exists()][:1]
    logs += [(_rows, path) for form in ("axis-*.csv", "*.parquet") for path in sorted(folder.glob(form))]
    logs += [(_lines, path) for name in _LINE_LOGS if (path := folder / f"{name}.log").exists()]
    with _named(folder / SUMMARY):
        rows = [files.enter_context(closing(_told(read, path))) for read, path in logs]
        return [*rows, *_of_summary(summary)]


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Whatever goes wrong with what is in a file is one line with its name."""
    try:
        yield
    except (OSError, ValueError, TypeError, LookupError, AttributeError, ArithmeticError, csv.Error) as error:
        missing = isinstance(error, KeyError) and f": {error} is missing"
        why = (isinstance(error, OSError) and error.strerror and f": {error.strerror.lower()}") or missing
        raise ValueError(f"{path}: is not as a run has left it{why or ''}") from None


def _told(read: Callable[[Path], Iterator[Entry]], path: Path) -> Generator[Entry, None, None]:
    with _named(path):
        yield from read(path)


def _frames(path: Path) -> Iterator[Entry]:
    """Every frame by its name in the DBC; one that is not in it as its bytes."""
    import can
    from cantools.database import Database, DecodeError, load_file

    database = load_file(DBC_PATH, strict=True)
    assert isinstance(database, Database)
    known: dict[int, tuple[Any, Source]] = {}
    for message in database.messages:
        fields = {
            signal.name: NUMBER | ({"description": f"unit {signal.unit}"} if signal.unit else {})
            for signal in message.signals
        }
        sender, _, what = message.name.rpartition("_")
        known[message.frame_id] = message, Source(f"/can/{sender}/{what}", fields)
    raw = Source("/can/other", {"identifier": TEXT, "data": TEXT})
    with _text(path) as text, can.CanutilsLogReader(text) as reader:
        for frame in reader:
            source, values = raw, {"identifier": f"{frame.arbitration_id:X}", "data": bytes(frame.data).hex()}
            if frame.arbitration_id in known and not (frame.is_remote_frame or frame.is_extended_id):
                message, its = known[frame.arbitration_id]
                with suppress(DecodeError):  # too short, an opcode that is none
                    values, source = message.decode(bytes(frame.data), decode_choices=False), its
            yield Entry(round(frame.timestamp * 1e6) * 1000, source, values)


def _text(path: Path) -> TextIO:
    if path.suffix != ".zst":
        return path.open(encoding="ascii")
    import pyarrow

    return io.TextIOWrapper(pyarrow.input_stream(str(path), compression="zstd"), encoding="ascii")


def _rows(path: Path) -> Iterator[Entry]:
    """Axis logs, and traces of the plant (truth) and of the host."""
    for batch in batches(path):
        source = Source(f"/{path.stem.replace('-', '/')}", dict.fromkeys(batch.schema.names, NUMBER))
        time = "t_s" if path.suffix == ".parquet" else "t"
        for row in batch.to_pylist():
            yield Entry(round((row[time] or 0.0) * 1e9), source, row)


def _lines(path: Path) -> Iterator[Entry]:
    """A text log of the host: fields behind two blanks."""
    fields = _LINE_LOGS[path.stem]
    source = Source(f"/{path.stem}", {field: NUMBER if field == "t_s" else TEXT for field in fields})
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
    found = []
    for name, row in _TABLE["summary"].items():
        fields = {field: {"type": kind} for kind, names in row["fields"].items() for field in names}
        source = Source(f"/{row['topic']}", fields)
        entries = []
        for each in summary.get(name, []):
            times = (each.get(row["time"]), each.get("at_s"), summary["simulated_s"])
            t_s = next(time for time in times if time is not None)
            arguments = {"arguments": json.dumps(each["arguments"])} if "arguments" in each else {}
            entries.append(Entry(round(t_s * 1e9), source, each | arguments))
        found.append(iter(sorted(entries, key=lambda entry: entry.t_ns)))
    return found


def summary_of(folder: Path) -> dict[str, Any]:
    """summary.json of a run; raises ValueError where there is none."""
    try:
        found: dict[str, Any] = json.loads(read_text(folder / SUMMARY))
    except FileNotFoundError:
        raise ValueError(f"{folder}: no {SUMMARY}: give the output folder of schmidt run") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"{folder / SUMMARY}:{error.lineno}: is not JSON, as a run leaves it") from None
    except ValueError as error:
        raise ValueError(f"{folder / SUMMARY}: {error}") from None
    return found


def export(folder: Path, file: Path) -> int:
    """Write what a run has left in `folder`; returns the number of messages. Times are UTC.

    Raises ValueError for a folder that is none of a run's, OSError with the file's name.
    """
    from mcap.writer import Writer

    summary = summary_of(folder)
    with _named(folder / SUMMARY):
        start_ns = round(datetime.fromisoformat(summary["start_utc"]).timestamp() * 1e3) * 1_000_000
        about = {word: str(summary[word]) for word in ("scenario", "seed", "plant", "trace_digest")}
    channels: dict[str, int] = {}
    count = 0
    try:
        with file.open("wb") as stream, ExitStack() as files:
            writer = Writer(stream)
            writer.start(library="schmidt")
            writer.add_metadata("run", about)
            for entry in merge(*sources(folder, summary, files), key=lambda each: each.t_ns):
                topic = entry.source.topic
                if topic not in channels:
                    channels[topic] = _channel(writer, entry.source)
                at_ns = start_ns + entry.t_ns
                writer.add_message(channels[topic], at_ns, _json(entry.values), at_ns)
                count += 1
            writer.finish()
    except OSError as error:
        raise OSError(error.errno, error.strerror, error.filename or str(file)) from None
    return count


def _channel(writer: Any, source: Source) -> int:
    schema = {"title": source.topic, "type": "object", "properties": source.properties}
    number = writer.register_schema(source.topic, "jsonschema", json.dumps(schema).encode())
    channel: int = writer.register_channel(source.topic, "json", number)
    return channel


def _json(values: dict[str, Any]) -> bytes:
    """What is no number (an open loop has no set point) is left out: neither JSON nor Foxglove knows nan."""
    plain = {
        name: value
        for name, value in values.items()
        if value is not None and not (isinstance(value, float) and not isfinite(value))
    }
    return json.dumps(plain, separators=(",", ":")).encode()
