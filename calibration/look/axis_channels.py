"""An axis with two motors, channel by channel; a fault of a column is undone and all looked at again."""

from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.filters import Filter
from calibration.balances.floors import floors_of_pair
from calibration.balances.frame import build_frame
from calibration.balances.kinematic import kinematic_problem, roller_problem
from calibration.balances.motion import Motion, motion_of
from calibration.balances.problem import Problem
from calibration.balances.thresholds import LEAST_COMPLIANCE
from calibration.balances.torque import WIDTH, Transmission
from calibration.balances.width import NYQUIST
from calibration.decide.broadband import unexplained_volts
from calibration.decide.delays import delay_findings
from calibration.decide.heldout import choose_held_out
from calibration.decide.merge import merge
from calibration.decide.parameters import parameters_of
from calibration.decide.residual import quick_lines
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.decide.tolerance import changes, train_stiffness
from calibration.finding import Finding
from calibration.inputs.declaration import Response, Rig
from calibration.inputs.declaredplant import declared_numbers
from calibration.inputs.run import Run
from calibration.look import applied
from calibration.look.axis_result import AxisResult
from calibration.look.controllerlaw import command_channel
from calibration.look.looked import Options
from calibration.look.scene import scene_of_balance
from calibration.look.torque import torque_channel
from calibration.look.volts import electrical_channel
from calibration.names import NAMES, offered
from calibration.names.command_disturbance import NAME as DISTURBANCE
from calibration.names.log_wrap import repair_wraps
from calibration.names.pair import Pair
from calibration.names.play import NAME as GAP
from calibration.names.unknown_bits import repair_stuck_bit
from plant.effects import REGISTRY
from plant.units import ARCSEC

# of the mean square of the 5 ms velocity: one count of it is ten times the interpolation error. arithmetic
FINE_MARGIN = 0.002
# times the plant's bound, beyond which a size is no size: sealed eccentricities reach twice it. ASSUMPTION
FAR = 4.0
FLOWS_A = 0.05  # A: a smaller current is cut off at zero. ASSUMPTION: eight counts
QUICK_ROWS = 1.25  # rows, standard deviation: what is quicker is within no analysis band. ASSUMPTION: 15 Hz


def analyse(runs: list[Run], rig: Rig, options: Options) -> AxisResult:
    """Run every channel the logs have; a fault of a column that is found is undone, and all is run again."""
    wraps = [w for r in runs for w in (repair_stuck_bit(r), repair_wraps(r)) if w is not None]
    result = _look(runs, rig, options)
    result.findings = [*wraps[:1], *result.findings]
    named = merge(result.findings)
    fault = next((f for f in named if f.name in applied.UNDONE), None)
    if fault is None:
        return result
    refusal = applied.too_little(result, fault)
    if refusal is not None:
        return applied.without(result, fault, refusal)
    options.tell(f"once more without the {fault.name.replace('_', ' ')}")
    again = _look(applied.corrected_runs(result, fault), rig, options)
    before = applied.before_of(result, again, fault)
    refusal = applied.judged(before, again, fault)
    if refusal is not None:
        return applied.without(result, fault, refusal)
    again.before = before
    if fault.name == GAP.name:  # the motors see the crossings that the corrected encoder leaves out
        again.selections["K"] = result.selections["K"]
        before["K"] = result.selections["K"].held.before
    applied.keep_untouched(result, again)
    taken = max(1 - (again.selections[k].held.after / b) ** 2 for k, b in before.items() if b > 0)
    stamps = [f for f in result.findings if f.domain == "clock" and f.name != fault.name]
    rest = [f for f in again.findings if f.name != fault.name and f.domain != "clock"]
    again.findings = [replace(fault, share=taken), *stamps, *rest]
    return again


def _look(runs: list[Run], rig: Rig, options: Options) -> AxisResult:
    """Every channel of repaired logs."""
    frame, tell = build_frame(runs, rig), options.tell
    held, held_names = choose_held_out(frame, options.hold_out)
    stamps = [f for n in NAMES.values() if n.stamps is not None and (f := n.stamps(frame)) is not None]
    m = motion_of(frame, WIDTH)
    numbers = declared_numbers(runs, options.plant, rig)
    result = AxisResult(numbers, frame, m, held, findings=stamps, held_out=held_names)
    tell("electrical channel")
    per_ampere, left = electrical_channel(result)
    tell("encoder channels")
    encoder_channels(result, per_ampere)
    full_rate(result)
    command_channel(result)
    tell("torque channel")
    drive = transmission(result, per_ampere, left)
    torque_channel(result, drive)
    inertia = result.calibrated["inertia"].value if "inertia" in result.calibrated else 0.0
    resistance = result.electrical.windings.resistance if result.electrical is not None else 0.0
    result.floors = floors_of_pair(m, drive, result.held, inertia, resistance)
    result.findings += delay_findings(result.selections, numbers)
    if "E" in result.selections and not result.findings:  # any effect shakes the volts, too
        turns = np.tile(m.x[m.rows] * frame.scale["gear_ratio"] / (2 * np.pi), 2)
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
        s = result.selections["K"]
        compliance, lag = (float(s.after.beta[s.problem.place(k)]) for k in ("compliance", "rotor_lag"))
        if compliance > LEAST_COMPLIANCE:
            stiffness = 1.0 / compliance
        softness = float(np.clip(-lag * ARCSEC, low / stiffness, high / stiffness))
    return Transmission(per_ampere=per_ampere, left=left, softness_s2=softness, stiffness=stiffness)


def encoder_channels(result: AxisResult, per_ampere: float) -> None:
    """Differences of encoders: motors against the axis, roller against the axis."""
    frame, m, numbers = result.frame, result.motion, result.declared
    k = result.kinematic = kinematic_problem(frame, m, result.held, per_ampere, numbers.lines)
    if k is not None:
        pair = Pair(motion=m, motor=np.repeat([0.0, 1.0], len(m.rows)))
        some = _candidates(result, "K", pair, k.problem)
        s = result.selections["K"] = _within_the_plant(k.problem, some, result.rng)
        result.collect(s)
        fitted, stiffness = train_stiffness(s, result.scale_error)
        result.findings += changes(fitted, stiffness, numbers, {"moved"})
        result.calibrated |= stiffness
    roller = roller_problem(frame, m, result.held)
    if roller is not None:
        s = _within_the_plant(roller, _candidates(result, "S", Pair(motion=m), roller), result.rng)
        result.selections["S"] = s
        result.collect(s)


def _within_the_plant(p: Problem, some: list[Candidate], rng: np.random.Generator) -> Selection:
    """Select, and again without what is by its interval larger than the plant lets it be."""
    s = select(p, some, rng)
    wild = {c.key for k, c in enumerate(s.candidates) if _beyond_the_plant(s, k)}
    return _within_the_plant(p, [c for c in some if c.key not in wild], rng) if wild else s


def _beyond_the_plant(s: Selection, k: int) -> bool:
    """Whether the whole interval of a size is far beyond the bounds of the plant's parameter of that name."""
    spec = REGISTRY.get(s.candidates[k].name)
    bounds = {(p.name, p.unit): p.high for p in spec.parameters} if spec is not None else {}
    told = parameters_of(s, k)
    return any(x.low is not None and x.low > FAR * bounds.get((n, x.unit), np.inf) for n, x in told.items())


def full_rate(result: AxisResult) -> None:
    """What only the full rate shows: the absolute encoder's interpolation, pick-up on the currents."""
    frame = result.frame
    full = motion_of(frame, 1)
    problem = roller_problem(frame, full, result.held)
    pair = Pair(motion=full)
    if problem is not None and (candidates := _candidates(result, "S1", pair, problem)):
        s = select(problem, candidates, result.rng, margin=FINE_MARGIN)
        if s.chosen:
            result.selections["S1"] = s
            result.collect(s)
    driven = any(f.name == DISTURBANCE.name for f in result.findings)  # its harmonics are no pick-up
    if not driven:
        result.findings += pick_ups(full)[:1]


def pick_ups(m: Motion) -> list[Finding]:
    """Lines of the full rate on the currents: mains, which 100 rows a second hold at half a cycle per row."""
    found: list[Finding] = []
    for name in ("current_a", "current_b") if m.frame.get("current_a") is not None else ():
        current, ok = m.frame.filled(name)
        view = replace(
            m,
            response=Response("current", "A"),
            columns=m.columns | {"current": current},
            filter=Filter(QUICK_ROWS),
            ok=m.ok & ok & (current > FLOWS_A),
            quanta={"current": m.frame.scale["adc_A_per_count"]},
        )
        found += quick_lines(view, "E", NYQUIST)
    return found


def _candidates(result: AxisResult, key: str, pair: Pair, p: Problem) -> list[Candidate]:
    fit = p.fit()
    scene = scene_of_balance(pair, p, fit.residual, p.by_name(fit.beta))
    result.views[key] = scene.view
    return offered(scene)
