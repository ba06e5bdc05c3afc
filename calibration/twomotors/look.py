"""The axis pipeline: from logs of one telescope axis to findings, channel by channel."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from pathlib import Path

import numpy as np

from calibration.candidates import axis_torque
from calibration.channels.clock import clock_findings, repair_wraps
from calibration.channels.frame import build_frame
from calibration.channels.motion import motion_of
from calibration.channels.torque import WIDTH, Transmission
from calibration.decide.broadband import unexplained_volts
from calibration.decide.delays import delay_findings
from calibration.decide.holdout import choose_held_out
from calibration.decide.merge import merge
from calibration.declaredplant import declared_numbers
from calibration.inputs.declaration import Rig
from calibration.inputs.telescope import telescope
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array, Run
from calibration.twomotors.applied import (
    before_of,
    corrected_runs,
    judged,
    keep_untouched,
    to_apply,
    too_little,
    without,
)
from calibration.twomotors.commanded import command_channel
from calibration.twomotors.encoders import encoder_channels, full_rate
from calibration.twomotors.floors import sensor_floors
from calibration.twomotors.result import AxisResult
from calibration.twomotors.torque import torque_channel
from calibration.twomotors.volts import electrical_channel


def analyse(
    runs: list[Run],
    hold_out: list[str],
    seed: int = 0,
    tell: Callable[[str], None] = lambda s: None,
    plant: Path | None = None,
    rig: Rig | None = None,
) -> AxisResult:
    """Run every channel the logs have; a fault of a column that is found is undone, and all is run again.
    `rig` declares the drive, the telescope's own axis without it; `plant` a plant file it is held against."""
    wraps = [w for w in (repair_wraps(r) for r in runs) if w is not None]
    rig = rig or telescope(runs[0].header["axis"])
    result = _look(runs, rig, hold_out, seed, tell, plant)
    result.findings = [*wraps[:1], *result.findings]
    fault = to_apply(merge(deepcopy(result.findings), result.frame.train))
    if fault is None:
        return result
    refusal = too_little(result, fault)
    if refusal is not None:
        return without(result, fault, refusal)
    tell(f"once more without the {fault.name.replace('_', ' ')}")
    again = _look(corrected_runs(result, fault), rig, hold_out, seed, tell, plant)
    before = before_of(result, again, fault)
    refusal = judged(before, again, fault)
    if refusal is not None:
        return without(result, fault, refusal)
    again.before = before
    if fault.name == "play":  # the motors see the crossings that the corrected encoder leaves out
        again.selections["K"] = result.selections["K"]
        before["K"] = result.selections["K"].held.before
    keep_untouched(result, again)
    fault.share = max(1 - (again.selections[k].held.after / b) ** 2 for k, b in before.items() if b > 0)
    stamps = [f for f in result.findings if f.domain == "clock" and f.name != fault.name]
    rest = [f for f in again.findings if f.name != fault.name and f.domain != "clock"]
    again.findings = [fault, *stamps, *rest]
    return again


def _look(
    runs: list[Run],
    rig: Rig,
    hold_out: list[str],
    seed: int,
    tell: Callable[[str], None],
    plant: Path | None,
) -> AxisResult:
    """Every channel of repaired logs."""
    rng = np.random.default_rng(seed)
    frame = build_frame(runs, rig)
    held, held_names = choose_held_out(frame, hold_out)
    stamps = clock_findings(frame)  # takes repeated rows out: they are no motion
    m = motion_of(frame, WIDTH)
    numbers = declared_numbers(runs, plant, rig)
    result = AxisResult(numbers, frame, m, held, None, None, None, held_out=held_names)
    result.findings += stamps
    clock = axis_torque.start_clock([r.header.get("start_utc", "") for r in runs], frame.t, frame.run)
    tell("electrical channel")
    per_ampere, left = electrical_channel(result, clock, rng)
    tell("encoder channels")
    encoder_channels(result, per_ampere, rng)
    full_rate(result, rng)
    command_channel(result, rng)
    tell("torque channel")
    drive = transmission(result, per_ampere, left)
    torque_channel(result, drive, clock, rng)
    result.floors = sensor_floors(result, drive)
    result.findings += delay_findings(result.selections, numbers)
    if "E" in result.selections and not result.findings:  # any effect shakes the volts, too
        turns = np.tile(m.theta[m.pick] * frame.scale["gear_ratio"] / (2 * np.pi), 2)
        left_over = result.selections["E"]
        strange = unexplained_volts(left_over.after.residual, left_over.problem, turns)
        result.findings += [strange] if strange is not None else []
    return result


def transmission(result: AxisResult, per_ampere: float, left: dict[str, Array]) -> Transmission:
    """From currents to the axis, with the trains' stiffness and the rotors' lag where encoders show them."""
    frame = result.frame
    assert frame.rig.motors is not None
    low, high = (k * frame.scale["gear_ratio"] ** 2 for k in frame.rig.motors.rotor_inertia)  # at the axis
    stiffness, softness = result.declared.stiffness, low / result.declared.stiffness
    if "K" in result.selections:
        beta = result.selections["K"].after.beta
        if beta[0] > 1e-8:
            stiffness = 1.0 / float(beta[0])
        softness = float(np.clip(-beta[1] * ARCSEC, low / stiffness, high / stiffness))
    return Transmission(per_ampere, left, softness, stiffness)
