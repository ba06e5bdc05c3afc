"""Residual-to-floor ratio of an effect: its own contribution, less what a re-calibration could take up,
over the floor.

Channels: T torque at the axis (N m), E volts of each motor, K difference of encoders (arcsec), S the column
itself.
"""

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drive_runs import Trace
from tests.blind.sealer.sensors import position_error, temperature
from tests.blind.sealer.slots import Array

ROW_S = 0.01


def floors(drive: Drive) -> dict[str, float]:
    """What quantisation and noise of the sensors leave in one 10 ms row."""
    v, noise = drive.values, drive.noise
    adc_counts = float(np.hypot(noise["adc"], 12**-0.5))
    amps = adc_counts * d.ADC_A_PER_COUNT
    lsb_rad = d.TURN / d.POSITION_COUNTS
    position_rad = float(np.hypot(noise["position"], 12**-0.5)) * lsb_rad
    acceleration = np.sqrt(6.0) * position_rad / ROW_S**2  # second difference of three samples
    torque = np.hypot(v["KA"] * d.GEAR_RATIO * amps * np.sqrt(2.0), v["J"] * acceleration)
    tach_rad = d.TURN / d.TACH_COUNTS / np.sqrt(12.0)
    volt = np.hypot(v["RA"] * amps, v["KA"] * np.sqrt(2.0) * tach_rad / ROW_S)
    return {
        "T": float(torque),
        "E": float(volt),
        "K": float(np.hypot(tach_rad / d.GEAR_RATIO, position_rad) / d.ARCSEC),
        "velocity": float(np.sqrt(2.0) * np.hypot(v["ROLLER_NOISE"], 12**-0.5)),
        "position": position_rad / d.ARCSEC,
        "adc": adc_counts,
        "effort": float(v["KP_Q12"] / 4096.0 * np.sqrt(2.0) * np.hypot(v["ROLLER_NOISE"], 12**-0.5)),
    }


def left(y: Array, regressors: list[Array]) -> float:
    """Rms of y after least squares on the regressors."""
    if not np.any(y):
        return 0.0
    a = np.stack(regressors, axis=1)
    scale = np.sqrt(np.mean(a * a, axis=0)) + 1e-300
    solution, *_ = np.linalg.lstsq(a / scale, y, rcond=1e-10)
    return float(np.sqrt(np.mean((y - a / scale @ solution) ** 2)))


def join(traces: list[Trace], name: str) -> Array:
    """One column over all runs."""
    return np.concatenate([trace[name] for trace in traces])


def ratios(drive: Drive, traces: list[Trace], v: dict[str, float], seed: int) -> dict[str, float]:
    """Ratio per channel for these effect values."""
    floor = floors(drive)
    omega = join(traces, "omega")
    way = np.tanh(omega / (3.0 * d.ARCSEC))
    fade = way * np.exp(-((omega / drive.values["VS"]) ** 2))
    alpha = np.concatenate([np.gradient(trace["omega"], ROW_S) for trace in traces])
    currents = {s: join(traces, f"i_{s.lower()}") for s in "AB"}
    torque, volts = join(traces, "e_torque"), {s: join(traces, f"e_volt_{s.lower()}") for s in "AB"}
    out: dict[str, float] = {}
    for s, sign in (("A", 1.0), ("B", -1.0)):
        extra = v.get(f"ADC_GAIN_{s}", 0.0) * currents[s] + v.get(f"ADC_OFF_{s}", 0.0) * d.ADC_A_PER_COUNT
        if "MAINS" in v and v["MAINS_SIDE"] == float(s == "B"):
            extra = extra + v["MAINS"] * 0.7 * d.ADC_A_PER_COUNT * np.resize([1.0, -1.0], len(omega))
        torque = torque + sign * drive.values["KA"] * d.GEAR_RATIO * extra
        volts[s] = volts[s] - drive.values["RA"] * extra
    figures = [join(traces, f"f_{name}") for name in ("coulomb", "stiction", "stiffness", "stribeck")]
    friction = figures if np.any(figures) else [way, fade]  # of a friction effect: along its own motion
    out["T"] = left(torque, [*friction, omega, alpha]) / floor["T"]
    spins = {"A": np.maximum(omega, 0) * d.GEAR_RATIO, "B": np.maximum(-omega, 0) * d.GEAR_RATIO}
    out["E"] = max(left(volts[s], [currents[s], spins[s]]) / floor["E"] for s in "AB")
    kin = join(traces, "e_kin")
    errors = [position_error(trace["theta"], temperature(trace, seed), v) for trace in traces]
    late = v.get("DELAY_POS", 0.0) + v.get("DELAY_TACH", 0.0)
    kin = kin + late * omega / d.ARCSEC
    if "SUB_1" not in v:
        kin = kin + np.concatenate(errors)
    runs = [np.concatenate([np.full(len(t.rows), float(t is u)) for t in traces]) for u in traces]
    out["K"] = left(kin, [*runs, currents["A"], currents["B"]]) / floor["K"]
    out["S"] = sensor_ratio(traces, v, errors, floor)
    return out


def sensor_ratio(
    traces: list[Trace], v: dict[str, float], errors: list[Array], floor: dict[str, float]
) -> float:
    """The S channel: the column's own error over the column's floor."""
    found = [0.0]
    if "SUB_1" in v:
        found.append(float(np.std(np.concatenate(errors))) / floor["position"])
    if "JITTER" in v:
        found.append(
            float(np.sqrt(np.mean(join(traces, "omega") ** 2))) / d.ARCSEC * v["JITTER"] / floor["K"]
        )
    if "ROLLER_EPS" in v or "SLIP_C" in v:
        found.append(float(np.sqrt(np.mean(join(traces, "e_roller") ** 2))) / floor["velocity"])
    if "DELAY_VEL" in v:
        rate = np.concatenate([np.gradient(trace["velocity"], ROW_S) for trace in traces])
        slow = np.convolve(rate, np.full(10, 0.1), mode="same")  # the quantum's own noise is not the effect
        found.append(float(np.sqrt(np.mean(slow**2))) * v["DELAY_VEL"] / floor["velocity"])
    if "DELAY_ADC" in v:
        rate = np.concatenate([np.gradient(trace["i_a"], ROW_S) for trace in traces]) / d.ADC_A_PER_COUNT
        found.append(float(np.sqrt(np.mean(rate**2))) * v["DELAY_ADC"] / floor["adc"])
    if "UPSET" in v:
        found.append(v["UPSET"] / np.sqrt(2.0) / floor["effort"])
    if "PULSE" in v:
        counts = np.concatenate([trace.inputs.hidden for trace in traces])
        found.append(float(np.std(counts)) / floor["velocity"])
    return max(found)
