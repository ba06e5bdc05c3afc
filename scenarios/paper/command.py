"""`schmidt paper`: run E1 to E10, print published beside emulated, write JSON, plots and the table."""

import json
from pathlib import Path
from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from plant.model import default_files, load
from plant.parts import PlantModel
from scenarios.paper.bench import Bench
from scenarios.paper.campaign import Campaign
from scenarios.paper.emulator import EmulatorBench
from scenarios.paper.figures import draw_all
from scenarios.paper.rows import Row
from scenarios.paper.table import markdown, show

DEFAULTS = {"low": "low_preload_motor_units", "high": "high_preload_motor_units"}
"""The pair of plant files that meets the rows together (docs/paper.md); the pair as printed is `low_preload`,
`high_preload`."""
STEPS = 59
"""Progress reports of a whole campaign, for the bar's length."""
SEED = 1


def pair(low: Path | None, high: Path | None) -> dict[str, str]:
    """Return the two plant files. One that is not named is the other's twin, "low" and "high" exchanged in
    its name, where there is one, and otherwise the default."""
    found = {"low": low, "high": high}
    names = {}
    for preload, other in (("low", "high"), ("high", "low")):
        given, partner = found[preload], found[other]
        if given is None and partner is not None:
            twin = partner.with_name(partner.name.replace(other, preload))
            given = twin if twin != partner and (twin.exists() or twin.stem in default_files()) else None
        names[preload] = str(given or DEFAULTS[preload])
    return names


def run_rows(
    plants: dict[str, PlantModel], progress: Any = None, seed: int = SEED
) -> tuple[list[Row], Campaign]:
    """Run all experiments on the emulator; `progress(text)` is called before each part. Returns rows and
    records."""

    def bench(preload: str, gains: tuple[float, float] | None = None) -> Bench:
        return EmulatorBench(plants[preload], seed, gains)

    campaign = Campaign(bench, plants, progress or (lambda text: None))
    return campaign.rows(), campaign


def as_json(rows: list[Row], plants: dict[str, str], seconds: float) -> dict[str, Any]:
    """Return what `--json` writes."""
    return {
        "plant": plants["low"],
        "plants": plants,
        "seed": SEED,
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
) -> int:
    """Run the paper's experiments.

    json_path: where the JSON goes. out: folder for plots (and the JSON, when none is named). plant,
    plant_high: plant files for low and high preload instead of the project's own. Returns 0 when every row
    is met, 1 when one is missed. Raises ValueError for a file that cannot be used.
    """
    console = console or Console()
    names = pair(plant, plant_high)
    plants = {preload: load(name) for preload, name in names.items()}
    if out is not None:
        _write(out / ".probe", "")  # find out before minutes of work, not after
        (out / ".probe").unlink()
    begin = monotonic()
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=STEPS)

        def report(text: str) -> None:
            bar.update(task, description=text, advance=1)

        rows, campaign = run_rows(plants, report)
    seconds = monotonic() - begin
    show(rows, console)
    document = json.dumps(as_json(rows, names, seconds), indent=2, ensure_ascii=False) + "\n"
    if json_path is not None:
        _write(json_path, document)
    if out is not None:
        if json_path is None:
            _write(out / "paper.json", document)
        for path in draw_all(campaign.record, out):
            console.print(f"  {path}")
        _write(out / "table.md", markdown(rows, list(names.values()), "schmidt paper"))
    if markdown_path is not None:
        _write(markdown_path, markdown(rows, list(names.values()), "schmidt paper"))
    met = sum(row.passed for row in rows)
    console.print(f"{met} of {len(rows)} rows met, {seconds:.0f} s")
    return 0 if met == len(rows) else 1
