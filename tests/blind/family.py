"""Families of sealed tables: seal every case, then let the finder answer, open the seals, score."""

import json
import os
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import click
from rich.progress import track

from scenarios.campaign.executor import each
from tests.blind.drives.one import Seal, one, sealed
from tests.blind.drives.order import Order

Row = dict[str, Any]


def run(
    orders: list[Order],
    seal: Seal,
    seed: int,
    out: Path,
    markdown: Callable[[list[Row], int], str],
    jobs: int,
    scheduler: str | None,
    command: str,
) -> str:
    """The whole test of one seed in `out`; answers the table. What is on disk is not made again."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    def through(what: str, work: Callable[[Order], Any]) -> Iterator[tuple[str, Any]]:
        named = {order.key: order for order in orders}
        for done in track(each(work, named.items(), jobs=jobs, scheduler=scheduler), what, len(orders)):
            if done.value is None:
                raise click.ClickException(f"{done.key}: {done.error}")
            yield done.key, done.value

    out.mkdir(parents=True, exist_ok=True)
    seals = dict(through("seal", partial(sealed, seed=seed, out=out, seal=seal)))
    (out / "seals.json").write_text(json.dumps({o.key: seals[o.key] for o in orders}, indent=1))
    found = dict(through("find", partial(one, seed=seed, out=out, command=command, seal=seal)))
    rows = [found[order.key] for order in orders]
    text = markdown(rows, seed)
    (out / "results.json").write_text(json.dumps(rows, indent=1))
    (out / "blind.md").write_text(text)
    return text


def chosen(orders: list[Order], name: str, only: str, first: int | None) -> list[Order]:
    """The orders that the options ask for."""
    some = [order for order in orders if only in order.key][:first]
    if not some:
        raise click.ClickException(f"--only {only}: no case of the set {name} has this in its key")
    return some
