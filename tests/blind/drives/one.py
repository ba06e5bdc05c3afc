"""One case of a family of tables, from its seal to its score."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.blind import finder
from tests.blind.drives import case
from tests.blind.drives.order import Order
from tests.blind.drives.score import score

Seal = Callable[[Order, int, Path, Path], dict[str, Any]]


def sealed(order: Order, seed: int, out: Path, seal: Seal = case.seal) -> str:
    """Seal a case unless it is sealed; the hash of its truth."""
    if not (out / "truth" / f"{order.key}.json").exists():
        seal(order, seed, out / "logs", out / "truth")
    return (out / "logs" / order.key / "SEAL").read_text().strip()


def one(order: Order, seed: int, out: Path, command: str, seal: Seal = case.seal) -> dict[str, Any]:
    """Seal, answer and score one case; what is on disk is not made again."""
    digest = sealed(order, seed, out, seal)
    folder = out / "answers" / order.key
    told = finder.find(out / "logs" / order.key, folder, command)
    truth_file = out / "truth" / f"{order.key}.json"
    text = truth_file.read_text()
    if hashlib.sha256(text.encode()).hexdigest() != digest:
        raise ValueError(f"{truth_file}: not the truth that was sealed")
    report = json.loads((folder / "report.json").read_text()) if told["failure"] is None else None
    return score(told, report, json.loads(text))
