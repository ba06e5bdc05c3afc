"""The corrected plant file of an axis, and the closed loop run again with it."""

from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.view import View
from calibration.decide.parameters import parameters_of
from calibration.decide.selection import Selection
from calibration.decide.thresholds import MODEL_ERROR
from calibration.finding import UNKNOWN, Curve, Finding, Parameter
from calibration.inputs.declaredplant import declared_model
from calibration.inputs.train import MESH, SHAFT
from calibration.look.axis_result import AxisResult
from calibration.look.looked import Looked, Options
from calibration.names.inplant import Facts
from calibration.names.unknown import SLOW_RATE
from calibration.replay.before import before_numbers, with_declared_lines
from calibration.replay.held import Replay, replay
from calibration.replay.plantfile import calibrate_model, write_plant
from calibration.statistics.tails import student_reach
from plant import compensation
from plant.evaluate import evaluate_function
from plant.gears import RATIO
from plant.model import PlantModel, load, with_effects

POINTS = 24  # knots: three for each of a smooth function's eight splines. ASSUMPTION
STIFF = 1e-6  # part of the normal matrix: holds knots in a gap of the data to a straight line. ASSUMPTION


def correct_and_replay(found: Looked, options: Options) -> Replay:
    """Write the corrected plant and the compensation, run the held-out loop again; its reasons say what the
    file lacks. Nothing is written or run for a drive that the emulator does not run."""
    if found.header is None:
        return Replay()
    axis, out = found.header["axis"], options.out / "plant.yaml"
    model, keep = declared_model(found.header, options.plant)
    if not keep:
        model = with_effects(model, axis, ())
    if found.axis is None:  # the logs say nothing
        write_plant(out, model, {}, [], Facts("cannot tell", axis), [])
        return Replay()
    result, unsure, effects = found.axis, found.unsure, list(found.effects)
    name = result.frame.runs[0].name
    calibrated, t = found.calibrated, result.selections.get("T")
    facts = facts_of(result, calibrated, model, name)
    bare = with_declared_lines(model, axis, result, t.after if t else None)
    corrected, remarks = write_plant(out, bare, calibrated, effects, facts, unsure)
    compensation.write(options.out / "compensation.yaml", load(out), axis)
    again = Replay()
    if options.replay:
        options.tell("running the closed loop again")
        numbers = before_numbers(result, calibrated, effects)
        bare = with_declared_lines(model, axis, result, t.before if t else None)
        declared, _ = calibrate_model(bare, axis, numbers, name, unsure)
        per_ampere = result.torque.drive.per_ampere if result.torque is not None else 0.0
        e = result.selections.get("E")
        mean = result.declared.ripple is not None
        mean |= e is not None and "current_ripple" in [label for label, _ in e.problem.base_labels]
        again = replay(result.frame, result.held, declared, corrected, per_ampere, mean)
    return replace(again, reasons=[*again.reasons, *remarks])


def with_curves(found: Looked) -> Looked:
    """With its curve for every `unknown` of an axis' torque that is a function of its domain."""
    result = found.axis if found.header is not None else None
    if result is None or "T" not in result.selections:
        return found
    t, view = result.selections["T"], result.views["T"]
    places = {(c.candidate.name, c.candidate.domain): k for k, c in reversed(list(enumerate(t.chosen)))}

    def drawn(f: Finding) -> Finding:
        if f.name != UNKNOWN or f.channel != "T" or (f.name, f.domain) not in places:
            return f
        return replace(f, curve=curve_of(t, places[f.name, f.domain], view))

    return replace(found, effects=[drawn(f) for f in found.effects])


def facts_of(result: AxisResult, calibrated: dict[str, Parameter], model: PlantModel, name: str) -> Facts:
    """What the plant file's terms need beside the findings."""
    axis = result.frame.runs[0].header["axis"]
    part = getattr(model.axes, axis)
    theta = result.motion.x[result.motion.rows]
    loop = calibrated.get("resistance")
    resistance = loop.value if loop is not None else part.motor.loop
    return Facts(
        name,
        axis,
        middle=float(theta.mean()),
        span=float(np.ptp(theta)),
        duration_s=float(np.ptp(result.frame.t[result.motion.rows])) or 1.0,
        half_play=0.5 * part.gear.backlash.si * RATIO,
        resistance=resistance,
        winding=max(resistance - part.motor.loop + part.motor.resistance.si, 0.1),
        per_ampere=result.torque.drive.per_ampere if result.torque is not None else 140.0,
        supply=result.frame.scale["supply_V"],
        warming=model.environment.warming.si,
        twists=twists(result),
    )


def twists(result: AxisResult) -> dict[tuple[str, int], tuple[float, float]]:
    """Gear lines of the encoder channel that both trains show: (stage, harmonic) -> (arcsec, phase)."""
    k_channel = result.selections.get("K")
    out: dict[tuple[str, int], tuple[float, float]] = {}
    if k_channel is None:
        return out
    for k, c in enumerate(chosen.candidate for chosen in k_channel.chosen):
        first, second = np.array_split(c.columns, 2)
        if c.name in (SHAFT, MESH) and c.stage is not None and np.any(first) and np.any(second):
            p = parameters_of(k_channel, k)
            out[c.stage, c.harmonic or 1] = (p["amplitude"].value, p["phase"].value)
    return out


def knots_over(domain: str, u: Array) -> Array:
    """Knots over the range of `u`, denser around zero speed."""
    low, high = float(u.min()), float(u.max())
    if domain != "velocity":
        return np.linspace(low, high, POINTS)
    first, last = (float(np.sign(x) * np.log1p(abs(x) / SLOW_RATE)) for x in (low, high))
    z = np.linspace(first, last, POINTS)
    return np.asarray(np.sign(z) * np.expm1(np.abs(z)) * SLOW_RATE)


def curve_of(s: Selection, index: int, view: View) -> Curve | None:
    """The torque on the axis that chosen effect `index` adds, over its domain; None where it is no function.

    Least squares of the plant's own interpolation through the effect's contribution on training rows. The
    half-widths follow from the covariance of its coefficients, with Student's reach over blocks.
    """
    chosen, rows = s.chosen[index].candidate, s.problem.train
    signals = {**view.columns, "axis_angle": view.x, "velocity": view.speed, "time": view.clock}
    torque = chosen.domain == "current"  # in whose stead the plant has the torque
    if chosen.kind == "line" or not (torque or chosen.domain in signals):
        return None
    domain = "torque" if torque else chosen.domain
    u = (s.problem.y if torque else signals[domain][view.rows])[rows]
    x = chosen.columns[rows]
    y = -(x @ s.sizes(index))
    variance = np.einsum("ij,jk,ik->i", x, s.covariance(index), x)
    if float(np.ptp(u)) <= 0.0:
        return None
    knots = knots_over(domain, u)
    basis = np.column_stack([evaluate_function(knots, e, u) for e in np.eye(len(knots))])
    bend = np.diff(np.eye(len(knots)), 2, axis=0)
    weight = STIFF * float(np.trace(basis.T @ basis)) / len(knots)
    normal = basis.T @ basis + weight * bend.T @ bend
    values = np.linalg.solve(normal, basis.T @ y)
    spread = np.sqrt(np.maximum(np.linalg.solve(normal, basis.T @ variance), 0.0))
    blocks = max(int(rows.sum() / s.problem.block), 5)
    half = student_reach(max(blocks - 2, 3)) * np.hypot(spread, MODEL_ERROR * values)
    return Curve(domain, "N m", tuple(map(float, knots)), tuple(map(float, values)), tuple(map(float, half)))
