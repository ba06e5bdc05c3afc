"""`python -m tests.blind.world`: seal logs like the world's, let the finder answer, open the seals, score."""

from pathlib import Path

import click

from tests.blind.drives import table
from tests.blind.family import chosen, run
from tests.blind.options import options
from tests.blind.world.case import seal
from tests.blind.world.cells import SETS

SCORED_SEED = 20261301  # opened once, on a frozen finder; development uses 1000-1999


@click.command()
@options(SETS, SCORED_SEED, Path("out/blind-world"))
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
    """Blind tests on logs like the world's, through the campaigns' executor. Resumes where it stopped."""
    orders = chosen(SETS[name](), name, only, first)
    click.echo(run(orders, seal, seed, out / str(seed), table.markdown, jobs, scheduler, command))


if __name__ == "__main__":
    main()
