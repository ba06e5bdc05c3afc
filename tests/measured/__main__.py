"""`python -m tests.measured [KEY…] --out DIR`: every measured log answered, and judged by what is in it.

`--page FILE` writes docs/results/measured-drives.md from the answers; `--again` takes those that are in DIR.
"""

import contextlib
import io
import json
import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from datetime import date
from pathlib import Path
from typing import Any

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from calibration.command import calibrate
from scenarios.progress import shown
from tests.measured.cases import CASES, DATA
from tests.measured.page import page
from tests.measured.truth import WRONG, Answer, judge, say

ANSWER = "answer.json"
"""Beside a log's report."""


def answer(key: str, out: Path) -> Answer:
    """Calibrate and judge; a process of its own finds the case by its key."""
    case = next(c for c in CASES if c.key == key)
    folder, begun = out / key, time.process_time()
    with contextlib.redirect_stdout(io.StringIO()):
        calibrate(case.logs, case.rig, list(case.hold_out), folder, plots=False, replay=False)
    seconds = time.process_time() - begun
    data: dict[str, Any] = json.loads((folder / "report.json").read_text())
    judged, why = judge(data, case.needs, case.may)
    row: dict[str, Any] = next((r for k, r in data["error"].items() if k in ("torque", "position")), {})
    own = case.own(case.logs, case.rig) if case.own and row else np.nan
    figures = {k: float("nan") if row.get(k) is None else float(row[k]) for k in ("before", "after", "floor")}
    found = Answer(
        key=key,
        verdict=str(data["verdict"]),
        judged=judged,
        why=why,
        unit=str(row.get("unit", "")),
        own=own,
        seconds=seconds,
        effects=tuple(say(e) for e in data["effects"]),
        experiment=str(data["separating_experiment"] or ""),
        **figures,
    )
    (folder / ANSWER).write_text(json.dumps(asdict(found), indent=1) + "\n", encoding="utf-8")
    return found


def kept(key: str, out: Path) -> Answer | None:
    """The answer that a run before left in `out`, or None."""
    file = out / key / ANSWER
    if not file.exists():
        return None
    fields: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return Answer(**fields | {"effects": tuple(fields["effects"])})


@click.command()
@click.argument("keys", nargs=-1)
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/measured"))
@click.option("--jobs", default=1)
@click.option("--page", "file", type=click.Path(path_type=Path), help="Page of results to write.")
@click.option("--again", is_flag=True, help="Ask only what a run before left open in the folder.")
def main(keys: tuple[str, ...], out: Path, jobs: int, file: Path | None, again: bool) -> None:
    """Print the table."""
    if not DATA.is_dir():
        raise click.ClickException("../shared/data/measured is absent: no measured data to answer")
    if file and keys:
        raise click.UsageError("a page is of all logs; leave the keys out")
    os.environ["OMP_NUM_THREADS"] = "1"
    wanted = [c.key for c in CASES if not keys or any(c.key.startswith(k) for k in keys)]
    rows = {key: row for key in wanted if again and (row := kept(key, out))}
    open_ = [key for key in wanted if key not in rows]
    with ProcessPoolExecutor(jobs) as pool, shown("measured logs", len(open_)) as show_left:
        for done, row in enumerate(pool.map(answer, open_, [out] * len(open_)), start=1):
            rows[row.key] = row
            click.echo(f"{row.key}: {row.judged} in {row.seconds:.0f} s", err=True)
            show_left(done, f"{done} of {len(open_)}")
    ordered = [rows[key] for key in wanted]
    show(ordered)
    if file:
        file.write_text(page(ordered, date.today()), encoding="utf-8")


def show(rows: list[Answer]) -> None:
    """The table, the counts, and the median of the held-out error over one's own least squares."""
    table = Table("log", "verdict", "judged", "before", "after", "floor", "own", "s", "said", "against")
    for a in rows:
        figures = (f"{x:.3g}" for x in (a.before, a.after, a.floor, a.own))
        table.add_row(a.key, a.verdict, a.judged, *figures, f"{a.seconds:.0f}", a.said, a.why)
    console = Console(width=200)
    console.print(table)
    counts = {k: sum(a.judged == k for a in rows) for k in dict.fromkeys(a.judged for a in rows)}
    sure = sum(a.judged == WRONG and a.verdict == "found" for a in rows)
    ratio = [a.after / a.own for a in rows if np.isfinite(a.own) and np.isfinite(a.after)]
    over = f"held-out over own: {np.median(ratio):.2f}" if ratio else ""
    console.print(f"{counts} of {len(rows)}; wrong with found: {sure}; {over}")


if __name__ == "__main__":
    main()
