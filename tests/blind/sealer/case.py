"""One case: draw the drive, the runs and the effects, set their size, write the logs, seal the truth."""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer import logfile, measure, sensors
from tests.blind.sealer.catalogue import BY_NAME, MONO_CLASS, OUTSIDE
from tests.blind.sealer.draw import Drive, drive
from tests.blind.sealer.drawn import Drawn
from tests.blind.sealer.drive_runs import Trace, run_all, travel
from tests.blind.sealer.manoeuvres import Run, plan

ONE_SESSION = {"preload_change", "magnet_weakening", "brake_drag"}  # they begin at a time of the session
TOP_DELAY_S = 0.05  # the kernel remembers 64 ms


@dataclass(frozen=True)
class Order:
    """What to seal: cell ("nothing", "single", "pair", "outside"), drive kind, names with ratios,
    manoeuvre."""

    key: str
    cell: str
    kind: str
    names: tuple[str, ...] = ()
    ratio: float = 0.0
    poor: bool = False


def breakaway_effort(drawn: Drive) -> float:
    """Effort (PWM steps) that just breaks the axis away, open loop."""
    v = drawn.values
    torque = v["TS"] / (d.GEAR_RATIO * v["KA"] * (1.0 - v["COUNTER"]))
    return min(2900.0, torque * v["RA"] / v["V0"] * d.PWM_TOP)


def merged(effects: list[Drawn]) -> dict[str, float]:
    """Values of all effects; two that use the same place cannot be drawn together."""
    out: dict[str, float] = {}
    for effect in effects:
        values = effect.values()
        if "L1_T" in values and "L1_T" in out:
            values = {key.replace("L1_", "L2_"): value for key, value in values.items()}
        if set(values) & set(out) - {"HEAT_TAU"}:
            raise ValueError(f"{effect.name}: shares {sorted(set(values) & set(out))} with the other effect")
        out.update(values)
    return out


def set_size(
    effect: Drawn, ratio: float, drawn: Drive, runs: list[Run], seed: int
) -> tuple[dict[str, float], list[Trace]]:
    """Scale the effect until its largest channel ratio is within 10 % of the wanted one; the ratios, the
    runs."""
    found: dict[str, float] = {}
    traces: list[Trace] = []
    for _ in range(3):
        values = effect.values()
        traces = run_all(drawn, runs, values, seed)
        found = measure.ratios(drawn, traces, values, seed)
        top = max(found.values())
        if effect.how != "measured" or 0.9 * ratio < top < 1.1 * ratio:
            return found, traces
        effect.size *= float(np.clip(ratio / max(top, 1e-6), 0.02, 50.0))
        for key, value in effect.values().items():
            limit = {
                "DELAY_POS": TOP_DELAY_S,
                "DELAY_ADC": TOP_DELAY_S,
                "DELAY_TACH": TOP_DELAY_S,
                "DELAY_VEL": TOP_DELAY_S,
                "DIODE": 1.0,
                "RIP_A": 0.5,
                "MAG_A": 0.5,
            }.get(key)
            if limit is not None and value > limit:
                effect.size *= limit / value
        if effect.name == "structural_mode" and effect.values()["J2"] > 0.5 * drawn.values["J"]:
            effect.size = 0.5 * drawn.values["J"] / effect.scaled["J2"]
    values = effect.values()
    traces = run_all(drawn, runs, values, seed)
    return measure.ratios(drawn, traces, values, seed), traces


def truth_of(effect: Drawn, ratio: float, found: dict[str, float], poor: bool) -> dict[str, Any]:
    """The truth file's entry of one effect."""
    values = effect.values()
    inside = effect.name in BY_NAME
    return {
        "name": effect.name,
        "class": list(MONO_CLASS.get(effect.name, (effect.name,))) if poor else [effect.name],
        "stage": effect.stage,
        "harmonic": effect.harmonic,
        "channel": effect.channel,
        "domain": list(effect.domain),
        "order": effect.order,
        "frequency_Hz": effect.frequency_hz,
        "in_catalogue": inside,
        "ratio": ratio,
        "size_by": effect.how,
        "ratio_by_channel": {key: round(value, 4) for key, value in found.items()},
        "parameters": {
            name: {"value": values[key] * factor, "unit": unit}
            for name, (key, factor, unit) in effect.parameters.items()
        },
        "raw": values,
    }


def build(order: Order, seed: int) -> tuple[Drive, list[Trace], dict[str, float], dict[str, Any]]:
    """Everything but the files."""
    digest = hashlib.sha256(f"{seed}/{order.key}".encode()).digest()
    number = int.from_bytes(digest[:4], "little")
    rng = np.random.default_rng(number)
    drawn = drive(rng, order.kind)
    single_session = bool(ONE_SESSION & set(order.names))
    runs = plan(rng, breakaway_effort(drawn), order.poor, 1 if single_session else None)
    span = travel(run_all(drawn, runs, {}, number)) if "position_friction" in order.names else 1.0
    effects: list[Drawn] = []
    entries: list[dict[str, Any]] = []
    traces: list[Trace] = []
    for name in order.names:
        effect = (BY_NAME | OUTSIDE)[name](rng, drawn, span, order.ratio)
        found, traces = set_size(effect, order.ratio, drawn, runs, number)
        effects.append(effect)
        entries.append(truth_of(effect, order.ratio, found, order.poor))
    values = merged(effects)
    if len(effects) != 1:
        traces = run_all(drawn, runs, values, number)
    used = {**drawn.values, **{k: v for k, v in values.items() if k in drawn.values}}
    truth = {
        "key": order.key,
        "cell": order.cell,
        "kind": order.kind,
        "seed": seed,
        "poor": order.poor,
        "axis": drawn.axis,
        "preload": drawn.preload,
        "effects": entries,
        "floors": measure.floors(drawn),
        "noise": drawn.noise,
        "drive": used,
        "declared": drawn.declared,
        "runs": [{"kind": r.kind, "session": r.session, "loop": r.loop, "seconds": r.seconds} for r in runs],
    }
    return drawn, traces, values, {**truth, "number": number}


def seal(order: Order, seed: int, logs: Path, truths: Path) -> dict[str, Any]:
    """Write logs/<key>/run*.log and SEAL (hash of the truth), and truths/<key>.json."""
    drawn, traces, values, truth = build(order, seed)
    text = json.dumps(truth, indent=1, sort_keys=True)
    folder = logs / order.key
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "SEAL").write_text(hashlib.sha256(text.encode()).hexdigest() + "\n")
    for i, trace in enumerate(traces):
        out = sensors.columns(trace, drawn, values, truth["number"], i)
        out = sensors.spoil(out, values, truth["number"], i)
        logfile.write(folder / f"run{i + 1}.log", trace.run, drawn, out)
    truths.mkdir(parents=True, exist_ok=True)
    (truths / f"{order.key}.json").write_text(text)
    return truth
