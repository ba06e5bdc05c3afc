"""`python -m tests.blind.drives`: seal other drives, let the finder answer, open the seals, score."""

import json
import os
from functools import partial
from pathlib import Path
from typing import Any

import click
from rich.progress import track

from scenarios.campaign.executor import each
from tests.blind.drives import table
from tests.blind.drives.cells import SETS
from tests.blind.drives.one import one
from tests.blind.options import options

SCORED_SEED = 20261122  # opened once, on a frozen finder; development uses 1000-1999


@click.command()
@options(SETS, SCORED_SEED, Path("out/blind-drives"))
def main(
    seed: int,
    name: str,
    only: str,
    first: int | None,
    out: Path,
    jobs: int,
    scheduler: str | None,
    command: str,
) -> None:
    """Blind tests on other drives, through the campaigns' executor. Resumes where it stopped."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    orders = [o for o in SETS[name]() if only in o.key][:first]
    if not orders:
        raise click.ClickException(f"--only {only}: no case of the set {name} has this in its key")
    work = partial(one, seed=seed, out=out / str(seed), command=command)
    found: dict[str, dict[str, Any]] = {}
    given = {order.key: order for order in orders}
    for done in track(each(work, given.items(), jobs=jobs, scheduler=scheduler), "cases", len(orders)):
        if done.value is None:
            raise click.ClickException(f"{done.key}: {done.error}")
        found[done.key] = done.value
    rows = [found[order.key] for order in orders]
    text = table.markdown(rows, seed)
    (out / str(seed) / "results.json").write_text(json.dumps(rows, indent=1))
    (out / str(seed) / "blind.md").write_text(text)
    click.echo(text)


if __name__ == "__main__":
    main()
