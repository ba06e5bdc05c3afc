"""The verdict on the terminal: one line, a table of effects and errors, what to do next."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from calibration.decide.verdict import ROWS
from calibration.finding import UNKNOWN
from calibration.report.htmlpage import size, summary

WIDE = 140
"""Columns of a line that is no terminal's: a file or a pipe has no width. ASSUMPTION: the table fits."""


def show(data: dict[str, Any], remarks: Sequence[str], out: Path) -> None:
    """Print report.json's `data` and the remarks that no reader should miss; `out` is the report's folder."""
    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = WIDE
    steps = [f"! {r}" for r in remarks]
    if data["verdict"] == "cannot tell":
        steps += [f"It lacks: {one}" for one in data["separating_experiment"].split("; ")]
    elif data["separating_experiment"]:
        steps.append(f"Next, to be sure: {data['separating_experiment']}")
    elif data["effects"] and (plant := out / "plant.yaml").exists():
        steps.append(f"Next: run the corrected drive, schmidt run SCENARIO --plant {plant}")
    console.print(f"{data['verdict']}: {summary(data).partition(' It lacks:')[0]}", soft_wrap=True)
    if data["effects"] or data["error"]:
        console.print(_table(data))
    console.print("\n".join([*steps, f"Report: {out / 'report.html'}"]), soft_wrap=True)


def _table(data: dict[str, Any]) -> Table:
    """A row per effect with the held-out error of its balance; balances without an effect follow."""
    table = Table("effect", "where", "size (95 % interval)", "held-out error", box=None, pad_edge=False)
    for name in ("before", "after", "floor"):
        table.add_column(name, justify="right")
    rest = dict(data["error"])
    seen: list[list[str]] = []
    for e in data["effects"]:
        row = ROWS.get(e["channel"], "")
        rest.pop(row, None)
        cells = [e["name"], _where(e), _size(e), *_error(row, data["error"].get(row))]
        if cells not in seen:  # two functions of one domain read alike
            seen.append(cells)
            table.add_row(*cells)
    for row, error in rest.items():
        table.add_row("(no effect)", "", "", *_error(row, error))
    return table


def _where(effect: dict[str, Any]) -> str:
    """Its stage and harmonic; of a line that no stage has, its order or its frequency; or a domain alone."""
    words = [effect["stage"] or "", f"harmonic {effect['harmonic']}" if effect["harmonic"] else ""]
    if not effect["stage"] and effect["order"]:
        words = [f"order {effect['order']:.4g}"]
    if effect["name"] == UNKNOWN and effect["domain"]:
        words.append(f"over {effect['domain'].replace('_', ' ')}")
    hertz = [f"{effect['frequency_Hz']:.4g} Hz"] if effect["frequency_Hz"] else []
    return ", ".join(filter(None, [*words, *hertz]))


def _size(effect: dict[str, Any]) -> str:
    """Its main parameter with the interval, where one was computed, and what further harmonics have."""
    name, unit, p = next(iter(size(effect)), ("", "", {}))
    if not p:
        return ""
    interval = f" ({p['low']:.4g} to {p['high']:.4g})" if p.get("low") is not None else ""
    numbered = {key.removeprefix("amplitude_"): other["value"] for key, other in effect["parameters"].items()}
    further = (f"; harmonic {at} {x:.4g}" for at, x in numbered.items() if at.isdigit())
    return f"{name} {p['value']:.4g}{interval} {unit}".rstrip() + "".join(further)


def _error(row: str, error: dict[str, Any] | None) -> list[str]:
    """Balance with its unit, and the three errors."""
    if error is None:
        return []
    numbers = (error["before"], error["after"], error["floor"])
    return [f"{row}, {error['unit']}", *("not known" if x is None else f"{x:.4g}" for x in numbers)]
