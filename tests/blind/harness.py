"""Seal, let the finder answer, open the seals, score. Every step leaves its result on disk and is not made
twice."""

import hashlib
import json
import os
import subprocess
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path
from typing import Any

from scenarios.campaign.executor import each
from scenarios.progress import shown
from tests.blind import finder, score, table
from tests.blind.sealer.case import Order, seal


class SealBroken(ValueError):
    """A truth file does not have the hash that was written before the finder ran."""


def seal_one(order: Order, seed: int, out: Path) -> None:
    """Seal one case unless it is sealed."""
    if not (out / "truth" / f"{order.key}.json").exists():
        seal(order, seed, out / "logs", out / "truth")


def find_one(order: Order, command: str, out: Path) -> None:
    """Let the finder answer one case. It is told where the logs are, not where the truth is."""
    finder.find(out / "logs" / order.key, out / "answers" / order.key, command)


def in_parallel(
    what: str,
    work: Callable[..., None],
    orders: list[Order],
    jobs: int,
    *args: object,
    scheduler: str | None = None,
) -> None:
    """All orders through the campaigns' executor with a progress bar: `jobs` processes here, or a Dask
    scheduler whose workers see the output folder. An order whose worker keeps dying is left without."""
    with shown(what, len(orders)) as show:
        if jobs == 1 and scheduler is None:
            for count, order in enumerate(orders, 1):
                work(order, *args)
                show(count, order.key)
            return
        named = {order.key: order for order in orders}
        answers = each(partial(_work, work, args), named.items(), jobs=jobs, scheduler=scheduler)
        for count, done in enumerate(answers, 1):
            if done.error and not done.died:
                raise RuntimeError(f"{what} {done.key}: {done.error}")
            show(count, done.key)


def _work(work: Callable[..., None], args: tuple[object, ...], order: Order) -> None:
    work(order, *args)


def find_alone(orders: list[Order], command: str, out: Path) -> None:
    """Every case that has no answer in a process of its own; one that dies is a case without an answer."""
    for order in orders:
        folder = out / "answers" / order.key
        if (folder / "answer.json").exists():
            continue
        try:
            with ProcessPoolExecutor(1) as pool:
                pool.submit(find_one, order, command, out).result()
        except BrokenProcessPool:
            answer = {"status": 1, "seconds": 0.0, "failure": "the finder's process died"}
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "answer.json").write_text(json.dumps(answer))


def digest(paths: Iterable[Path]) -> str:
    """SHA-256 over files in order of their names."""
    total = hashlib.sha256()
    for path in sorted(paths):
        total.update(path.read_bytes())
    return total.hexdigest()


def commit() -> str:
    """The checkout's commit, or "unknown" outside git."""
    done = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False
    )
    return done.stdout.strip() or "unknown"


def open_seal(order: Order, out: Path) -> dict[str, Any]:
    """The truth of a case, after its hash has been checked against the one written beside the logs."""
    text = (out / "truth" / f"{order.key}.json").read_text()
    wanted = (out / "logs" / order.key / "SEAL").read_text().strip()
    if hashlib.sha256(text.encode()).hexdigest() != wanted:
        raise SealBroken(f"{out}/truth/{order.key}.json: not the truth that was sealed")
    truth: dict[str, Any] = json.loads(text)
    return truth


def judged(order: Order, out: Path) -> dict[str, Any]:
    """The scored row of one case."""
    folder = out / "answers" / order.key
    answer = json.loads((folder / "answer.json").read_text())
    report = None
    if answer["failure"] is None:
        report = json.loads((folder / "report.json").read_text())
    return score.score(answer, report, open_seal(order, out))


def run(
    orders: list[Order],
    seed: int,
    out: Path,
    jobs: int,
    command: str = finder.COMMAND,
    scheduler: str | None = None,
) -> dict[str, Any]:
    """The whole test; answers what `results.json` holds. Wall time adds up over resumed runs."""
    begin = time.monotonic()
    out.mkdir(parents=True, exist_ok=True)
    clock = out / "wall_s"
    spent = float(clock.read_text()) if clock.exists() else 0.0
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        in_parallel("seal", seal_one, orders, jobs, seed, out, scheduler=scheduler)
        seals = {o.key: (out / "logs" / o.key / "SEAL").read_text().strip() for o in orders}
        (out / "seals.json").write_text(json.dumps(seals, indent=1))
        in_parallel("find", find_one, orders, jobs, command, out, scheduler=scheduler)
        find_alone(orders, command, out)  # those whose worker died (out of memory, a crash below Python)
    finally:
        clock.write_text(f"{spent + time.monotonic() - begin:.1f}")
    rows = [judged(order, out) for order in orders]
    seconds = sorted(row["seconds"] for row in rows)
    about = {
        "seed": seed,
        "cases": len(rows),
        "jobs": jobs,
        "commit": commit(),
        "wall_s": float(clock.read_text()),
        "finder": command,
        "finder_source_sha256": digest(
            p for room in ("plant", "calibration") for p in Path(room).rglob("*.py")
        ),
        "finder_median_s": seconds[len(seconds) // 2],
        "finder_max_s": seconds[-1],
    }
    lines = table.figures(rows)
    results = {"about": about, "figures": lines, "cases": rows}
    (out / "results.json").write_text(json.dumps(results, indent=1))
    (out / "blind.md").write_text(
        table.markdown(lines, about) + "\n" + table.reliability(rows) + "\n" + table.per_name(rows)
    )
    return results
