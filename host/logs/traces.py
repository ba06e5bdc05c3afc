"""Traces as Parquet: columns of floats, streamed in row groups so that a night never sits in memory."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from host.logs.axis import COLUMNS
from host.logs.files import LogError, reason

_ROWS_PER_GROUP = 1 << 13


class Trace:
    """One Parquet file of float64 columns.

    The file gets its footer at `close`, also when a run is interrupted. Pieces are joined to row groups of
    about 8 000 rows before they are written.
    """

    def __init__(self, path: Path, columns: tuple[str, ...], units: dict[str, str]) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        self.path = path
        self.columns = columns
        self._pieces: list[npt.NDArray[np.float64]] = []
        self._rows = 0
        self._schema = pa.schema(
            [pa.field(name, pa.float64(), metadata={"unit": units.get(name, "")}) for name in columns]
        )
        try:
            self._writer: Any = pq.ParquetWriter(path, self._schema, compression="zstd")
        except OSError as error:
            raise LogError(f"{path}: cannot be written: {error.strerror}") from None

    def append(self, rows: npt.NDArray[np.float64]) -> None:
        """Add rows, shape (n, number of columns)."""
        if rows.shape[1:] != (len(self.columns),):
            raise ValueError(f"{self.path.name}: {rows.shape[1:]} columns for {len(self.columns)}")
        self._pieces.append(rows)
        self._rows += len(rows)
        if self._rows >= _ROWS_PER_GROUP:
            self.flush()

    def flush(self) -> None:
        """Write what is waiting as one row group."""
        if not self._pieces or self._writer is None:
            return
        import pyarrow as pa

        columns = np.ascontiguousarray(np.concatenate(self._pieces).T)
        count = columns.shape[1]
        self._pieces.clear()
        self._rows = 0
        try:
            # not pa.array, which imports pandas to see what it has been given: half a second
            buffers = [pa.Array.from_buffers(pa.float64(), count, [None, pa.py_buffer(c)]) for c in columns]
            self._writer.write_table(pa.table(buffers, schema=self._schema))
        except OSError as error:
            raise LogError(f"{self.path}: {reason(error)}") from None

    def close(self) -> None:
        """Write the rest and the footer; a second close does nothing."""
        if self._writer is None:
            return
        try:
            self.flush()
        finally:
            writer, self._writer = self._writer, None
            try:
                writer.close()
            except OSError as error:
                raise LogError(f"{self.path}: {reason(error)}") from None


def read(
    path: Path, columns: tuple[str, ...], low_s: float, high_s: float
) -> dict[str, npt.NDArray[np.float64]]:
    """Columns of the rows with `low_s <= t_s <= high_s`, read without loading the rest of the file."""
    import pyarrow.parquet as pq

    wanted = list(dict.fromkeys(("t_s", *columns)))
    table = pq.read_table(path, columns=wanted, filters=[("t_s", ">=", low_s), ("t_s", "<=", high_s)])
    return {name: _column(table[name]) for name in wanted}


def batches(path: Path, columns: Sequence[str] | None = None) -> Iterator[Any]:
    """A trace, or an axis log, as record batches of floats; all columns, or some."""
    if path.suffix == ".parquet":
        import pyarrow.parquet as pq

        yield from pq.ParquetFile(path).iter_batches(_ROWS_PER_GROUP, columns=columns)
        return
    from pyarrow import csv

    with path.open(encoding="utf-8") as file:
        header = sum(1 for _ in iter(lambda: file.readline().startswith("#"), False))
    floats = csv.ConvertOptions(column_types=dict.fromkeys(COLUMNS, "float64"), include_columns=columns)
    with csv.open_csv(path, csv.ReadOptions(skip_rows=header), convert_options=floats) as rows:
        yield from rows


def overview(path: Path, columns: tuple[str, ...], points: int = 4000) -> dict[str, npt.NDArray[np.float64]]:
    """The whole file in about `points` rows: of every stretch the extremes of the first column.

    Row group by row group: no peak is lost, and a night costs no more memory than a minute.
    """
    import pyarrow.parquet as pq

    wanted = list(dict.fromkeys(("t_s", *columns)))
    pieces: list[npt.NDArray[np.float64]] = []
    with pq.ParquetFile(path) as file:
        width = max(1, -(-2 * file.metadata.num_rows // points))
        for group in range(file.num_row_groups):
            table = file.read_row_group(group, columns=wanted)
            rows = np.stack([_column(table[name]) for name in wanted], axis=1)
            pieces.append(rows[extremes(rows[:, 1], width)])
    joined = np.concatenate(pieces) if pieces else np.empty((0, len(wanted)))
    return {name: joined[:, index] for index, name in enumerate(wanted)}


def _column(column: Any) -> npt.NDArray[np.float64]:
    """A column without gaps as an array; `to_numpy` would import pandas first, half a second."""
    return np.concatenate([np.empty(0), *(np.from_dlpack(chunk) for chunk in column.chunks)])


def extremes(values: npt.NDArray[np.float64], width: int) -> npt.NDArray[np.intp]:
    """Return indices of the smallest and largest value of every stretch of `width`, in order."""
    whole = len(values) // width * width
    if width < 3 or not whole:
        return np.arange(len(values))
    blocks = values[:whole].reshape(-1, width)
    start = np.arange(len(blocks)) * width
    ends = np.stack([blocks.argmin(axis=1) + start, blocks.argmax(axis=1) + start], axis=1)
    return np.sort(ends, axis=1).reshape(-1)
