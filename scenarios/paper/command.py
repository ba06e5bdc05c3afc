"""`schmidt paper`: run the rows, print published beside emulated, write JSON, plots and the table."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
)

from plant.model import default_files, load
from plant.parts import PlantModel
from scenarios.paper.campaign import rows as run_rows
from scenarios.paper.emulator import EmulatorBench
from scenarios.paper.experiments import EXPERIMENTS, Experiment
from scenarios.paper.figures import draw_all
from scenarios.paper.record import record
from scenarios.paper.rows import Row
from scenarios.paper.starts import ALL, QUICK, STARTS, Benches, Start
from scenarios.paper.table import markdown, show

DEFAULTS = {"low": "low_preload_bridge", "high": "high_preload_bridge"}
"""The pair of plant files that is fitted to the rows with freewheel diodes: what it meets and misses is in
docs/paper.md. The pair as printed is `low_preload`, `high_preload`."""

_PRINTED = Path(__file__).with_name("printed")
READINGS = {
    "motor": DEFAULTS,
    "printed": {preload: str(_PRINTED / f"{preload}_preload_fitted.yaml") for preload in ("low", "high")},
}
"""Table 2's Tc and Ts as N mm at the motor, or as printed, N m at the axis (hardware.md 2.3): the best pair
known in each."""


def pair(low: Path | None, high: Path | None, reading: str = "motor") -> dict[str, str]:
    """Return the two plant files. One that is not named is the other's twin, "low" and "high" exchanged in
    its name, where there is one, and otherwise the one of the reading."""
    found = {"low": low, "high": high}
    names = {}
    for preload, other in (("low", "high"), ("high", "low")):
        given, partner = found[preload], found[other]
        if given is None and partner is not None:
            twin = partner.with_name(partner.name.replace(other, preload))
            given = twin if twin != partner and (twin.exists() or twin.stem in default_files()) else None
        names[preload] = str(given or READINGS[reading][preload])
    return names


def names_of(files: Mapping[str, str]) -> list[str]:
    """Return plant files as a table names them: without the folder they happen to lie in."""
    return [Path(name).stem if name.endswith(".yaml") else name for name in files.values()]


def select(names: str | None) -> list[Experiment]:
    """Return the experiments named by a comma-separated list; all without one. Raises ValueError."""
    if names is None:
        return list(EXPERIMENTS)
    wanted = [name.strip().upper() for name in names.split(",") if name.strip()]
    known = {row.id: row for row in EXPERIMENTS}
    strange = [name for name in wanted if name not in known]
    if strange or not wanted:
        raise ValueError(f"--rows: '{', '.join(strange) or names}' is no row; there are {', '.join(known)}")
    return [row for row in EXPERIMENTS if row.id in wanted]


def as_json(
    rows: Sequence[Row], plants: Mapping[str, str], seconds: float, starts: Sequence[Start]
) -> dict[str, Any]:
    """Return what `--json` writes."""
    return {
        "plant": plants["low"],
        "plants": dict(plants),
        "starts": [{"angle_deg": start.angle_deg, "seed": start.seed} for start in starts],
        "wall_s": round(seconds, 1),
        "rows": [row.as_json() for row in rows],
    }


def _write(path: Path, text: str) -> None:
    """Write a file of the user's; raises ValueError with the reason when that cannot be done."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror}") from None


def paper(
    json_path: Path | None = None,
    out: Path | None = None,
    plant: Path | None = None,
    plant_high: Path | None = None,
    markdown_path: Path | None = None,
    console: Console | None = None,
    names: str | None = None,
    quick: bool = False,
    every: bool = False,
    jobs: int | None = None,
    scheduler: str | None = None,
    reading: str = "motor",
) -> int:
    """Run the paper's experiments.

    json_path: where the JSON goes. out: folder for plots (and the JSON, when none is named). plant,
    plant_high: plant files for low and high preload instead of the project's own. names: rows,
    comma-separated. quick: two starts only, for a look; every: all 24 combinations of angle and seed. jobs:
    processes (None: one per core); scheduler: a Dask scheduler instead. reading: of Table 2's units,
    "motor" or "printed", when no plant file is named. Returns 0 when every row is met at
    every start, 1 when one is missed. Raises ValueError for a file that cannot be
    used.
    """
    console = console or Console()
    files = pair(plant, plant_high, reading)
    plants: dict[str, PlantModel] = {preload: load(name) for preload, name in files.items()}
    chosen, starts = select(names), QUICK if quick else ALL if every else STARTS
    if out is not None:
        _write(out / ".probe", "")  # find out before minutes of work, not after
        (out / ".probe").unlink()
    begin = monotonic()
    columns = (
        SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
        TimeElapsedColumn(),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=len(chosen) * len(starts))

        def report(text: str) -> None:
            bar.update(task, description=text, advance=1)

        found = run_rows(
            plants, experiments=chosen, starts=starts, workers=jobs, scheduler=scheduler, progress=report
        )
    seconds = monotonic() - begin
    show(found, console)
    document = json.dumps(as_json(found, files, seconds, starts), indent=2, ensure_ascii=False) + "\n"
    if json_path is not None:
        _write(json_path, document)
    if out is not None:
        if json_path is None:
            _write(out / "paper.json", document)
        if names is None:
            with console.status("figures"):
                drawn = draw_all(record(Benches(EmulatorBench, plants, STARTS[0])), out)
            for path in drawn:
                console.print(f"  {path}")
        _write(
            out / "table.md",
            markdown(
                found,
                names_of(files),
                "schmidt paper" + ("" if reading == "motor" else f" --reading {reading}"),
            ),
        )
    if markdown_path is not None:
        _write(
            markdown_path,
            markdown(
                found,
                names_of(files),
                "schmidt paper" + ("" if reading == "motor" else f" --reading {reading}"),
            ),
        )
    met = sum(row.passed for row in found)
    where = f"at {len(starts)} starts" + (" (eight decide: leave --quick out)" if quick else "")
    console.print(f"{met} of {len(found)} rows met {where}, {seconds:.0f} s")
    return 0 if met == len(found) else 1
