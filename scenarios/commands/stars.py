"""`schmidt calibrate STARS`: a pointing run in, the terms it lacks and a model out."""

import json
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from host.logs.files import write_file
from host.sky.pointfind import Answer, Lack, find
from host.sky.pointmodel import GEOMETRY, TERMS, TEXTS
from host.sky.pointread import read
from scenarios.run.report.pointing_run import residuals

_WIDE = 120
"""Columns where there is no terminal. ASSUMPTION: the table fits."""


def calibrate_stars(path: Path, terms: str | None, out: Path) -> int:
    """Write report.json, pointing-model.json and pointing-run.png into `out`, and tell what is missing.

    terms: names of the declared ones, with commas; None: those of geometry. Raises ValueError, a line.
    """
    declared = GEOMETRY if terms is None else tuple(each.strip() for each in terms.split(","))
    for name in declared:
        if name not in TERMS:
            raise ValueError(f"--terms: no term is called {name!r}; there are {', '.join(TERMS)}")
    stars = read(path)
    answer = find(stars, declared)
    write_file(out / "report.json", json.dumps(report(answer, declared), indent=1) + "\n")
    answer.model.save(out / "pointing-model.json")
    residuals(stars, answer.model).savefig(out / "pointing-run.png")
    _show(answer, declared, out)
    return 0


def report(answer: Answer, declared: tuple[str, ...]) -> dict[str, Any]:
    """The fields of report.json (docs/sources/log-format.md) that a pointing run has."""
    error = {"unit": "arcsec", "before": answer.before_arcsec, "after": answer.after_arcsec, "floor": None}
    return {
        "verdict": answer.verdict,
        "effects": [_effect(each) for each in answer.lacks],
        "error": {"pointing": error},
        "calibrated": {
            each.name: _value(each.arcsec, each.within_arcsec)
            for each in answer.model.terms
            if each.name in declared
        },
        "not_identifiable": list(answer.confounded),
        "unseen_below": {
            name: {"value": each, "unit": "arcsec"} for name, each in answer.unseen_arcsec.items()
        },
    }  # fmt: skip


def _effect(lack: Lack) -> dict[str, Any]:
    size = _value(lack.arcsec, lack.within_arcsec)
    return {
        "name": lack.name,
        "equivalent": list(lack.equivalent),
        "domain": lack.over,
        "parameters": {"rms" if lack.within_arcsec is None else "coefficient": size},
    }


def _value(value: float, within: float | None) -> dict[str, Any]:
    low, high = (None, None) if within is None else (value - within, value + within)
    return {"value": value, "unit": "arcsec", "low": low, "high": high}


def _show(answer: Answer, declared: tuple[str, ...], out: Path) -> None:
    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = _WIDE
    errors = f"{answer.before_arcsec:.2f}″ before, {answer.after_arcsec:.2f}″ after, on stars held out"
    missing = [
        " or ".join((each.name, *each.equivalent)) if each.over is None else f"something over the {each.over}"
        for each in answer.lacks
    ]
    names = " and ".join(missing) or "no term is missing"
    console.print(f"{answer.verdict}: {names}; {errors}", soft_wrap=True)
    table = Table("term", "what", "size (95 % interval)", box=None, pad_edge=False)
    for each in answer.model.terms:
        mark = "" if each.name in declared else " (missing)"
        table.add_row(each.name + mark, TEXTS[each.name], f"{each.arcsec:+.1f}″ ± {each.within_arcsec:.1f}″")
    for lack in answer.lacks:
        if lack.over is not None:
            table.add_row("unknown", f"over the {lack.over}", f"{lack.arcsec:.1f}″ rms")
    console.print(table)
    if answer.unseen_arcsec:
        least = ", ".join(f"{name} {each:.1f}″" for name, each in answer.unseen_arcsec.items())
        console.print(f"Not seen, and smaller than: {least}", soft_wrap=True)
    if answer.confounded:
        console.print(
            f"These stars cannot tell from the others: {', '.join(answer.confounded)}", soft_wrap=True
        )
    console.print(
        f"Next: mount: {{pointing_model: {out / 'pointing-model.json'}}} in a scenario", soft_wrap=True
    )
