"""An axis with two motors against each other, of a telescope that is not the Schmidt: drawn for every case.

The axis is integrated by the sealer's kernel (tests/blind/sealer), which takes every number as a parameter.
The numbers are those of mounts of 0.6 to 1.5 m in their order of magnitude (inertias of 150 to 1350 kg m2,
spur gears of three stages, encoders of 25 to 28 bit, friction tapes; ASSUMPTIONS, as are the ratios between
them); its owner declares them as its maker told, up to an eighth off. A column that is late by less than
0.3 ms is late by an interrupt or a frame of the bus.
"""

import hashlib
import math
from pathlib import Path
from typing import Any

import numpy as np

from tests.blind.drives.families import Rng, near
from tests.blind.drives.order import Order
from tests.blind.drives.slots import Array
from tests.blind.drives.telescopelog import ROW_S, TICK_S, TURN, Axis, declared, table
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drive_runs import Trace, run_all
from tests.blind.sealer.manoeuvres import Run, piecewise

ARCSEC = math.pi / 648000.0
LEAST_DELAY_S = 3e-4


def draw(rng: Rng) -> Axis:
    """An axis of its own."""
    teeth = tuple(
        (int(rng.integers(*wheel)), int(rng.integers(*pinion)))
        for wheel, pinion in (((240, 420), (15, 24)), ((80, 130), (15, 24)), ((60, 110), (12, 24)))
    )
    ratio = math.prod(w / p for w, p in teeth)
    inertia = near(rng, 450.0, 3.0)
    coulomb = near(rng, 0.1 * inertia, 1.5)
    break_away = coulomb * rng.uniform(1.4, 2.4)
    stribeck = near(rng, 5e-4, 1.5)
    rotor = near(rng, 90.0, 1.5) * inertia / 450.0 / ratio**2
    stiffness = near(rng, 2.0e6, 1.5) * inertia / 450.0
    viscous = near(rng, 2.0 * inertia, 1.5)
    constant = rng.uniform(0.08, 0.4)
    supply = float(rng.choice([24.0, 36.0, 48.0]))
    resistance = rng.uniform(0.8, 2.5)
    strength = supply / resistance * constant * ratio  # N m at full effort
    count = near(rng, 1.5e-5, 1.5)  # rad/s of one count of the tape in a tick
    kp = 55.0 * (inertia + 2 * rotor * ratio**2) * count / strength * 3000
    values = {
        "J": inertia, "SIG0": near(rng, 5e3 * inertia, 1.5), "SIG2": viscous, "TC": coulomb,
        "TS": break_away, "SIG1": 0.8 * viscous * coulomb / (break_away - coulomb), "VS": stribeck,
        "DELTA": 2.0, "RATIO": ratio,
        "KGEAR": stiffness, "CGEAR": 0.6 * math.sqrt(stiffness * rotor) * ratio, "JM": rotor,
        "HALF_GAP": math.radians(rng.uniform(8, 20)) / ratio / 2, "KA": constant, "KB": constant,
        "RA": resistance, "RB": resistance, "L": resistance * 2e-3, "V0": supply,
        "COUNTER": float(rng.choice([0.1, 0.15, 0.2, 0.25])),
        "KP_Q12": round(4096 * kp), "KI_Q12": round(4096 * kp / 30), "TICK": TICK_S,
        "ROLLER_SCALE": 1 / (count * TICK_S), "ROLLER_NOISE": 0.2, "TH_START": rng.uniform(0.3, 5.0),
        "WARM_TAU": 100.0, "HEAT_TAU": 100.0, "CABLE_SCALE": 0.1,
    }  # fmt: skip
    return Axis(
        values, teeth, (int(rng.integers(500, 800)), int(rng.integers(20, 40))),
        2.0 ** float(rng.integers(25, 29)), float(rng.choice([0.002, 0.004, 0.006])),
        float(rng.choice([2000, 4096, 8000])),
    )  # fmt: skip


#: slots of the sealer's kernel at size 1, the channel, and names that pass for the effect's
Effect = tuple[dict[str, float], str, tuple[str, ...]]


def effect_of(name: str, rng: Rng, a: Axis) -> tuple[Effect, dict[str, float], str | None]:
    """Scaled values, channel and likes; fixed values; the stage."""
    c, v = a.values["TC"], a.values
    phase = float(rng.uniform(0, TURN))
    stage = str(rng.choice(["pinion", "layshaft"]))
    return {
        "friction_asymmetry": (({"ASYM_C": 0.02}, "T", ()), {}, None),
        "gravity_imbalance": (({"GRAV_A": 0.1 * c}, "T", ()), {"GRAV_PH": phase}, "axis"),
        "gear_eccentricity": (
            ({"L1_T": 0.1 * c}, "T", ()), {"L1_ORDER": a.order(stage), "L1_PH": phase}, stage),
        "gear_mesh": (
            ({"L1_T": 0.05 * c, "L1_K": 0.3 * ARCSEC}, "T", ()),
            {"L1_ORDER": a.order("ring mesh"), "L1_PH": phase}, "ring mesh"),
        "torque_ripple": (
            ({"RIP_A": 0.02}, "T", ("motor_cogging",)),
            {"RIP_N": float(rng.integers(4, 15)), "RIP_PH": phase}, "motor"),
        "load_friction": (({"LOADF": 0.02}, "T", ()), {}, None),
        "brake_drag": (({"BRAKE_T": 0.1 * c}, "T", ()), {"BRAKE_T0": float(rng.uniform(60, 160))}, None),
        "position_friction": (
            ({"POSF_A": 0.05}, "T", ()),
            {"POSF_ORDER": float(rng.uniform(2, 5)) * TURN / 1.2, "POSF_PH": phase}, None),
        "supply_sag": (({"SAG": 0.05}, "E", ()), {}, None),
        "pwm_deadband": (({"DEADBAND": 0.003}, "E", ()), {}, None),
        "magnet_weakening": (
            ({"MAG_A": 0.02}, "E", ("adc_gain",)),
            {"MAG_T0": float(rng.uniform(60, 160)), "MAG_RAMP": 10.0, "MAG_SIDE": 0.0}, None),
        "roller_ratio": (({"ROLLER_EPS": 1e-4}, "S", ()), {}, "tape"),
        "channel_delay": (({"DELAY_POS": 1e-3}, "K", ()), {}, None),
        "outside_quadratic": (({"QUAD": v["SIG2"] * 0.5}, "T", ("velocity",)), {}, None),
    }[name]  # fmt: skip


def runs(rng: Rng, a: Axis) -> list[Run]:
    """Steps of the rate, long sweeps, a ramp through zero, tracking and steps again; arcsec/s."""
    counts = ARCSEC * a.values["ROLLER_SCALE"] * TICK_S
    slow, middle, quick = rng.uniform(300, 600), rng.uniform(900, 1500), rng.uniform(2400, 3600)
    one, two, track = rng.uniform(4000, 6000), rng.uniform(7500, 10000), float(rng.choice([15.0, 30.0]))
    rates = [
        ([(r * s, 9.0) for r in (slow, middle, quick) for s in (1.0, -1.0)], 2400.0),
        ([(one, 20.0), (-one, 20.0), (two, 10.0), (-two, 10.0)], 2400.0),
        ([(900.0, 0.5), (-900.0, 0.5)] * 2, 130.0),
        ([(track, 25.0), (100.0, 9.0), (-track, 25.0), (-100.0, 9.0)], 2400.0),
        ([(r * s, 9.0) for r in (1.3 * slow, 0.8 * quick) for s in (1.0, -1.0)], 2400.0),
    ]
    out, clock = [], 0.0
    for k, (points, slope) in enumerate(rates):
        command = piecewise([(0.0, 1.0), *points, (0.0, 1.0)], slope) * counts
        out.append(Run(f"run{k + 1}", "closed", command, "a", clock, clock))
        clock += len(command) * TICK_S + 20.0
    return out


def size_of(a: Axis, traces: list[Trace], values: dict[str, float]) -> float:
    """Largest ratio of what the effect adds to a channel, beyond what inertia, friction, R and K take up, to
    what the sensors leave."""

    def joined(name: str) -> Array:
        return np.concatenate([t[name] for t in traces])

    v, omega = a.values, joined("omega")
    alpha = np.concatenate([np.gradient(t["omega"], ROW_S) for t in traces])
    way = np.tanh(omega / (3 * ARCSEC))
    fade = way * np.exp(-((omega / v["VS"]) ** 2))
    amps, code = a.ampere * math.hypot(0.7, 12**-0.5), TURN / a.codes * 0.5
    torque_floor = math.hypot(
        v["KA"] * a.ratio * amps * math.sqrt(2), v["J"] * math.sqrt(6) * code / ROW_S**2
    )
    found = [_left(joined("e_torque"), [way, fade, omega, alpha]) / torque_floor]
    for side in "ab":
        spin = np.maximum(omega if side == "a" else -omega, 0.0)
        found.append(_left(joined(f"e_volt_{side}"), [joined(f"i_{side}"), spin]) / (v["RA"] * amps))
    kin = joined("e_kin") + values.get("DELAY_POS", 0.0) * omega / ARCSEC
    runs_of = [np.concatenate([np.full(len(t.rows), float(t is u)) for t in traces]) for u in traces]
    found.append(
        _left(kin, [*runs_of, joined("i_a"), joined("i_b")])
        / (math.hypot(TURN / a.tach / a.ratio / 3.46, code) / ARCSEC)
    )
    found.append(
        float(np.sqrt(np.mean(joined("e_roller") ** 2))) / (math.sqrt(2) * math.hypot(0.2, 12**-0.5))
    )
    return max(found)


def _left(y: Array, columns: list[Array]) -> float:
    x = np.stack(columns, axis=1)
    x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
    return float(np.sqrt(np.mean((y - x @ np.linalg.lstsq(x, y, rcond=1e-10)[0]) ** 2)))


def make(order: Order, seed: int, folder: Path) -> dict[str, Any]:
    """Write run1..5.csv and rig.yaml; the truth's effects and drive."""
    number = int.from_bytes(hashlib.sha256(f"drives/{seed}/{order.key}".encode()).digest()[:4], "little")
    rng = np.random.default_rng(number)
    a = draw(rng)
    plan = runs(rng, a)
    hidden: dict[str, float] = {}
    effects: list[dict[str, Any]] = []
    drive = Drive("ra", "low", a.values, {}, {})
    traces = run_all(drive, plan, hidden, number)
    if order.names:
        name = order.names[0]
        (scaled, channel, likes), fixed, stage = effect_of(name, rng, a)
        factor, found = order.ratio, 0.0
        for _ in range(4):
            hidden = {**fixed, **{k: x * factor for k, x in scaled.items()}}
            traces = run_all(drive, plan, hidden, number)
            found = size_of(a, traces, hidden)
            if 0.9 * order.ratio < found < 1.1 * order.ratio:
                break
            factor *= float(np.clip(order.ratio / max(found, 1e-6), 0.02, 50.0))
            if name == "channel_delay":
                factor = max(factor, LEAST_DELAY_S / scaled["DELAY_POS"])
        outside = name.startswith("outside")
        effects.append({
            "name": name, "class": [name, *([] if outside else likes)], "stage": stage, "channel": channel,
            "domain": list(likes) if outside else [], "ratio": order.ratio, "measured_ratio": found,
            "parameters": {}, "reached": found, "raw": hidden, "in_catalogue": not outside,
        })  # fmt: skip
    for k, trace in enumerate(traces):
        columns = table(trace, a, np.random.default_rng([number, 7, k]))
        rows = np.column_stack(list(columns.values()))
        np.savetxt(folder / f"run{k + 1}.csv", rows, "%.10g", ",", header=",".join(columns), comments="")
    (folder / "rig.yaml").write_text(declared(rng, a, order.law))
    return {"effects": effects, "drive": a.values, "number": number}
