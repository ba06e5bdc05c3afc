"""`python -m tests.blind`: the blind tests. `make blind` runs all of it on both cores."""

import os
from pathlib import Path

import click

from tests.blind import finder, harness
from tests.blind.sealer.cells import SETS

SCORED_SEED = (
    20261122  # not opened yet: once, on a frozen finder; 20261121 has been, development uses 1000-1999
)


@click.command()
@click.option("--seed", type=int, default=SCORED_SEED, show_default=True, help="development seeds: 1000-1999")
@click.option("--set", "name", type=click.Choice(sorted(SETS)), default="everything", show_default=True)
@click.option("--only", default="", help="only cases whose key contains this")
@click.option("--first", type=int, help="only so many cases of the set, in its order")
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/blind"), show_default=True)
@click.option("--jobs", default=min(2, os.cpu_count() or 1), show_default=True)
@click.option("--scheduler", metavar="tcp://HOST:PORT", help="a Dask scheduler instead of processes here")
@click.option(
    "--finder",
    "command",
    default=finder.COMMAND,
    show_default=True,
    help="module:function of the command line",
)
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
    """Seal cases, let the finder answer, open the seals, score, write the table. Resumes where it stopped."""
    orders = [order for order in SETS[name]() if only in order.key][:first]
    if not orders:
        raise click.ClickException(f"--only {only}: no case of the set {name} has this in its key")
    harness.run(orders, seed, out / str(seed), jobs, command, scheduler)
    click.echo((out / str(seed) / "table.md").read_text())
    click.echo(f"every case: {out / str(seed) / 'results.json'}")


if __name__ == "__main__":
    main()
