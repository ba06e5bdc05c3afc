"""`schmidt objective`: the paper's objective on the emulated boards, from many starts."""

import dataclasses
import itertools
import json
import shlex

from rich.console import Console

from host.logs.files import write_file
from plant.model import load
from plant.wind import wind
from scenarios.language.configure import load_compensation
from scenarios.progress import shown
from scenarios.studies.objective import cases as table
from scenarios.studies.objective.bench import MODES
from scenarios.studies.objective.bound import bound
from scenarios.studies.options import ObjectiveOptions


def objective(options: ObjectiveOptions) -> int:
    """Print the table, write objective.json and one-arcsecond.md into `out`.

    Returns 0 when every judged row is met and, in wind, no run is worse than with the paper's firmware.

    Raises ValueError for what cannot be used.
    """
    console, out = Console(), options.out
    rows_of = table.ladder() if options.steps else table.cases(options.compensation is not None)
    chosen = [case for case in rows_of if options.only is None or options.only in case.name]
    if not chosen:
        names = "; ".join(case.name for case in rows_of)
        raise ValueError(f"--only {options.only}: no row's name contains this; the rows are: {names}")
    plants = load(options.plant), load(options.plant_high)
    given = options.compensation
    loaded = [] if given is None else load_compensation(given).parameters()
    out.mkdir(parents=True, exist_ok=True)
    rows: list[table.Row] = []
    console.print(table.HEADINGS, highlight=False, soft_wrap=True)
    with shown("holds", len(chosen) * len(MODES) * options.starts * options.seeds) as show:
        count = itertools.count(1)
        for row in table.measure(chosen, plants, loaded, options, lambda text: show(next(count), text)):
            rows.append(row)
            console.print(table.line(row), highlight=False, soft_wrap=True)
    bounds = {
        case.name: bound(case.plant(*plants), wind(case.wind_m_s))
        for case in chosen
        if case.wind_m_s and case.firmware != "paper"
    }
    for each in bounds.items():
        console.print(table.bound_line(*each), highlight=False, soft_wrap=True)
    ratios = table.over_paper(rows)
    for name, ratio in ratios.items():
        console.print(f"{name}: {ratio:.3f} of what {table.PAPER} leaves", highlight=False, soft_wrap=True)
    command = shlex.join(["schmidt", "objective", *_given(options)])
    write_file(out / "one-arcsecond.md", table.markdown(rows, command, bounds))
    angles = table.starts(options.shift, options.starts)
    data = {
        "command": command, "starts_deg": angles, "rows": [row.as_json() for row in rows],
        "bounds": {name: each._asdict() for name, each in bounds.items()}, "over_paper": ratios,
    }  # fmt: skip
    write_file(out / "objective.json", json.dumps(data, indent=1) + "\n")
    return 0 if all(row.passed for row in rows) and all(ratio <= 1 for ratio in ratios.values()) else 1


def _given(options: ObjectiveOptions) -> list[str]:
    """The command line that says so again: what is not as it is by itself."""
    words = []
    for field in dataclasses.fields(options):
        value = getattr(options, field.name)
        if field.name != "out" and value != field.default:
            text = f"{value:g}" if isinstance(value, int | float) else str(value)
            words += [f"--{field.name.replace('_', '-')}", *([] if value is True else [text])]
    return words
