"""`python -m tests.blind`: the blind tests. `make blind` runs all of it on both cores."""

from pathlib import Path

import click

from tests.blind import harness
from tests.blind.options import options
from tests.blind.sealer.cells import SETS

SCORED_SEED = 20261122  # of the set `strata` 44 are opened (docs/results/blind.md); development has 1000-1999


@click.command()
@options(SETS, SCORED_SEED, Path("out/blind"))
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
    click.echo((out / str(seed) / "blind.md").read_text())
    click.echo(f"every case: {out / str(seed) / 'results.json'}")


if __name__ == "__main__":
    main()
