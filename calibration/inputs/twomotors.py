"""Tables of an axis with two motors as runs in SI, like an axis log's."""

from math import pi

import numpy as np

from calibration.arrays import Array
from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.rigchecks import ANGLES
from calibration.inputs.run import Run
from calibration.inputs.stuck import converter_end
from calibration.inputs.thresholds import FINEST, WHOLE
from calibration.inputs.train import train_of
from calibration.inputs.units import rad_per_unit
from plant.units import ARCSEC

CURRENTS = ("current_a", "current_b")


def runs_of(records: list[Run], rig: Rig) -> list[Run]:
    """The records as runs of an axis: columns in SI, the clock in s, scales from the columns' steps."""
    ratio = train_of(rig).ratio
    loop = "closed" if "reference_rate" in rig.columns else "open"
    out = []
    for r in records:
        si: dict[str, Array] = {"t": r.columns["t"]}
        steps: dict[str, float] = {}
        for name, signal in r.signals.items():
            if name == "time":
                continue
            factor = rad_per_unit(signal.unit, per_s=name != "position") if name in ANGLES else 1.0
            called = "setpoint" if name == "reference_rate" else name
            x = si[called] = r.columns[name] * (factor or 1.0)
            finest = FINEST * (float(np.nanmax(x) - np.nanmin(x)) or 1.0)
            steps[called] = signal.quantum * (factor or 1.0) if signal.quantum else finest
        for name in CURRENTS:
            if name in si and float(np.nanmin(si[name])) < -3 * steps[name]:
                pulls = "A motor pulls one way only here, and its current counts as it pulls"
                what = f"is negative. {pulls}. Give a scale of -1 or leave the column out"
                raise CalibrationInputError(r.path, what, None, r.signals[name].column)
        # files that share the position's zero are one session
        session = rig.name if rig.runs.get("origin") == "shared" else r.name
        header, scales = {"axis": rig.name, "loop": loop}, _scales(r, rig, ratio, steps)
        out.append(Run(r.name, r.path, session, si, {}, header, scales, start_s=r.start_s or 0.0))
    _end_of_currents(out)
    return out


def _end_of_currents(runs: list[Run]) -> None:
    """Give every run the end of the currents' converter, when they pile up there."""
    end = converter_end(runs, CURRENTS)
    if end is None:
        return
    for r in runs:
        r.scales["adc_end_A"] = end - r.scales["adc_A_per_count"] / 2
        rows = sum(int(np.sum(r.columns[n] >= end)) for n in CURRENTS)
        if rows:
            r.notes.append(f"{r.name}: {rows} currents stop at {end:.4g} A, left out")


def _scales(r: Run, rig: Rig, ratio: float, steps: dict[str, float]) -> dict[str, float]:
    """What the axis logs' headers say (inputs/header.py), from a table's columns."""
    assert rig.motors is not None
    windows = {n: where.window_s or r.period_s for n, where in rig.columns.items()}
    rate, motor = (windows.get(n, r.period_s) for n in ("velocity", "motor_a"))
    full = 1.0 / steps["effort"]  # steps of the effort to full supply, whole where they are all but whole
    whole = abs(full - round(full)) < WHOLE * full
    tach = 2 * pi / (steps["motor_a"] * motor) if "motor_a" in steps else 4096.0
    return {
        "sample_period_s": r.period_s,
        "velocity_window_s": rate,
        "tach_window_s": motor,
        "position_arcsec_per_count": steps["position"] / ARCSEC,
        "velocity_arcsec_per_count": steps.get("velocity", steps["position"]) * rate / ARCSEC,
        "adc_A_per_count": max(steps.get(n, 0.0) for n in CURRENTS) or 1e-3,
        "adc_end_A": float("inf"),
        "tach_counts_per_turn": tach,
        "effort_full_scale": float(round(full)) if whole else full,
        "supply_V": rig.supply_V or float(np.nanmean(r.columns["supply"])),
        "counter_torque": rig.motors.counter_torque,
        "gear_ratio": ratio,
    }
