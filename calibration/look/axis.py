"""An axis with two motors: its channels as balances, what they lack, what its motion cannot tell."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from calibration.balances.thresholds import LEAST_TRAVEL
from calibration.decide.controls import controls, tooth_more_or_less
from calibration.decide.heldout import declared_residual
from calibration.decide.merge import merge, traces
from calibration.decide.residual import Place
from calibration.decide.selection import Selection
from calibration.decide.thresholds import AXIS_EARNED
from calibration.decide.tolerance import CHANGES, ELECTRICAL_ERROR, held_numbers
from calibration.decide.withdraw import against_nature, failed_controls, withdraw
from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Rig
from calibration.inputs.run import Run
from calibration.look import looked
from calibration.look.axis_channels import analyse
from calibration.look.axis_result import SENSORS, AxisResult
from calibration.look.lacks import COLUMNS, lacks, not_identifiable
from calibration.look.looked import Balance, Looked, Options, Spectrum
from calibration.look.said import place_of
from calibration.names.name import TOLERANCE
from calibration.statistics.tails import rms
from plant.units import ARCSEC

LEAST_ROWS = 600  # 6 s: fewer rows say nothing about six parameters. ASSUMPTION
# of the rows between first and last stamp; with fewer, nothing is a measured motion any more. ASSUMPTION
LEAST_PRESENT = 0.25

NEED = "a log of 80 s and more that moves, at two speeds in both directions, without gaps"


def look_at_axis(runs: list[Run], rig: Rig, options: Options) -> Looked:
    """Every channel, and what the answer is made of; logs that say nothing get that answer and its reason.

    A drive whose logs are tables has no plant file that the emulator could run.
    """
    axis = runs[0].header["axis"]
    emulated = rig.format == "axis-log"
    title = f"{axis.upper()} axis, {runs[0].header.get('preload', 'low')} preload" if emulated else axis
    header = runs[0].header if emulated else None
    reason = too_little(runs)
    if reason:
        return Looked.nothing(title, reason, NEED, header)
    result = analyse(runs, rig, options)
    named = merge(result.findings)
    balances = [_balance(result, key, s, {f.name for f in named}) for key, s in result.selections.items()]
    tried = [row for b in balances for row in b.controls]
    effects, withdrawn = withdraw(named, failed_controls(tried), against_nature(result.selections))
    before = result.before | within_tolerance(result, effects)
    balances = [_with_missing(result, replace(b, before=before.get(b.key))) for b in balances]
    doubts = [f"{what} was close, but {why}" for _, what, why in withdrawn]
    absent = {key: what for key, what in COLUMNS.items() if key not in result.selections}
    effects, needs = looked.unnamed_where_missing(effects, [*lacks(result, balances), *doubts], balances)
    return Looked(
        title=title,
        balances=balances,
        effects=effects,
        needs=needs,
        held_out=result.held_out,
        not_identifiable=not_identifiable(result),
        refused=[*withdrawn, *traces(result.findings, named), *result.refused],
        notes=[
            *(n for r in runs for n in r.notes),
            *(f"channel {key} was not looked at: the log lacks {what}" for key, what in absent.items()),
        ],
        earned=AXIS_EARNED if emulated else None,
        header=header,
        axis=result,
    )


def _balance(result: AxisResult, key: str, s: Selection, names: set[str]) -> Balance:
    """What is said of one channel; its controls are tried where an effect that keeps its name was chosen."""
    theta = result.motion.x[result.motion.rows] / (2 * np.pi)
    numbers: dict[str, Parameter] = {}
    if key == "E":
        numbers = looked.calibrated(s, ("electrical_lag",), ELECTRICAL_ERROR)
    elif key == ("T" if "T" in result.selections else "K"):
        numbers = result.calibrated
    tried = any(c.name in names for c in s.candidates)
    turns = np.resize(theta, len(s.problem.y)) if key in "TSEK" else None
    return Balance(
        key=key,
        row=SENSORS.get(key),
        selection=s,
        floor=result.floors.get(key),
        numbers=numbers,
        controls=controls(s, tooth_more_or_less(turns, float(np.ptp(theta)))) if tried else (),
        over=partial(place_of, result.views[key])
        if key in result.views
        else lambda _: (s.problem.t, "time, s"),
        spectrum=Spectrum(turns=theta, stages=result.frame.train.orders, label="cycles per axis turn")
        if key == "T"
        else None,
    )


def _with_missing(result: AxisResult, b: Balance) -> Balance:
    """With the domain that a channel's residual above its floor lives in."""
    m, rows = result.motion, len(b.selection.problem.y)
    turn, rate = m.x[m.rows] / (2 * np.pi), m.speed[m.rows] / ARCSEC
    places = [
        Place("axis angle", "axis_angle", turn),
        Place("speed and direction", "velocity", np.sign(rate) * np.log1p(np.abs(rate))),
        Place("time", "time", result.frame.t[m.rows]),
        Place("motor angle", "motor_angle", (turn * result.frame.train.ratio) % 1.0),
    ]
    times, rest = divmod(rows, len(m.rows))
    long = [] if rest else [one._replace(x=np.resize(one.x, rows)) for one in places]
    return replace(b, missing=looked.missing_over(b, long, times))


def too_little(runs: list[Run]) -> str:
    """Why these logs cannot say anything; empty when they can."""
    rows = sum(r.rows for r in runs)
    if rows < LEAST_ROWS:
        return f"{rows} rows ({rows * 0.01:.1f} s) are too few to say anything (at least {LEAST_ROWS})"
    span = sum(r.duration_s for r in runs) / runs[0].scales["sample_period_s"]
    if rows < LEAST_PRESENT * span:
        return f"{100 * (1 - rows / span):.0f} % of the samples are missing: what is left is not a motion"
    moved = max(float(np.nanmax(r.columns["position"]) - np.nanmin(r.columns["position"])) for r in runs)
    if moved < LEAST_TRAVEL:
        return "the axis does not move in these logs"
    return ""


def within_tolerance(result: AxisResult, effects: Sequence[Finding]) -> dict[str, float]:
    """Per channel, the held-out error "before" where a declared number is another one. The numbers that are
    changed may only be re-calibrated within the tolerance of the declared ones."""
    out, names = {}, {f.name for f in effects}
    t, k = result.selections.get("T"), result.selections.get("K")
    if t is not None and result.torque is not None:
        fixed = held_numbers(names, t.problem, t.after.beta, result.declared, result.torque.friction)
        if fixed:
            out["T"] = rms(declared_residual(t.problem.holding(fixed)))
    if k is not None and any("stiffness" in CHANGES[name].numbers for name in names if name in CHANGES):
        declared, place = result.declared.stiffness, k.problem.place("compliance")
        value = float(np.clip(k.after.beta[place], 1 / declared / TOLERANCE, TOLERANCE / declared))
        out["K"] = rms(declared_residual(k.problem.holding({place: value})))
    return out
