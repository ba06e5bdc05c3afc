"""Options of `schmidt paper` and `schmidt objective`. Light: the command line imports it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from scenarios.options import PATH, Number, jobs_option, option, scheduler_option

LOW, HIGH = "low_preload_bridge", "high_preload_bridge"
"""The drive that both tables are published for: what of the rows it meets is in docs/reference/paper.md."""


def _plant(preload: str, default: str) -> Any:
    return option(f"Plant with {preload} preload: a file or a name.", default=default)


@dataclass(frozen=True, kw_only=True)
class PaperOptions:
    """Of `schmidt paper`. json_file: None: in `out`, beside the table."""

    json_file: Path | None = option("Write the rows to this file.", "--json", type=PATH)
    out: Path = option(type=PATH, default=Path("out/paper"))
    plant: str = _plant("low", LOW)
    plant_high: str = _plant("high", HIGH)
    rows: str | None = option("These rows only, by their names.", metavar="E1,E2,...")
    quick: bool = option("Two starts instead of eight; decides nothing.", default=False, is_flag=True)
    others: int = option("Starts and seeds that no search used.", default=0, type=click.IntRange(0, 1000))
    vary: float = option("J, K, R, Tc, Ts off by so many percent, in turn.", default=0.0, type=Number(0, 50))
    jobs: int | None = jobs_option()
    scheduler: str | None = scheduler_option()


@dataclass(frozen=True, kw_only=True)
class ObjectiveOptions:
    """Of `schmidt objective`."""

    out: Path = option(type=PATH, default=Path("out/objective"))
    plant: str = _plant("low", LOW)
    plant_high: str = _plant("high", HIGH)
    compensation: Path | None = option("A compensation.yaml of schmidt calibrate.", type=PATH)
    starts: int = option("Number of start angles.", default=8, type=click.IntRange(1, 64))
    seeds: int = option("Seeds, taken in turn.", default=3, type=click.IntRange(1, 16))
    shift: float = option("Added to all start angles, degrees.", default=0.0, type=Number(-360, 360))
    seconds: float = option("Length of each run.", default=600.0, type=Number(1, 1e6))
    only: str | None = option("Only rows whose name contains this.")
    steps: bool = option("The firmware's changes one after the other instead.", default=False, is_flag=True)
