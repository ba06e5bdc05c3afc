"""Logs of another telescope's azimuth with two motors, made by the blind tests' simulator with numbers of its
own (azimuth.yaml), as a table in degrees, rpm, mA and per cent."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plant.units import ARCSEC
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drive_runs import Trace, run_all
from tests.blind.sealer.manoeuvres import Run, piecewise

RIG = Path(__file__).with_name("azimuth.yaml")
RATIO = 360 / 18 * 91 / 15 * 71 / 12
TAPE = 80e6 / (2 * math.pi)  # counts per rad
TICK_S = 0.005
CODES = 2**26  # of the encoder on the axis
TACH = 2000  # counts per motor turn
AMPERE = 0.003  # per count
VALUES = {
    "J": 430.0,
    "SIG0": 2.1e6,
    "SIG1": 800.0,
    "SIG2": 880.0,
    "TC": 41.0,
    "TS": 73.0,
    "VS": 5.8e-4,
    "DELTA": 2.0,
    "RATIO": RATIO,
    "KGEAR": 2.1e6,
    "CGEAR": 2 * 0.3 * math.sqrt(2.1e6 * 2e-4) * RATIO,
    "HALF_GAP": math.radians(12.0) / RATIO / 2,
    "JM": 2.0e-4,
    "KA": 0.121,
    "KB": 0.121,
    "RA": 1.37,
    "RB": 1.37,
    "L": 2.0e-3,
    "V0": 36.0,
    "COUNTER": 0.2,
    "KP_Q12": 3400.0,
    "KI_Q12": 115.0,
    "TICK": TICK_S,
    "ROLLER_SCALE": TAPE,
    "ROLLER_NOISE": 0.2,
    "TH_START": 1.1,
    "WARM_TAU": 100.0,
    "HEAT_TAU": 100.0,
    "CABLE_SCALE": 0.1,
}


def runs() -> list[Run]:
    """Steps of the rate, long sweeps, a ramp through zero and tracking; rates in arcsec/s."""
    counts = ARCSEC * TAPE * TICK_S  # per tick, of 1 arcsec/s
    rates = [
        ([(v * s, 9.0) for v in (400.0, 1200.0, 3000.0) for s in (1.0, -1.0)], 2400.0),
        ([(5000.0, 20.0), (-5000.0, 20.0), (9000.0, 10.0), (-9000.0, 10.0)], 2400.0),
        ([(900.0, 0.5), (-900.0, 0.5)] * 2, 130.0),
        ([(15.0, 25.0), (100.0, 9.0), (-15.0, 25.0), (-100.0, 9.0)], 2400.0),
        ([(600.0, 9.0), (-600.0, 9.0), (2400.0, 9.0), (-2400.0, 9.0)], 2400.0),
    ]
    out, clock = [], 0.0
    for k, (points, slope) in enumerate(rates):
        command = piecewise([(0.0, 1.0), *points, (0.0, 1.0)], slope) * counts
        out.append(Run(f"run{k}", "closed", command, "a", clock, clock))
        clock += len(command) * TICK_S + 30.0
    return out


def write(
    folder: Path, effects: dict[str, float], seed: int = 1, drive: dict[str, float] | None = None
) -> list[Path]:
    """The tables of one night with these effects (the simulator's slots) on this drive."""
    values = {**VALUES, **(drive or {})}
    traces = run_all(Drive("ra", "low", values, {}, {}), runs(), effects, seed)
    out = []
    for k, trace in enumerate(traces):
        table = _columns(trace, np.random.default_rng([seed, k]))
        path = folder / f"{trace.run.kind}.csv"
        rows = np.column_stack(list(table.values()))
        np.savetxt(path, rows, "%.9g", ",", header=",".join(table), comments="")
        out.append(path)
    return out


def _columns(trace: Trace, rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    n = len(trace.rows)
    codes = np.floor(trace["theta_log"] / (2 * math.pi) * CODES + 0.4 * rng.standard_normal(n))
    out = {
        "ms": 10.0 * np.arange(n),
        "az_deg": np.mod(codes, CODES) * 360.0 / CODES,
        "tape_deg_s": np.degrees(trace["velocity"] / TAPE / TICK_S),
        "demand_deg_s": np.degrees(trace["setpoint"] / TAPE / TICK_S),
        "pwm_percent": trace["effort"] / 30.0,
    }
    for side, name in (("a", "east"), ("b", "west")):
        counts = np.round(trace[f"i_{side}_log"] / AMPERE + 0.7 * rng.standard_normal(n))
        out[f"{name}_mA"] = np.clip(counts, 0, 4095) * AMPERE * 1000
        turned = np.floor(trace[f"phi_{side}"] / (2 * math.pi) * TACH)
        out[f"{name}_rpm"] = np.diff(turned, prepend=turned[:1]) / TACH / 0.01 * 60
    return out
