"""Notes on a response beside its effects: what its filter takes, what this motion cannot tell."""

import numpy as np

from calibration.arrays import Array
from calibration.balances.balance import response_of
from calibration.balances.candidate import Candidate
from calibration.balances.floors import passed
from calibration.balances.slowoffset import SLOW
from calibration.balances.view import WINDOW, View
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from calibration.names import NAMES
from calibration.names.scene import Scene
from calibration.names.shaft_compliance import NAME as COMPLIANCE
from calibration.names.shaft_compliance import WINDS
from calibration.statistics.regression import inflation

# of a parameter's variance by its neighbours: over five times the error it would have alone. arithmetic
INFLATION = 30.0
MOST = 0.5  # share that is lost, from which on nobody should miss it. by definition
# that had evidence and failed elsewhere, as `Refusal.why` begins
CLOSE = ("cross-validated gain is within luck", "makes the held-out", "no held-out")


def filtered(view: View) -> tuple[str, bool]:
    """The share of the response's own column that the filter takes away, and whether that is most of it."""
    y = response_of(view, 0.0)[0]
    rows = view.rows[view.ok[view.rows]]
    if view.filter.sigma <= 0 or len(rows) < 2 or np.var(y[rows]) == 0:
        return "", False
    lost = 1 - float(np.var(view.filter(y, view.segment)[rows]) / np.var(y[rows]))
    width = (
        f"the filter of {WINDOW * view.sigma * view.period_s:.3g} s (`smooth_s` in the rig file sets another)"
    )
    part = f"{100 * max(lost, 0.0):.3g} %"
    return f"{width} takes {part} of the mean square of {view.response.channel} away", lost > MOST


def lacking_names(scene: Scene, kind: str) -> list[str]:
    """Names that the log has not what they need for."""
    names = [n for n in NAMES.values() if kind in n.channels]
    return [f"not looked for: {n.name}: {why}" for n in names if (why := n.lacks(scene))]


def close(s: Selection) -> list[str]:
    """Names (no smooth functions) that had evidence and failed elsewhere, each with its experiment."""
    out = []
    for r in s.refused:
        name = r.what.split(" on ")[0].split(",")[0]
        if r.why.startswith(CLOSE) and not r.what.startswith(UNKNOWN):
            hint = NAMES[name].experiment if name in NAMES else "repeat the run"
            out.append(f"{r.what} was close ({r.why}): {hint}")
    return out


def moves_with(s: Selection, bounds: list[str]) -> list[str]:
    """Parameters whose columns this motion does not move apart; from the columns, not from the response."""
    p = s.problem
    named = [x.candidate for x in s.chosen if x.candidate.kind != "line"]
    names = [label for label, _ in p.base_labels]
    names += [f"{label} of {c.name}" for c in named for label, _ in c.labels]
    columns = np.hstack([p.base, *[c.columns for c in named]])[p.train]
    size = np.linalg.norm(columns, axis=0)
    out = [
        n
        for n, v in zip(names, size, strict=False)
        if v == 0 and n != SLOW and not any(x.startswith(n + ":") for x in bounds)
    ]
    at = np.flatnonzero(size > 0)
    z = columns[:, at] / size[at]
    likeness = np.abs(z.T @ z) - np.eye(len(at))
    for k, v in enumerate(inflation(z)):
        if v > INFLATION and at[k] < len(names) and names[at[k]] != SLOW:
            out.append(f"{names[at[k]]} (moves with {names[at[int(np.argmax(likeness[k]))]]})")
    return out


def place_of(view: View, c: Candidate) -> tuple[Array, str]:
    """What an effect is drawn over."""
    at = view.rows
    size, unit = (180 / np.pi, "degrees") if view.angle_unit == "rad" else (1.0, view.angle_unit)
    if c.repeats is not None:
        turns = view.x[at] / (view.turn or 1.0) * c.repeats
        turns = turns % 1.0 if np.ptp(turns) > 1.0 else turns  # less than a turn is drawn in one piece
        return turns, f"phase of order {c.repeats:.5g}, turns"
    hertz = c.at_frequency
    if hertz is not None and "damping" not in c.fixed:  # a mode has no phase: the motion excites it
        return (view.t[at] * hertz) % 1.0, f"phase of {hertz:.5g} Hz, turns"
    if c.domain == "temperature" and "temperature" in view.columns:
        return view.columns["temperature"][at], "temperature, degC"
    effort = next((k for k in WINDS if k in view.columns), "")
    if c.domain == "current" and effort:
        said = view.rig.columns.get(effort)  # an axis log's columns are its format's
        return view.at(view.columns[effort]), f"{effort}, {said.unit}" if said else effort
    table = {
        **dict.fromkeys(("axis_angle", "motor_angle"), (size * view.x, f"position, {unit}")),
        "velocity": (size * view.speed, f"speed, {unit}/s"),
        "reversal": (size * view.since, f"travel since reversal, {unit}"),
    }
    x, label = table.get(c.domain, (view.clock, "time, s"))
    return x[at], label


def wound_up(view: View, s: Selection) -> float:
    """rms, in the response's unit, of the effort's own noise through a shaft's wind-up that was found. Its
    column is noisy, the shaft winds up by the torque. 0 where none was found."""
    for c, beta in s.fitted:
        if c.name == COMPLIANCE.name:
            channel = next(k for k in WINDS if k in view.columns)
            return abs(float(beta[0])) * (passed(view, view.columns[channel]) or 0.0)
    return 0.0
