"""`schmidt objective`: the paper's objective on the emulated boards, from many starts."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from plant.model import load
from scenarios import compensation as compensations
from scenarios.objective.bench import MODES
from scenarios.objective.cases import cases, ladder, starts
from scenarios.objective.table import HEADINGS, Row, line, markdown, measure

LOW, HIGH = "low_preload_motor_units", "high_preload_motor_units"


def objective(
    out: Path,
    plant: str = LOW,
    plant_high: str = HIGH,
    compensation: Path | None = None,
    count: int = 8,
    seeds: int = 3,
    shift_deg: float = 0.0,
    seconds: float = 600.0,
    only: str | None = None,
    steps: bool = False,
) -> int:
    """Print the table, write objective.json and table.md into `out`; 0 when every judged row is met.

    steps: the firmware's changes one after the other instead. only: rows whose name contains this. Raises
    ValueError for what cannot be used.
    """
    console = Console()
    rows_of = ladder() if steps else cases(compensation is not None)
    chosen = [case for case in rows_of if only is None or only in case.name]
    if not chosen:
        raise ValueError(f"--only {only}: no row is called so")
    plants = load(plant), load(plant_high)
    table = [] if compensation is None else compensations.load(compensation).parameters()
    angles = starts(shift_deg, count)
    out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    console.print(_aligned(HEADINGS), highlight=False, soft_wrap=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=len(chosen) * len(MODES) * count * seeds)

        def tell(text: str) -> None:
            bar.update(task, description=text, advance=1)

        for row in measure(chosen, plants, angles, list(range(1, seeds + 1)), seconds, table, tell):
            rows.append(row)
            console.print(_aligned(line(row)), highlight=False, soft_wrap=True)
    command = shlex.join(
        [
            "schmidt", "objective",
            *_given(compensation, count, seeds, shift_deg, seconds, steps),
            *_chosen(plant, plant_high, only),
        ]
    )  # fmt: skip
    (out / "table.md").write_text(markdown(rows, command), encoding="utf-8")
    data = {"command": command, "starts_deg": angles, "rows": [row.as_json() for row in rows]}
    (out / "objective.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return 0 if all(row.passed for row in rows) else 1


def _aligned(cells: tuple[str, ...]) -> str:
    return f"{cells[0]:46}{cells[1]:6}" + "".join(f"{cell:>13}" for cell in cells[2:7]) + "  " + cells[7]


def _given(
    compensation: Path | None, count: int, seeds: int, shift_deg: float, seconds: float, steps: bool
) -> list[str]:
    words = ["--steps"] if steps else []
    words += [] if compensation is None else ["--compensation", str(compensation)]
    for name, value, default in (
        ("--starts", count, 8), ("--seeds", seeds, 3), ("--shift", shift_deg, 0.0),
        ("--seconds", seconds, 600.0),
    ):  # fmt: skip
        words += [] if value == default else [name, f"{value:g}"]
    return words


def _chosen(plant: str, plant_high: str, only: str | None) -> list[str]:
    words = []
    for name, value, default in (
        ("--plant", plant, LOW), ("--plant-high", plant_high, HIGH), ("--only", only, None),
    ):  # fmt: skip
        words += [] if value is None or value == default else [name, value]
    return words
