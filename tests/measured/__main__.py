"""`python -m tests.measured [KEY…] --out DIR`: every measured log answered, and judged by what is in it."""

import contextlib
import io
import json
import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from calibration.command import calibrate
from tests.measured.cases import CASES, DATA
from tests.measured.truth import WRONG, judge, say


@dataclass(frozen=True, kw_only=True)
class Answer:
    """One row of the table: `before`, `after`, `floor` and `own` are held-out rms in the response's unit."""

    key: str
    verdict: str
    judged: str
    why: str
    before: float
    after: float
    floor: float
    own: float
    seconds: float
    said: str


def answer(key: str, out: Path) -> Answer:
    """Calibrate and judge; a process of its own finds the case by its key."""
    case = next(c for c in CASES if c.key == key)
    folder, begun = out / key, time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()):
        calibrate(case.logs, case.rig, list(case.hold_out), folder, plots=False, replay=False)
    seconds = time.perf_counter() - begun
    data: dict[str, Any] = json.loads((folder / "report.json").read_text())
    judged, why = judge(data, case.needs, case.may)
    row: dict[str, Any] = next((r for k, r in data["error"].items() if k in ("torque", "position")), {})
    own = case.own(case.logs, case.rig) if case.own and row else np.nan
    figures = {k: float("nan") if row.get(k) is None else float(row[k]) for k in ("before", "after", "floor")}
    said = "; ".join(say(e) for e in data["effects"]) or str(data["separating_experiment"] or "")[:160]
    verdict = str(data["verdict"])
    return Answer(
        key=key, verdict=verdict, judged=judged, why=why, own=own, seconds=seconds, said=said, **figures
    )


@click.command()
@click.argument("keys", nargs=-1)
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/measured"))
@click.option("--jobs", default=1)
def main(keys: tuple[str, ...], out: Path, jobs: int) -> None:
    """Print the table."""
    if not DATA.is_dir():
        raise click.ClickException("../shared/data/measured is absent: no measured data to answer")
    os.environ["OMP_NUM_THREADS"] = "1"
    wanted = [c.key for c in CASES if not keys or any(c.key.startswith(k) for k in keys)]
    with ProcessPoolExecutor(jobs) as pool:
        rows = []
        for row in pool.map(answer, wanted, [out] * len(wanted)):
            rows.append(row)
            click.echo(f"{row.key}: {row.judged} in {row.seconds:.0f} s", err=True)
    show(rows)


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
