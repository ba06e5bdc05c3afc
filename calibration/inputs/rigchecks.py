"""What a rig file's schema cannot say: what holds between the values of several fields."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import JOINTS, Motors, Rig
from calibration.inputs.units import rad_per_unit

#: channels beside motors that are an angle (position) or an angle per s
ANGLES = ("position", "velocity", "motor_a", "motor_b", "reference_rate")


def check(rig: Rig, data: dict[str, Any]) -> None:
    """Refuse, with one line, what contradicts itself or has no effect in `data`, of which `rig` was made."""
    if wrong := next(_one_drive(rig, data) if rig.motors is None else _two_motors(rig, rig.motors), None):
        raise CalibrationInputError(rig.path, wrong)


def _two_motors(rig: Rig, motors: Motors) -> Iterator[str]:
    """Columns in units that SI can be had from, inertias in order."""
    if motors.rotor_inertia != tuple(sorted(motors.rotor_inertia)):
        yield "motors.rotor_inertia_kgm2: [least, most]"
    for name in (n for n in ANGLES if n in rig.columns):
        unit, per_s = rig.columns[name].unit, name != "position"
        if rad_per_unit(unit, per_s) is None:
            what = "an angle per s" if per_s else "an angle"
            yield f"columns.{name}.unit: '{unit}', must be {what} beside motors; give a scale"


def _one_drive(rig: Rig, data: dict[str, Any]) -> Iterator[str]:
    """Checks of what is explained, and of stages, which turn with the position, or with the clock at constant
    rate. Checks also of terms that are estimated or known, the shape of friction, and columns that something
    uses."""
    columns, responses = rig.columns, rig.responses
    have, channels = ", ".join(columns), [r.channel for r in responses]
    for r in responses:
        if r.channel not in columns and r.channel != "acceleration":
            yield f"response.channel: '{r.channel}' is not among the columns ({have})"
        if r.divide_by is not None and r.divide_by not in columns:
            yield f"response.divide_by: '{r.divide_by}' is not among the columns ({have})"
        if channels.count(r.channel) > 1:
            yield f"response: '{r.channel}' is given twice"
    if "position" in channels and len(channels) > 1:
        yield "response: a position at constant rate is explained alone; leave the others out"
    period, why = "period_s", "period_s is for a drive at constant rate (response: position); give period"
    if rig.drifts:
        period, why = "period", "at constant rate the clock counts; give period_s"
    for stage in data.get("stages", []):
        if period in stage:
            yield f"stages.{stage['name']}: {why}"
    if "controller" in data and columns["reference"].unit != columns["position"].unit:
        yield "columns.reference.unit: must be the position's for a controller; give a scale"
    estimated, known = set(data.get("estimate", ())), set(data.get("constants", ()))
    force = any(r.is_force for r in responses)
    if not force and (terms := (estimated - {"offset", "drift"}) | known):
        yield f"{min(terms)}: is a term of forces, but no response is one"
    rubs = force and "coulomb" in ({*data.get("estimate", ("coulomb",))} | known)
    if "friction_law" in data and not rubs:
        yield "friction_law: is the shape of the term coulomb, which no response has; estimate it"
    parts = {term for term in known if term.startswith("gravity")}
    weighed, joints = "gravity" in estimated, [name for name in JOINTS if name in columns]
    if both := estimated & known or (parts if weighed else set()):
        yield f"constants.{min(both)}: is estimated too; a number is known or estimated"
    if "acceleration" in channels and "inertia" in estimated | known:
        yield "inertia: a response of acceleration is a balance per unit of inertia; leave it out"
    used = {"time", "position", "velocity", "acceleration", "temperature", "supply", "reference", "applied"}
    used |= {*channels} | {r.divide_by for r in responses if r.divide_by}
    used |= {"effort", "force", "current"} if "position2" in channels else set()
    used |= {"load", *JOINTS} if weighed or parts else {*JOINTS} if "inertia" in estimated else set()
    used |= {"effort"} if "controller" in data else set()
    used |= {"voltage", "duty", "current"} if {"voltage", "duty"} & set(columns) else set()
    for name, where in columns.items():
        if where.steps and any(b[0] <= a[0] for a, b in pairwise(where.steps)):
            yield f"columns.{name}.steps: must be in the order of their times"
        if where.integrated and name == "time":
            yield "columns.time.integrated: time is not integrated; leave it out"
    if parts and len(joints) > 1:
        yield f"constants.{min(parts)}: of several joints the weights are estimated; add gravity to estimate"
    if "load" in columns and not (weighed or parts):
        yield "columns.load: acts through gravity; add it to estimate"
    if ("applied" in columns) != ("applied" in estimated | known):
        yield "columns.applied and 'applied' in estimate or constants belong together; add the missing one"
    if {"offset", "offset_per_file"} <= estimated | known:
        yield "estimate: offset_per_file stands in the place of offset; leave one out"
    for name in joints:
        if columns[name].unit != columns["position"].unit:
            yield f"columns.{name}.unit: must be the position's; give a scale"
    for name in (name for name in columns if name not in used):
        yield f"columns.{name}: nothing uses it with this response; leave it out"
