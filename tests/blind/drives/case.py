"""One case: draw the drive, its runs and what is hidden; write tables and a rig file, seal the truth."""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.blind.drives import mount, sensors, slots, telescope
from tests.blind.drives.effects import OUTSIDE, WHERE, Hidden
from tests.blind.drives.families import FAMILIES, Family, Rng
from tests.blind.drives.kernel import STOPS, simulate
from tests.blind.drives.motion import reference
from tests.blind.drives.order import Order
from tests.blind.drives.rigfile import rig
from tests.blind.drives.slots import Array

DRAWS = {draw.__name__: draw for draw in (*WHERE, *OUTSIDE)}
FORCE_EFFECT = ("T",)


@dataclass
class Sealed:
    """A drive in motion: its plant, references and rows per run."""

    family: Family
    plant: dict[str, float]
    turn: float
    references: list[Array]
    rows: list[Array]


def run(
    family: Family, plant: dict[str, float], values: dict[str, float], references: list[Array], number: int
) -> list[Array]:
    """Simulate all runs; times of effects are shares of a run."""
    out = []
    for k, path in enumerate(references):
        span = len(path) * family.period_s
        scaled = {n: v * span if n in ("DRAG_T", "WARM_TAU") else v for n, v in values.items()}
        noise = np.random.default_rng([number, 3, k]).standard_normal(len(path)) * family.step * 0.3
        p = slots.vector({**plant, **scaled})
        out.append(simulate(p, path, family.period_s, 0.0, noise, np.full(STOPS, path[0])))
    return out


def ratio_of(s: Sealed, late_s: float = 0.0) -> float:
    """rms of the hidden force beyond what inertia, friction and offset take up, over the effort's noise.

    late_s: of the effort's column, whose force is then that of another moment.
    """
    rows = np.concatenate(s.rows)
    v = rows[:, slots.V]
    own, v, a = rows[:, slots.OWN], v, rows[:, slots.A]
    f = s.family
    if late_s:
        own = own + s.plant["GAIN"] * np.concatenate([_moved(r[:, slots.EFFORT], f, late_s) for r in s.rows])
    base = np.column_stack([v, np.tanh(v / s.plant["VS"]), a, np.ones(len(v))])
    left = own - base @ np.linalg.lstsq(base, own, rcond=None)[0]
    floor = s.plant["GAIN"] * np.hypot(f.noise * s.plant["TOP"], f.effort_step / np.sqrt(12.0))
    return float(np.sqrt(np.mean(left**2)) / floor)


def _moved(effort: Array, f: Family, late_s: float) -> Array:
    """What a late column reads, less what it would read in time."""
    t = np.arange(len(effort)) * f.period_s
    return np.asarray(np.interp(t - late_s, t, effort) - effort)


def build(order: Order, seed: int) -> tuple[Sealed, Hidden | None, float, int]:
    """The drive in motion, what is hidden, and how large it came out."""
    number = int.from_bytes(hashlib.sha256(f"drives/{seed}/{order.key}".encode()).digest()[:4], "little")
    rng = np.random.default_rng(number)
    family = FAMILIES[order.kind]
    plant = family.draw(rng)
    turn = float(rng.uniform(*family.turn))
    references = [reference(rng, family, order.seconds) for _ in range(3)]
    hidden = DRAWS[order.names[0]](rng, family, plant, turn, order.ratio) if order.names else None
    values = hidden.values() if hidden else {}
    made = Sealed(family, plant, turn, references, run(family, plant, values, references, number))
    if hidden is None:
        return made, None, 0.0, number
    size = ratio_of(made, values.get("LATE", 0.0))
    for _ in range(3):
        if hidden.how != "measured" or 0.9 * order.ratio < size < 1.1 * order.ratio:
            break
        wanted = hidden.size * float(np.clip(order.ratio / max(size, 1e-9), 0.05, 20.0))
        hidden.size = max(min(wanted, hidden.most), hidden.least)
        values = hidden.values()
        made.rows = run(family, plant, values, references, number)
        size = ratio_of(made, values.get("LATE", 0.0))
    return made, hidden, size, number


#: kinds of drive that are made by files of their own
OTHERS = {"mount": mount.make, "telescope": telescope.make}


def seal(order: Order, seed: int, logs: Path, truths: Path) -> dict[str, Any]:
    """Write logs/<key>/{run1..3.csv, rig.yaml, SEAL} and truths/<key>.json."""
    folder = logs / order.key
    folder.mkdir(parents=True, exist_ok=True)
    made = OTHERS.get(order.kind, _tables)(order, seed, folder)
    truth = {
        "key": order.key, "cell": order.cell, "kind": f"{order.noise} {order.spoil}".strip(),
        "seed": seed, "poor": False, "family": order.kind, "spoil": order.spoil, "seconds": order.seconds,
        **made,
    }  # fmt: skip
    text = json.dumps(truth, indent=1)
    (folder / "SEAL").write_text(hashlib.sha256(text.encode()).hexdigest() + "\n")
    truths.mkdir(parents=True, exist_ok=True)
    (truths / f"{order.key}.json").write_text(text)
    return truth


def _tables(order: Order, seed: int, folder: Path) -> dict[str, Any]:
    """Tables and rig file of a drive with a position loop; the truth's effects and drive."""
    made, hidden, size, number = build(order, seed)
    f = made.family
    two = order.two or bool(hidden and hidden.second)
    law = order.law or bool(hidden and hidden.law)
    span = len(made.rows) * order.seconds
    usual = float(np.sqrt(np.mean(np.concatenate(made.rows)[:, slots.EFFORT] ** 2)))
    for k, rows in enumerate(made.rows):
        rng: Rng = np.random.default_rng([number, 7, k])
        s = {**hidden.values(), **hidden.sensor, "WIND_RMS": usual} if hidden else {}
        out = sensors.columns(rows, f, s, rng, order.noise, k * order.seconds, span, made.plant["TOP"], two)
        if law:
            out["reference"] = made.references[k]
        out = sensors.spoil(out, rng, order.spoil if k == 0 else "")
        table = np.column_stack(list(out.values()))
        known = {"t": "%.6f", "effort": "%.6g", "reference": "%.10g"}
        formats = [known.get(name, "%d") for name in out]
        np.savetxt(
            folder / f"run{k + 1}.csv", table, fmt=formats, delimiter=",", header=",".join(out), comments=""
        )
    (folder / "rig.yaml").write_text(rig(f, made.plant, made.turn, two, law))
    effects = [truth_of(hidden, order.ratio, size)] if hidden else []
    return {"effects": effects, "drive": made.plant, "turn": made.turn, "number": number}


def truth_of(hidden: Hidden, ratio: float, size: float) -> dict[str, Any]:
    """The truth file's entry of what is hidden."""
    return {
        "name": hidden.name, "class": [hidden.name, *hidden.alike], "stage": None, "channel": hidden.channel,
        "domain": list(hidden.domain), "ratio": ratio, "measured_ratio": size, "parameters": {},
        "reached": size if hidden.how == "measured" else ratio,
        "raw": {**hidden.values(), **hidden.sensor},
        "in_catalogue": not hidden.name.startswith("outside"),
    }  # fmt: skip
