"""What a campaign has found so far: a line a run as it comes, and one Parquet table at the end."""

import json
from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any

from host.logs.files import LogError
from plant.yamltext import TextError, check_regular
from scenarios.campaign.job import Row
from scenarios.language.document import ScenarioError

JOURNAL, TABLE = "runs.jsonl", "runs.parquet"
_CHUNK = 10_000
_FIELDS = {"key": str, "index": int, "failure": str}
"""What every row has."""


class Journal:
    """`runs.jsonl`: every finished run is on disk before the next one counts. A torn last line is no run, and
    a row that says `lost` (its worker died) is one to be made again."""

    def __init__(self, folder: Path, resume: bool) -> None:
        self.path = folder / JOURNAL
        self.done: set[str] = set()
        if self.path.exists():
            self.done = {row["key"] for row in rows(self.path) if not row.get("lost")}
            if self.done and not resume:
                what = f"{folder} holds {len(self.done)} runs already"
                raise ScenarioError(f"{what}; --resume goes on with them, or give another --out")
        folder.mkdir(parents=True, exist_ok=True)
        self._file = self.path.open("a", encoding="utf-8")
        if self._file.tell():
            self._file.write("\n")  # ends a line that was torn; an empty one is none

    def add(self, row: Row) -> None:
        """Write a finished run; raises LogError."""
        try:
            self._file.write(json.dumps(row, ensure_ascii=False) + "\n")
            self._file.flush()
        except OSError as error:
            raise LogError(f"{self.path}: {error.strerror}; --resume goes on with what is there") from None
        if not row.get("lost"):
            self.done.add(row["key"])

    def close(self) -> None:
        """Close the file; what a full disk did not take has been reported."""
        with suppress(OSError):
            self._file.close()


def rows(path: Path) -> Iterator[Row]:
    """The runs of a journal; lines that were torn or are no run are left out."""
    try:
        check_regular(path)
    except TextError as error:
        raise ScenarioError(f"{path}: {error}") from None
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in file:
            try:
                found = json.loads(line)
            except (ValueError, RecursionError):
                continue
            if (
                isinstance(found, dict)
                and all(type(found.get(name)) is kind for name, kind in _FIELDS.items())
                and all(map(_scalar, found.values()))
            ):
                yield found


def _scalar(value: Any) -> bool:
    """Values that a column can hold."""
    if isinstance(value, int):
        return abs(value) < 1 << 63
    return value is None or isinstance(value, float | str)


def write(folder: Path) -> Path:
    """Turn the journal into `runs.parquet`, in pieces, and return its path; of a run made twice the later."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns: dict[str, type] = {}
    last: dict[str, int] = {}
    for place, row in enumerate(rows(folder / JOURNAL)):
        last[row["key"]] = place
        for name, value in row.items():
            columns[name] = _wider(columns.get(name), value)
    kinds = {bool: pa.bool_(), int: pa.int64(), float: pa.float64(), str: pa.string()}
    schema = pa.schema([pa.field(name, kinds[kind]) for name, kind in columns.items()])
    chosen = (row for place, row in enumerate(rows(folder / JOURNAL)) if last[row["key"]] == place)
    try:
        with pq.ParquetWriter(folder / TABLE, schema, compression="zstd") as writer:
            for part in iter(lambda: list(islice(chosen, _CHUNK)), []):
                data = {
                    name: [None if row.get(name) is None else kind(row[name]) for row in part]
                    for name, kind in columns.items()
                }
                writer.write_table(pa.table(data, schema=schema))
    except OSError as error:
        raise LogError(f"{folder / TABLE}: cannot be written: {error.strerror or error}") from None
    return folder / TABLE


def read(path: Path) -> dict[str, list[Any]]:
    """The table by columns."""
    import pyarrow.parquet as pq

    found: dict[str, list[Any]] = pq.read_table(path).to_pydict()
    return found


def _wider(kind: type | None, value: Any) -> type:
    """The narrowest of bool, int, float, text that holds both."""
    new = type(value) if isinstance(value, bool | int | float | str) else (kind or float)
    if kind is None or kind is new:
        return new
    return float if {kind, new} <= {int, float} else str
