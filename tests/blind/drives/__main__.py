"""`python -m tests.blind.drives`: seal other drives, let the finder answer, open the seals, score."""

import contextlib
import hashlib
import io
import json
import os
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import click
from rich.progress import track

from tests.blind import finder
from tests.blind.drives import table
from tests.blind.drives.case import Order, seal
from tests.blind.drives.cells import SETS
from tests.blind.drives.score import score

SCORED_SEED = 20261122  # opened once, on a frozen finder; development uses 1000-1999


def answer(folder: Path, out: Path, command: str) -> dict[str, Any]:
    """What the finder says of one case: {"status", "seconds", "failure"}; report.json in `out`."""
    out.mkdir(parents=True, exist_ok=True)
    done = out / "answer.json"
    if done.exists():
        told: dict[str, Any] = json.loads(done.read_text())
        return told
    files = sorted(str(p) for p in folder.glob("run*.csv"))
    said = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)  # errors come as bytes
    begin, failure, status = time.perf_counter(), None, 1
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            arguments = ["calibrate", *files, "--rig", str(folder / "rig.yaml"), "--out", str(out)]
            status = finder.call(command, arguments)
    except Exception as error:  # whatever the finder throws is its answer to this case
        failure = f"{type(error).__name__}: {error}"
    if status == finder.INTERRUPTED:
        raise KeyboardInterrupt
    if failure is None and (status != 0 or not (out / "report.json").exists()):
        failure = finder.told(said)[-1000:] or "no report.json"
    told = {"status": status, "seconds": time.perf_counter() - begin, "failure": failure}
    done.write_text(json.dumps(told, indent=1))
    return told


def one(order: Order, seed: int, out: Path, command: str) -> dict[str, Any]:
    """Seal, answer and score one case; what is on disk is not made again."""
    truth_file = out / "truth" / f"{order.key}.json"
    if not truth_file.exists():
        seal(order, seed, out / "logs", out / "truth")
    folder = out / "answers" / order.key
    told = answer(out / "logs" / order.key, folder, command)
    text = truth_file.read_text()
    if hashlib.sha256(text.encode()).hexdigest() != (out / "logs" / order.key / "SEAL").read_text().strip():
        raise ValueError(f"{truth_file}: not the truth that was sealed")
    report = json.loads((folder / "report.json").read_text()) if told["failure"] is None else None
    return score(told, report, json.loads(text))


@click.command()
@click.option("--seed", type=int, default=SCORED_SEED, show_default=True, help="development seeds: 1000-1999")
@click.option("--set", "name", type=click.Choice(sorted(SETS)), default="everything", show_default=True)
@click.option("--only", default="", help="only cases whose key contains this")
@click.option("--first", type=int, help="only so many cases of the set, in its order")
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/blind-drives"), show_default=True)
@click.option("--jobs", default=min(2, os.cpu_count() or 1), show_default=True)
@click.option("--finder", "command", default=finder.COMMAND, show_default=True)
def main(seed: int, name: str, only: str, first: int | None, out: Path, jobs: int, command: str) -> None:
    """Blind tests on other drives. Resumes where it stopped."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    orders = [o for o in SETS[name]() if only in o.key][:first]
    if not orders:
        raise click.ClickException(f"--only {only}: no case of the set {name} has this in its key")
    work = partial(one, seed=seed, out=out / str(seed), command=command)
    with ProcessPoolExecutor(jobs) as pool:
        rows = list(track(pool.map(work, orders), "cases", total=len(orders)))
    text = table.markdown(rows, seed)
    (out / str(seed) / "results.json").write_text(json.dumps(rows, indent=1))
    (out / str(seed) / "table.md").write_text(text)
    click.echo(text)


if __name__ == "__main__":
    main()
