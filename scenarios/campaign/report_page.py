"""`report.html` of a campaign, its figures beside it, and the scenario of its worst run."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from host.logs.files import write_file
from scenarios.campaign import figures, table
from scenarios.campaign.figures import Columns, Influence, influence, numbers, share
from scenarios.campaign.plan import Plan
from scenarios.lab.prepare import load
from scenarios.language.document import Document
from scenarios.run.evaluate import KINDS
from scenarios.run.report.html import picture, rendered

_QUANTILES = (0.05, 0.5, 0.95)
WORST = "worst.yaml"


def write(plan: Plan, folder: Path, wall_s: float, made: int) -> None:
    """Draw and write everything from the table. wall_s, made: of this call, for the figures of speed."""
    columns = table.read(folder / table.TABLE)
    limits, units = _expected(plan)
    metrics = [name for name in columns if name.startswith("metric: ")]
    found = _influences(plan, columns, metrics)
    groups = _groups(plan, columns)
    drawn = {
        "distributions": figures.distributions(columns, metrics, limits, units),
        "influences": figures.influences(found, [f"input: {each.name}" for each in plan.inputs]),
        "failures": figures.failures(columns, groups),
    }
    pictures = [
        picture(figure, folder / f"{name}.png") for name, figure in drawn.items() if figure is not None
    ]
    worst = _worst(plan, columns, limits)
    if worst:
        _write_worst(plan, worst["index"], folder / WORST)
    passed = sum(map(bool, columns["passed"]))
    text = rendered(
        Path(__file__).with_name("page.html.j2"),
        plan=plan,
        runs=len(columns["key"]),
        passed=share(passed, len(columns["key"])),
        silent=sum(bool(each) for each in columns.get("silent_faults", [])),
        metrics=[_summary(columns, name, limits, units) for name in metrics],
        pictures=pictures,
        worst=worst,
        repeat=f"schmidt run {folder / WORST}",
        failures=Counter(filter(None, columns["failure"])).most_common(20),
        speed=_speed(columns, wall_s, made),
    )
    write_file(folder / "report.html", text)


def _expected(plan: Plan) -> tuple[dict[str, tuple[float, bool]], dict[str, str]]:
    """Limit of each expectation, and what it is measured in; no unit for a bare number."""
    data = {word: value for word, value in plan.base.items() if word != "_folder"}
    expected = load(Document(plan.scenario, data, {})).expectations
    units = {e.name: KINDS[e.kind].unit for e in expected}
    return (
        {e.name: (e.limit, e.upper) for e in expected},
        {name: unit for name, unit in units.items() if unit != "1"},
    )


def _influences(plan: Plan, columns: Columns, metrics: list[str]) -> list[Influence]:
    found = []
    for each in plan.inputs:
        name = f"input: {each.name}"
        if each.numeric and name in columns:
            x = numbers(columns, name)
            found += [influence(name, x, metric, numbers(columns, metric)) for metric in metrics]
    return [each for each in found if each is not None]


def _groups(plan: Plan, columns: Columns) -> dict[str, list[int]]:
    """Runs by the value of the first input that is no number; else all in one."""
    for each in plan.inputs:
        name = f"input: {each.name}"
        if not each.numeric and name in columns:
            values = columns[name]
            return {str(v): [k for k, w in enumerate(values) if w == v] for v in dict.fromkeys(values)}
    return {"all runs": list(range(len(columns["key"])))}


def _worst(plan: Plan, columns: Columns, limits: dict[str, tuple[float, bool]]) -> dict[str, Any] | None:
    """The run that misses most expectations; among equals the one furthest over its limits."""
    count = len(columns["key"])
    over = np.zeros(count)
    for name, (limit, upper) in limits.items():
        if f"metric: {name}" in columns and limit:
            ratio = numbers(columns, f"metric: {name}") / limit
            over = np.fmax(over, np.nan_to_num(ratio if upper else 2.0 - ratio, nan=0.0))
    missed = [len([w for w in str(each or "").split("; ") if w]) for each in columns["missed"]]
    failed = [bool(each) for each in columns["failure"]]
    order = [k for k in range(count) if columns["index"][k] >= 0]
    if not order:
        return None
    worst = max(order, key=lambda k: (failed[k], missed[k], over[k]))
    inputs = {each.name: columns[f"input: {each.name}"][worst] for each in plan.inputs}
    return {
        "index": columns["index"][worst],
        "key": columns["key"][worst],
        "digest": (columns.get("digest") or [""] * count)[worst],
        "missed": columns["missed"][worst] or "",
        "failure": columns["failure"][worst] or "",
        "inputs": inputs,
    }


def _write_worst(plan: Plan, index: int, path: Path) -> None:
    """The scenario of one run as a file that runs alone, from anywhere."""
    import yaml

    case = plan.case(index)
    document = dict(case.document)
    plant = document.get("plant")
    name = plant.get("file") if isinstance(plant, dict) else plant
    beside = plan.scenario.parent.resolve() / str(name)
    if name and beside.is_file():
        document["plant"] = {**plant, "file": str(beside)} if isinstance(plant, dict) else str(beside)
    head = f"# run {index} of the campaign {plan.name}, {case.key}\n"
    write_file(path, head + yaml.safe_dump(document, sort_keys=False, allow_unicode=True))


def _summary(
    columns: Columns, name: str, limits: dict[str, tuple[float, bool]], units: dict[str, str]
) -> dict[str, Any]:
    values = numbers(columns, name)
    good = values[np.isfinite(values)]
    short = name.removeprefix("metric: ")
    row: dict[str, Any] = {"name": short, "unit": units.get(short, ""), "runs": len(good)}
    if len(good):
        row["quantiles"] = [f"{q:.4g}" for q in np.quantile(good, _QUANTILES)]
        row["largest"] = f"{good.max():.4g}"
    if short in limits:
        limit, upper = limits[short]
        row["limit"] = f"{'≤' if upper else '≥'} {limit:g}"
        hits = int(np.sum(good > limit if upper else good < limit))
        row["missed"] = "{:.1%} ({:.1%}–{:.1%})".format(*share(hits, len(good)))
    return row


def _speed(columns: Columns, wall_s: float, made: int) -> dict[str, Any]:
    def known(name: str) -> Any:  # a table that is resumed may be of an older program
        return numbers(columns, name) if name in columns else np.zeros(1)

    return {
        "wall_s": wall_s,
        "made": made,
        "cpu_s": float(np.nanmedian(known("cpu_s"))),
        "simulated_h": float(np.nansum(known("simulated_s"))) / 3600.0,
        "machines": sorted({str(each) for each in columns.get("machine", []) if each}),
        "compiled": sum(map(bool, columns.get("compiled", []))),
    }
