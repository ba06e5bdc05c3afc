"""A run as one MCAP file (mcap.dev) with JSON schemas: Foxglove and PlotJuggler open it as it is."""

import json
from datetime import datetime
from heapq import merge
from math import isfinite
from pathlib import Path
from typing import Any

from scenarios.run.sources import Source, sources, summary_of


def export(folder: Path, file: Path) -> int:
    """Write what a run has left in `folder`; returns the number of messages. Times are UTC.

    Raises ValueError for a folder that is none of a run's, OSError with the file's name.
    """
    summary = summary_of(folder)
    try:
        return _write(folder, summary, file)
    except OSError as error:
        raise OSError(error.errno, error.strerror, error.filename or str(file)) from None


def _write(folder: Path, summary: dict[str, Any], file: Path) -> int:
    from mcap.writer import Writer

    start_ns = round(datetime.fromisoformat(summary["start_utc"]).timestamp() * 1e3) * 1_000_000
    channels: dict[str, int] = {}
    count = 0
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start(library="schmidt")
        writer.add_metadata(
            "run", {word: str(summary[word]) for word in ("scenario", "seed", "plant", "trace_digest")}
        )
        for entry in merge(*sources(folder, summary), key=lambda each: each.t_ns):
            topic = entry.source.topic
            if topic not in channels:
                channels[topic] = _channel(writer, entry.source)
            at_ns = start_ns + entry.t_ns
            writer.add_message(channels[topic], at_ns, _json(entry.values), at_ns)
            count += 1
        writer.finish()
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
