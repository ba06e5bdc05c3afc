"""`schmidt paper`: run the rows, print published beside emulated, write JSON, plots and the table."""

import itertools
import json
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from time import monotonic
from typing import Any

from rich.console import Console

from host.logs.files import write_file
from plant.model import default_files, load
from plant.parts import PlantModel
from scenarios.progress import shown
from scenarios.studies.options import HIGH, LOW, PaperOptions
from scenarios.studies.paper.campaign import rows as run_rows
from scenarios.studies.paper.emulator import EmulatorBench
from scenarios.studies.paper.experiments import EXPERIMENTS, Experiment
from scenarios.studies.paper.figures import draw_all
from scenarios.studies.paper.record import record
from scenarios.studies.paper.rows import Row
from scenarios.studies.paper.starts import ALL, QUICK, STARTS, Benches, Start, others
from scenarios.studies.paper.table import markdown, show

DEFAULTS = {"low": LOW, "high": HIGH}


def pair(low: Path | None, high: Path | None) -> dict[str, str]:
    """Return the two plant files.

    One that is not named is the other's twin, "low" and "high" exchanged in its name. Where there is no twin,
    it is the project's own.
    """
    found = {"low": low, "high": high}
    names = {}
    for preload, other in (("low", "high"), ("high", "low")):
        given, partner = found[preload], found[other]
        if given is None and partner is not None:
            twin = partner.with_name(partner.name.replace(other, preload))
            given = twin if twin != partner and (twin.exists() or twin.stem in default_files()) else None
        names[preload] = str(given or DEFAULTS[preload])
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


def paper(options: PaperOptions) -> int:
    """Run the paper's experiments.

    Returns 0 when every row is met at every start, 1 when one is missed. Raises ValueError for a file that
    cannot be used.
    """
    console, out = Console(), options.out
    files = pair(options.plant, options.plant_high)
    plants: dict[str, PlantModel] = {preload: load(name) for preload, name in files.items()}
    chosen, starts = select(options.rows), QUICK if options.quick else ALL if options.every else STARTS
    starts = others(options.others) if options.others else starts
    write_file(out / ".probe", "")  # find out before minutes of work, not after
    (out / ".probe").unlink()
    begin = monotonic()
    with shown("experiments", len(chosen) * len(starts)) as tell:
        count = itertools.count(1)
        found = run_rows(
            plants,
            experiments=chosen,
            starts=starts,
            workers=options.jobs,
            scheduler=options.scheduler,
            progress=lambda text: tell(next(count), text),
        )
    seconds = monotonic() - begin
    show(found, console)
    document = json.dumps(as_json(found, files, seconds, starts), indent=2, ensure_ascii=False) + "\n"
    write_file(options.json_file or out / "paper.json", document)
    if options.rows is None:
        with console.status("figures"):
            drawn = draw_all(record(Benches(EmulatorBench, plants, STARTS[0])), out)
        for path in drawn:
            console.print(f"  {path}")
    command = f"schmidt paper --others {options.others}" if options.others else "schmidt paper"
    table = markdown(found, names_of(files), command, date.today())
    write_file(out / "experiments.md", table)
    if options.markdown is not None:
        write_file(options.markdown, table)
    met = sum(row.passed for row in found)
    where = f"at {len(starts)} starts" + (" (eight decide: leave --quick out)" if options.quick else "")
    console.print(f"{met} of {len(found)} rows met {where}, {seconds:.0f} s")
    return 0 if met == len(found) else 1
