"""One case: write its files and its rig file, seal the truth."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tests.blind.drives.order import Order
from tests.blind.world import arm_log, gear_log, guide, motor_log
from tests.blind.world.made import Made

Maker = Callable[[Order, np.random.Generator, int], Made]
MAKERS: dict[str, Maker] = {
    "motor": motor_log.make,
    "arm": arm_log.make,
    "guide": guide.make_log,
    "rate": guide.make_table,
    "gear": gear_log.make,
}


def inner(order: Order) -> Order:
    """A faulty table is a drive's log in another shape: its order says whose, and which."""
    if order.kind != "table":
        return order
    kind, fault = order.spoil.split(" ")
    return replace(order, kind=kind, spoil=fault, two=False)


def seal(order: Order, seed: int, logs: Path, truths: Path) -> dict[str, Any]:
    """Write logs/<key>/{files, rig.yaml, SEAL} and truths/<key>.json."""
    number = int.from_bytes(hashlib.sha256(f"world/{seed}/{order.key}".encode()).digest()[:4], "little")
    made = MAKERS[inner(order).kind](inner(order), np.random.default_rng(number), number)
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
