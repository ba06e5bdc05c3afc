"""`python -m tests.blind.sealer`: seal cases of a seed into a folder of logs and a folder of truths."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import click
from rich.progress import track

from tests.blind.sealer.case import Order, seal
from tests.blind.sealer.cells import SETS

SCORED = (20261121, 20261122)  # never opened in development; the second not yet opened at all


def one(order: Order, seed: int, logs: Path, truths: Path) -> str:
    """Seal one case unless it is there already."""
    if not (truths / f"{order.key}.json").exists():
        seal(order, seed, logs, truths)
    return order.key


@click.command()
@click.option("--seed", type=int, required=True, help="development seeds: 1000-1999")
@click.option("--set", "name", type=click.Choice(sorted(SETS)), default="develop", show_default=True)
@click.option("--only", default="", help="only cases whose key contains this")
@click.option("--prefix", default="", help="put before every key (several seeds in one folder)")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="folder of the logs")
@click.option("--truth", type=click.Path(path_type=Path), required=True, help="folder of the truths")
@click.option("--jobs", default=1, show_default=True)
def main(seed: int, name: str, only: str, prefix: str, out: Path, truth: Path, jobs: int) -> None:
    """Seal a set of cases."""
    if seed in SCORED:
        raise click.ClickException(f"--seed {seed}: this seed is scored; development uses 1000-1999")
    orders = [Order(prefix + o.key, *list(vars(o).values())[1:]) for o in SETS[name]() if only in o.key]
    work = partial(one, seed=seed, logs=out, truths=truth)
    if jobs == 1:
        for order in track(orders, "sealing"):
            work(order)
        return
    with ProcessPoolExecutor(jobs) as pool:
        list(track(pool.map(work, orders), "sealing", total=len(orders)))


if __name__ == "__main__":
    main()
