"""The table of rows: for the terminal and as Markdown."""

from collections.abc import Sequence
from datetime import date

from rich.console import Console
from rich.table import Table

from scenarios.studies.paper.rows import Row


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
        said = row.experiment.said
        table.add_row(row.id, said.title, said.figure, limit.words, middle, far, mark)
    console.print(table)
    for row in rows:
        console.print(f"  [bold]{row.id}[/] {row.reason}", highlight=False)


_HEAD = """# The paper's experiments

    {command}

The command repeats E1 to E10 and five more sentences of the paper on the emulated boards. Made on {day}.
Plants: {plants}. Each row is measured at {starts} starts, and is met when every limit holds at every start.

**{met} of {rows} rows are met** together, by one drive and one controller. Median and worst are those of the
figure that is missed by most, or met by least. [Row by row](../reference/paper.md) says what each row is held
to, and why not all can be met.
"""


def _line(row: Row) -> str:
    said, limit = row.experiment.said, row.decisive
    verdict = "met" if row.passed else "**miss**"
    middle, far = (figure(row, value) for value in (row.median(limit.figure), row.worst(limit)))
    decides = f"{limit.words} ({limit.bounds})"
    title = f"{said.title} ({said.where})"
    return f"| {row.id} | {title} | {said.figure} | {decides} | {middle} | {far} | {verdict} |"


def _figures(row: Row) -> list[str]:
    """A line for each limit, and for each figure that is only printed beside them."""
    beside = (f"no limit: {each}" for each in row.beside)
    pieces = [*row.lines(False), *row.unevaluated, *row.lines(True), *beside]
    return [f"| {row.id} | {piece} |" for piece in pieces]


def markdown(rows: Sequence[Row], plants: Sequence[str], command: str, day: date) -> str:
    """Return the results as a Markdown page, what is missed first."""
    head = (
        "| row | experiment | published | decides (limit) | median | worst | |\n|---|---|---|---|---|---|---|"
    )
    missed, met = ([row for row in rows if row.passed is passed] for passed in (False, True))
    starts = max(len(row.found) + len(row.failed) for row in rows)
    facts = {"command": command, "day": day.isoformat(), "plants": ", ".join(plants), "starts": starts}
    lines = [_HEAD.format(**facts, met=len(met), rows=len(rows))]
    for title, those in (("Missed", missed), ("Met", met)):
        lines += [f"## {title}", head, *map(_line, those), ""]
    lines += ["## Every figure", "Median, worst, and the limit in brackets.\n"]
    lines += ["| row | figure |", "|---|---|", *(line for row in rows for line in _figures(row))]
    return "\n".join(lines) + "\n"
