"""From the true rows to the columns of the log: encoders, ADC, tachometers, clock, and what goes wrong in
them."""

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drive_runs import Trace
from tests.blind.sealer.effects_sensor import SIGNAL_PERIODS
from tests.blind.sealer.manoeuvres import COUNTS_PER_RATE
from tests.blind.sealer.slots import Array

Columns = dict[str, Array]


def temperature(trace: Trace, seed: int) -> Array:
    """Air temperature of the night, degrees C: slow cosine and a trend over 1.5 h, 0.01 degree steps."""
    rng = np.random.default_rng([seed, 5])
    t = trace.run.start_offset + 0.01 * np.arange(len(trace.rows))
    slope, swing, period, phase = (
        rng.uniform(-4.0, -1.0),
        rng.uniform(0.5, 1.5),
        rng.uniform(250, 500),
        rng.uniform(0, 6),
    )
    out: Array = np.round(12.0 + slope * t / 3600.0 + swing * np.cos(d.TURN * t / period + phase), 2)
    return out


def position_error(theta: Array, warmth: Array, v: dict[str, float]) -> Array:
    """Error of the on-shaft encoder, arcsec."""
    out = np.zeros(len(theta))
    if "ECC_1" in v:
        out += v["ECC_1"] * np.cos(theta - v["ECC_1_PH"]) + v["ECC_2"] * np.cos(2 * theta - v["ECC_2_PH"])
    if "SUB_1" in v:
        x = SIGNAL_PERIODS * theta
        out += v["SUB_1"] * np.sin(x + v["SUB_1_PH"]) + v["SUB_2"] * np.sin(2 * x + v["SUB_2_PH"])
    if "PLAY" in v:
        out += gap(theta, v["PLAY"] / 2.0)
    if "DRIFT" in v:
        out += v["DRIFT"] * (warmth - 12.0)
    return out


def gap(theta: Array, half: float) -> Array:
    """Reading less axis angle behind a coupling with a gap, arcsec; the run starts in the gap's middle."""
    out = np.empty(len(theta))
    at = 0.0
    for k, step in enumerate(np.diff(theta, prepend=theta[:1]) / d.ARCSEC):
        at = min(max(at - step, -half), half)
        out[k] = at
    return out


def adc(trace: Trace, side: str, drive: Drive, v: dict[str, float], rng: np.random.Generator) -> Array:
    """Counts of one current channel."""
    counts = trace[f"i_{side.lower()}_log"] / d.ADC_A_PER_COUNT
    counts = counts * (1.0 + v.get(f"ADC_GAIN_{side}", 0.0)) + v.get(f"ADC_OFF_{side}", 0.0)
    if "MAINS" in v and v["MAINS_SIDE"] == float(side == "B"):
        t = trace.run.t_session + 0.01 * np.arange(len(counts)) * (1 + drive.noise["ppm"] * 1e-6)
        counts = counts + v["MAINS"] * np.sin(d.TURN * v["MAINS_F"] * t)
    counts = counts + drive.noise["adc"] * rng.standard_normal(len(counts))
    out: Array = np.clip(np.round(counts), 0, d.ADC_TOP)
    return out


def columns(trace: Trace, drive: Drive, v: dict[str, float], seed: int, index: int) -> Columns:
    """All columns of one run, before losses and wraps."""
    rng = np.random.default_rng([seed, 2, index])
    n = len(trace.rows)
    shake = np.hypot(drive.noise["stamp_s"], v.get("JITTER", 0.0))
    late = shake * (3.0 + np.clip(rng.standard_normal(n), -3.0, 3.0))
    t = np.maximum.accumulate(0.01 * np.arange(n) + late)
    warmth = temperature(trace, seed)
    per_arcsec = d.POSITION_COUNTS / 1_296_000.0
    angle = trace["theta_log"] / d.TURN * d.POSITION_COUNTS
    angle = angle + position_error(trace["theta"], warmth, v) * per_arcsec
    angle = angle + drive.noise["position"] * rng.standard_normal(n)
    out: Columns = {
        "t": t,
        "setpoint": trace["setpoint"] / COUNTS_PER_RATE if trace.run.loop == "closed" else np.full(n, np.nan),
        "effort": trace["effort"],
        "position": np.mod(np.floor(angle), d.POSITION_COUNTS),
        "velocity": trace["velocity"],
        "adc_a": adc(trace, "A", drive, v, rng),
        "adc_b": adc(trace, "B", drive, v, rng),
    }
    for name, phi in (("tach_a", trace["phi_a"]), ("tach_b", trace["phi_b"])):
        count = np.floor(phi / d.TURN * d.TACH_COUNTS)
        out[name] = np.diff(count, prepend=count[:1])
    if "DRIFT" in v:
        out["temperature"] = warmth
    return out


def spoil(out: Columns, v: dict[str, float], seed: int, index: int) -> Columns:
    """Lost packets, repeated samples, early wraps and saturation."""
    rng = np.random.default_rng([seed, 3, index])
    if "WRAP" in v:
        name = ("velocity", "position", "adc_a")[int(v["WRAP_KIND"])]
        x = out[name]
        if name == "velocity":  # signed counter too short for the fastest samples
            bits = 2.0 ** np.ceil(np.log2(max(np.quantile(np.abs(x), 1.0 - v["WRAP"] * 2), 8.0)))
            out[name] = np.mod(x + bits / 2, bits) - bits / 2
        elif name == "position":  # upper bits missing
            out[name] = np.mod(x, 2**24)
        else:
            out[name] = np.minimum(x, np.quantile(x, 1.0 - v["WRAP"] * 2))
    if "LOSS" in v:
        n = len(out["t"])
        keep = np.ones(n, dtype=bool)
        lost = rng.random(n // 25 + 1) < v["LOSS"]
        lost[0] = False
        if not lost.any():
            lost[len(lost) // 2] = True
        for packet in np.flatnonzero(lost):
            span = slice(packet * 25, min(n, packet * 25 + 25))
            if v["LOSS_REPEAT"]:
                for name in out:
                    if name != "t":
                        out[name][span] = out[name][packet * 25 - 1]
            else:
                keep[span] = False
        out = {name: x[keep] for name, x in out.items()}
    return out
