"""The table of rows: for the terminal and as Markdown."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from scenarios.paper.published import PUBLISHED
from scenarios.paper.rows import Row

TITLES = {
    "E1": "15″/s, low preload",
    "E2": "15″/s, high preload",
    "E3": "closed loop, 600–1000″/s",
    "E4": "closed loop, 1–3°/s",
    "E5": "open loop, 600–1000″/s",
    "E6": "100″/s, open against closed",
    "E7": "torque–velocity map",
    "E8": "run-down, J",
    "E9": "linear model at 600″/s",
    "E10": "tuning rule",
}


def figure(row: Row) -> str:
    """Return the emulated figure with as many digits as it is worth."""
    value = row.emulated
    if abs(value) >= 1e5:
        return f"{value:.3g}"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def show(rows: Sequence[Row], console: Console) -> None:
    """Print the table, and below it what was found, row by row: terminals are narrow."""
    table = Table(title="The paper's experiments on the emulator")
    table.add_column("row", min_width=3)
    table.add_column("experiment")
    table.add_column("published")
    table.add_column("emulated", min_width=8)
    table.add_column("", min_width=4)
    for row in rows:
        said = PUBLISHED[row.id]
        mark = "[green]met[/]" if row.passed else "[red]miss[/]"
        table.add_row(row.id, TITLES[row.id], f"{said.figure}\n[dim]{said.unit}[/]", figure(row), mark)
    console.print(table)
    for row in rows:
        console.print(f"  [bold]{row.id}[/] {row.reason}", highlight=False)


def markdown(rows: Sequence[Row], plants: Sequence[str], command: str) -> str:
    """Return the table as a Markdown page."""
    met = sum(row.passed for row in rows)
    lines = [
        f"{met} of {len(rows)} rows met together, by one drive and one controller; plants: "
        f"{', '.join(plants)}.",
        f"Made by `{command}`; what each published sentence is held to is in [paper.md](paper.md).",
        "",
        "| row | experiment | published | emulated | | found |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        said = PUBLISHED[row.id]
        verdict = "met" if row.passed else "**miss**"
        lines.append(
            f"| {row.id} | {TITLES[row.id]} ({said.where}) | {said.figure} {said.unit} | {figure(row)} | "
            f"{verdict} "
            f"| {row.reason} |"
        )
    return "\n".join(lines) + "\n"
