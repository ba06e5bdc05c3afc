"""Options of `schmidt paper` and `schmidt objective`. Light: the command line imports it."""

from dataclasses import dataclass
from pathlib import Path

LOW, HIGH = "low_preload_bridge", "high_preload_bridge"
"""Plants of `schmidt objective`, as its table is published."""


@dataclass(frozen=True, kw_only=True)
class PaperOptions:
    """json_file: where the JSON goes. out: folder for plots (and the JSON, when none is named). plant,
    plant_high: plant files for low and high preload instead of the project's own. reading: of Table 2's
    units, "motor" or "printed", when no plant file is named. rows: comma-separated. quick: two starts only,
    for a look; every: all 24 combinations of angle and seed. jobs: processes (None: one per core);
    scheduler: a Dask scheduler instead."""

    out: Path
    json_file: Path | None = None
    plant: Path | None = None
    plant_high: Path | None = None
    reading: str = "motor"
    markdown: Path | None = None
    rows: str | None = None
    quick: bool = False
    every: bool = False
    jobs: int | None = None
    scheduler: str | None = None


@dataclass(frozen=True, kw_only=True)
class ObjectiveOptions:
    """out: folder of table and JSON. compensation: a table of `schmidt calibrate`. starts: number of start
    angles, all moved by `shift`, degrees; seeds: taken in turn; seconds: of each run. only: rows whose name
    contains this. steps: the firmware's changes one after the other instead."""

    out: Path
    plant: str = LOW
    plant_high: str = HIGH
    compensation: Path | None = None
    starts: int = 8
    seeds: int = 3
    shift: float = 0.0
    seconds: float = 600.0
    only: str | None = None
    steps: bool = False
