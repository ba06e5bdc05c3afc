"""The table of rows: for the terminal and as Markdown."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from scenarios.paper.rows import Row


def figure(row: Row, value: float) -> str:
    """Return a value of the row's deciding figure with its unit."""
    if value != value:
        return "none"
    unit = row.decisive.unit
    return f"{value:.3g}" + ("" if unit == "1" else f" {unit}")


def show(rows: Sequence[Row], console: Console) -> None:
    """Print the table and, below it, what was found row by row."""
    table = Table(box=None, pad_edge=False, show_edge=False)
    for heading in ("", "experiment", "published", "decides", "median", "worst", ""):
        table.add_column(heading)
    for row in rows:
        mark = "[green]met[/]" if row.passed else "[red]miss[/]"
        limit = row.decisive
        middle, far = figure(row, row.median(limit.figure)), figure(row, row.worst(limit))
        title = row.experiment.title
        table.add_row(row.id, title, row.experiment.figure, limit.words, middle, far, mark)
    console.print(table)
    for row in rows:
        console.print(f"  [bold]{row.id}[/] {row.reason}", highlight=False)


def markdown(rows: Sequence[Row], plants: Sequence[str], command: str) -> str:
    """Return the table as a Markdown page."""
    met = sum(row.passed for row in rows)
    starts = max(len(row.found) + len(row.failed) for row in rows)
    lines = [
        f"{met} of {len(rows)} rows met together, by one drive and one controller, at every one of {starts} "
        f"starts; plants: {', '.join(plants)}.",
        f"Made by `{command}`; what each published sentence is held to is in [paper.md](paper.md). Median "
        "and worst are those of the figure that is missed by most, or met by least.",
        "",
        "| row | experiment | published | decides | median | worst | | found |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        said, limit = row.experiment, row.decisive
        verdict = "met" if row.passed else "**miss**"
        middle, far = (figure(row, value) for value in (row.median(limit.figure), row.worst(limit)))
        lines.append(
            f"| {row.id} | {said.title} ({said.where}) | {said.figure} | {limit.words} | {middle} | {far} | "
            f"{verdict} | {row.reason} |"
        )
    return "\n".join(lines) + "\n"
