"""One case: write its files and its rig file, seal the truth."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.blind.drives.order import Order
from tests.blind.world import motor_log

MAKERS = {"motor": motor_log.make}


def seal(order: Order, seed: int, logs: Path, truths: Path) -> dict[str, Any]:
    """Write logs/<key>/{files, rig.yaml, SEAL} and truths/<key>.json."""
    number = int.from_bytes(hashlib.sha256(f"world/{seed}/{order.key}".encode()).digest()[:4], "little")
    made = MAKERS[order.kind](order, np.random.default_rng(number), number)
    folder = logs / order.key
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in made.files.items():
        (folder / name).write_text(text)
    if made.rig is not None:
        (folder / "rig.yaml").write_text(made.rig)
    truth = {
        "key": order.key, "cell": order.cell, "kind": f"{order.noise} {order.spoil}".strip(), "seed": seed,
        "poor": False, "family": order.kind, "spoil": "", "number": number, "drive": made.drive,
        "effects": [made.hidden.truth(order.ratio, made.reached)] if made.hidden else [],
    }  # fmt: skip
    text = json.dumps(truth, indent=1)
    (folder / "SEAL").write_text(hashlib.sha256(text.encode()).hexdigest() + "\n")
    truths.mkdir(parents=True, exist_ok=True)
    (truths / f"{order.key}.json").write_text(text)
    return truth
