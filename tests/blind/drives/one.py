"""One case of another drive, from its seal to its score."""

import contextlib
import hashlib
import io
import json
import time
from pathlib import Path
from typing import Any

from tests.blind import finder
from tests.blind.drives.case import seal
from tests.blind.drives.order import Order
from tests.blind.drives.score import score


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
