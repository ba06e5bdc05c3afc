"""Options of `schmidt paper` and `schmidt objective`. Light: the command line imports it."""

from dataclasses import dataclass
from pathlib import Path

LOW, HIGH = "low_preload_bridge", "high_preload_bridge"
"""The drive that both tables are published for: what of the rows it meets is in docs/reference/paper.md."""


@dataclass(frozen=True, kw_only=True)
class PaperOptions:
    """json_file: where the JSON goes. out: folder of the table (and the JSON, when none is named). plant,
    plant_high: plant files, or names, for low and high preload. rows: comma-separated.

    quick: two starts only, for a look. others: so many starts and seeds that no search has used. vary: rows
    with each of J, K, R, Tc and Ts off by so many percent instead. jobs: processes (None: one per core);
    scheduler: a Dask scheduler instead."""

    out: Path
    json_file: Path | None = None
    plant: str = LOW
    plant_high: str = HIGH
    rows: str | None = None
    quick: bool = False
    others: int = 0
    vary: float = 0.0
    jobs: int | None = None
    scheduler: str | None = None


@dataclass(frozen=True, kw_only=True)
class ObjectiveOptions:
    """out: folder of table and JSON. compensation: a table of `schmidt calibrate`. starts: number of start
    angles, all moved by `shift`, degrees; seeds: taken in turn; seconds: of each run. only: rows whose name
    contains this. steps: the firmware's changes one after the other instead."""

    out: Path
    steps: bool = False
    compensation: Path | None = None
    starts: int = 8
    seeds: int = 3
    shift: float = 0.0
    seconds: float = 600.0
    plant: str = LOW
    plant_high: str = HIGH
    only: str | None = None
