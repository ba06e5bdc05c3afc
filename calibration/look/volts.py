"""An electrical balance: its names, the motors' numbers, and what each current makes of torque."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.bridge import mean_currents, undo_sampling
from calibration.balances.candidate import Candidate
from calibration.balances.electrical import electrical_problem
from calibration.balances.kinematic import wind_up
from calibration.balances.problem import Problem
from calibration.balances.thresholds import FEWEST_ROWS
from calibration.balances.view import View
from calibration.balances.volts import volts_balance
from calibration.decide.drive import worth_little
from calibration.decide.energy import signed
from calibration.decide.parameters import findings_of
from calibration.decide.residual import beyond_names, left_over, settle
from calibration.decide.rules import leave_out
from calibration.decide.select import select
from calibration.inputs.declaration import Response
from calibration.look.axis_result import AxisResult
from calibration.look.looked import Balance, calibrated
from calibration.look.said import lacking_names
from calibration.look.scene import scene_of_balance
from calibration.names import NAMES, offered
from calibration.names.pair import Pair
from calibration.names.scene import VOLTS, Scene

# standard error of the torque constant, of itself, beyond which the declared one is used. ASSUMPTION
SURE_CONSTANT = 0.1
# standard errors of the torque constant, beyond which volts show a change: five, of an onset that leaves at
# least 4 % of the rows, which tell a fifth as much. ASSUMPTION
SHOWN = 25.0
FEW_VOLTS = f"volts were not looked at: fewer than {FEWEST_ROWS} rows; a smaller `smooth_s` leaves more"
DENIED = "back EMF would show it, and does not"


def look_at_volts(view: View, balance: Problem) -> Balance | None:
    """Of a rig's one winding; None where the log has no volts or no current."""
    b = volts_balance(view, balance)
    if b is None:
        return None
    p = b.problem
    declared, residual = p.plain_fit(p.train)
    own = replace(view, response=Response("voltage", "V"))
    scene = Scene(own, p, declared, residual, np.zeros((len(p.y), 0)), windings=b.windings)
    s = leave_out(signed(select(p, offered(scene), around=True)), worth_little)
    s, together, more = beyond_names(s, scene)
    final = p.by_name(s.after.beta)
    quotients = {n: declared[n] / x for n, x in final.items() if declared[n] * x > 0}
    # the warm resistance makes the heat, the cold one is what rises; a plant file's heat is the cold one's
    quotients["resistance"] = float(np.sqrt(quotients.get("resistance", 1.0)))
    found = [NAMES[f.name].retold(f, quotients) for k in range(len(s.chosen)) for f in findings_of(s, k)]
    signs = [
        f"{name} comes out as {declared[name]:.3g}: {why} counts the other way"
        for name, why in (("resistance", "the current"), ("torque_constant", "the position"))
        if declared[name] < 0
    ]
    sure = max(b.floor, p.step) if b.floor else None  # less than meters are sure to is not "still missing"
    return Balance(
        key="E",
        row="electrical",
        selection=together,
        floor=b.floor,
        findings=settle(found + more, left_over(s, scene, sure), "E"),
        numbers=calibrated(s),
        missing=left_over(together, scene, sure),
        notes=[f"floor of the volts: {b.floor_from}", *signs, *lacking_names(scene, VOLTS)],
    )


def electrical_channel(result: AxisResult) -> tuple[float, dict[str, Array]]:
    """Two motors' findings; N m at the axis per A, and what each has left of its torque constant."""
    frame, m, numbers, clock = result.frame, result.motion, result.declared, result.frame.one_clock
    if numbers.ripple is not None and frame.get("current_a") is not None:
        undo_sampling(frame, numbers.ripple)
    softness = wind_up(frame, m, result.held, numbers)
    b = result.electrical = electrical_problem(frame, m, result.held, numbers, softness)
    if b is None or b.problem.train.sum() <= FEWEST_ROWS:
        constant = b.windings.constant if b is not None else numbers.torque_constant
        return constant * frame.scale["gear_ratio"], weakened([], clock)
    p, w = b.problem, b.windings
    declared = {"resistance": w.resistance, "torque_constant": w.constant}
    pair = Pair(motion=m, motor=np.repeat([0.0, 1.0], len(m.rows)))
    scene = scene_of_balance(pair, p, p.fit().residual, declared)
    scene.windings, result.views["E"] = w, scene.view
    s = result.selections["E"] = select(p, offered(scene), result.rng, around=True)
    mean_currents(frame, p, s.after)
    fit = p.named(s.after)
    constant, spread = fit["torque_constant"].value, fit["torque_constant"].error
    quotient = {"resistance": w.resistance / fit["resistance"].value, "torque_constant": 1.0}
    if spread > SURE_CONSTANT * constant:  # one speed, not apart from the resistance; or no motor at all
        constant = numbers.torque_constant
    else:
        result.scale_error = result.constant_error = spread / abs(constant)
        quotient["torque_constant"] = w.constant / constant
    left = weakened(s.fitted, clock, quotient["torque_constant"])
    result.scale_error = float(np.hypot(result.scale_error, reading_error(s.fitted)))
    result.collect(s, quotient)
    return constant * frame.scale["gear_ratio"], left


def volts_deny(result: AxisResult, c: Candidate, size: float) -> bool:
    """Whether an effect of the torque is a share of the torque constant that volts would show."""
    kept, shown = NAMES[c.name].torque_kept, SHOWN * result.constant_error  # 0: volts have not told it
    if kept is None or not NAMES[c.name].beside.of_constant:
        return False
    lost = 1.0 - float(np.min(kept(c, size, result.frame.one_clock, 1.0)))  # of a ramp, what this log sees
    return 0 < shown < lost


def weakened(
    chosen: Sequence[tuple[Candidate, Array]], clock: Array, quotient: float = 1.0
) -> dict[str, Array]:
    """Part of what its current reads that each motor makes torque of, (n,) over `clock`, from the accepted
    effects. `quotient` is that of the torque constant, as in `Name`."""
    out = {"a": np.ones(len(clock)), "b": np.ones(len(clock))}
    for c, beta in chosen:
        kept = NAMES[c.name].torque_kept
        if kept is not None:
            part, (motor, _) = kept(c, float(beta[0]), clock, quotient), c.fixed.get("motor", (0.0, ""))
            out = {key: x * part if motor in (0.0, k) else x for k, (key, x) in enumerate(out.items(), 1)}
    return out


def reading_error(chosen: Sequence[tuple[Candidate, Array]]) -> float:
    """Relative standard error of all torques from a current's gain."""
    return max((NAMES[c.name].torque_doubt * abs(float(beta[0])) for c, beta in chosen), default=0.0)
