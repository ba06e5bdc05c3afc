"""From the pipelines' results to a verdict with its error table, controls and pictures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from plant.calibration.decide.controls import controls
from plant.calibration.decide.finding import Parameter
from plant.calibration.decide.merge import merge
from plant.calibration.decide.parameters import interval
from plant.calibration.decide.select import Selection
from plant.calibration.decide.verdict import Verdict, judge
from plant.calibration.readers.rig import Rig
from plant.calibration.readers.run import Array, Run

Answer = tuple[Verdict, list[dict[str, str]], str]


#: second differences of white noise averaged twice over three rows, per variance: 6 - 8 * 4/19
AVERAGED = 6.0 - 32.0 / 19.0
SENSORS = ("torque", "voltage", "position", "velocity")


def white_floor(s: Selection) -> float:
    """rms of what changes from sample to sample in the final residual on held-out rows: the sensors'
    noise."""
    p = s.problem
    rows = p.test if p.test.sum() > 50 else p.valid
    e = np.where(rows, s.after.residual, np.nan)
    second = e[2:] - 2 * e[1:-1] + e[:-2]
    second = second[np.isfinite(second)]
    share = AVERAGED if s.problem.channel in "TEKS" and s.problem.sensor in SENSORS else 6.0
    return float(np.sqrt(np.mean(second**2) / share)) if len(second) > 20 else float(np.nanstd(e))


def error_row(s: Selection, floor: float | None = None) -> dict[str, Any]:
    """One row of the error table."""
    left = white_floor(s) if floor is None or floor <= 0 else floor
    return {
        "unit": s.problem.unit,
        "before": s.held.before,
        "after": s.held.after,
        "floor": min(left, s.held.after),
    }


def errors(name: str, s: Selection, floor: float | None = None) -> dict[str, dict[str, Any]]:
    """The error table of one channel; empty when there are no held-out rows to measure it on."""
    return {name: error_row(s, floor)} if np.isfinite(s.held.before) else {}


def calibrated(s: Selection, skip: tuple[str, ...] = ()) -> dict[str, Parameter]:
    """The declared model's parameters with intervals."""
    out = {}
    blocks = max(int(s.problem.train.sum() / s.problem.block), 5)
    for k, (name, unit) in enumerate(s.problem.base_labels):
        if name in skip or name in out:
            continue
        value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
        low, high = interval(value, error, blocks)
        out[name] = Parameter(value, unit, low, high)
    return out


def gate_rows(selections: dict[str, Selection]) -> dict[str, dict[str, float]]:
    """Threshold and statistic of every channel."""
    return {
        k: {"threshold": s.scores.threshold, "statistic": min(s.statistic, 1e6)}
        for k, s in selections.items()
    }


def refusals(selections: dict[str, Selection]) -> list[tuple[str, str, str]]:
    """Everything that was looked at and refused."""
    seen: dict[tuple[str, str], str] = {}
    for k, s in selections.items():
        for r in s.refused:
            seen.setdefault((k, r.what), r.why)
    return [(k, w, y) for (k, w), y in seen.items()]


def guide(runs: list[Run], rig: Rig | None, hold_out: list[str], plots: bool) -> Answer:
    """Answer for PHD2 guide logs."""
    from plant.calibration.guide import analyse_guide

    title = f"Guide log, {runs[0].header.get('mount', 'unnamed mount')}"
    found = analyse_guide(runs, rig, hold_out)
    if isinstance(found, str):
        return (
            Verdict("nothing", [], reasons=[found], not_identifiable=["everything: the log is too short"]),
            [],
            title,
        )
    s = found.selection
    effects = merge(found.findings)
    verdict, separating = judge(effects)
    v = Verdict(
        verdict,
        effects,
        errors("position", s, found.problem.floor),
        found.held_out,
        calibrated(s, ("offset",)),
        found.not_identifiable,
        _worm_controls(found),
        separating,
        list(dict.fromkeys([*(n for r in runs for n in r.notes), *found.notes])),
        gate_rows({"position": s}),
        refusals({"position": s}),
    )
    return v, _guide_plots(found) if plots else [], title


def _worm_controls(found: Any) -> list[dict[str, Any]]:
    from dataclasses import replace

    from plant.calibration.decide.controls import _better, _flipped
    from plant.calibration.guide import SIDEREAL_DAY_S, harmonics

    out = []
    s = found.selection
    for k, chosen in enumerate(s.chosen):
        c = chosen.candidate
        if c.stage and c.frequency:
            for step, word in ((1, "more"), (-1, "less")):
                rate = c.frequency + step / SIDEREAL_DAY_S
                if step and abs(step / SIDEREAL_DAY_S) * float(np.ptp(s.problem.t)) < 0.3:
                    out.append(
                        {
                            "what": f"one tooth {word}: {1 / rate:.2f} s",
                            "accepted": False,
                            "note": "this log is too short to tell one tooth from the next",
                        }
                    )
                    continue
                wrong = replace(c, columns=harmonics(s.problem, rate, max(c.width // 2, 1)))
                out.append({"what": f"one tooth {word}: {1 / rate:.2f} s", "accepted": _better(s, k, wrong)})
            for factor in (0.9, 1.1):
                wrong = replace(c, columns=harmonics(s.problem, c.frequency * factor, max(c.width // 2, 1)))
                out.append(
                    {
                        "what": f"wrong period: {1 / (c.frequency * factor):.1f} s",
                        "accepted": _better(s, k, wrong),
                    }
                )
        out.append({"what": f"sign flipped ({c.name})", "accepted": _flipped(s, k)})
    return out


def _guide_plots(found: Any) -> list[dict[str, str]]:
    from plant.calibration.report import plots as draw

    s, p = found.selection, found.problem
    out = []
    if s.chosen and s.chosen[0].candidate.frequency:
        f0 = s.chosen[0].candidate.frequency
        out.append(
            {
                "image": draw.domain_plot(
                    s,
                    (p.t * f0) % 1.0,
                    "phase of the period, turns",
                    "Residual over the period that explains it",
                ),
                "alt": f"Residual over the phase of {1 / f0:.2f} s",
            }
        )
    out.append(
        {
            "image": draw.order_plot(s, p.t, found.stages, "Spectrum with the known periods drawn in", "Hz"),
            "alt": "Amplitude spectrum before and after, known periods dotted",
        }
    )
    out.append(
        {"image": draw.trace_plot(s, "Held-out trace before and after"), "alt": "Held-out drive error"}
    )
    out.append({"image": draw.gate_plot(s, "Gate"), "alt": "Largest score of this log against surrogates"})
    return out


def bench(runs: list[Run], rig: Rig, hold_out: list[str], plots: bool) -> Answer:
    """Answer for another drive's file with a rig file."""
    from plant.calibration.bench import analyse_bench
    from plant.calibration.report import plots as draw

    found = analyse_bench(runs, rig, hold_out)
    s, c = found.selection, found.context
    verdict, separating = judge(found.findings)
    turns = c.angle
    v = Verdict(
        verdict,
        found.findings,
        errors("torque", s, found.problem.floor),
        found.held_out,
        calibrated(s),
        found.not_identifiable,
        controls(s, None, float(np.ptp(turns))) + _stage_controls(found),
        separating,
        [],
        gate_rows({"T": s}),
        refusals({"T": s}),
    )
    pictures = []
    if plots:
        for k, chosen in enumerate(s.chosen[:3]):
            x, label = _domain(
                chosen.candidate.domain,
                c,
                chosen.candidate.order if chosen.candidate.kind == "line" else None,
            )
            pictures.append(
                {
                    "image": draw.domain_plot(s, x, label, chosen.candidate.say(), k),
                    "alt": f"Residual over {label}: {chosen.candidate.say()}",
                }
            )
        pictures.append(
            {
                "image": draw.order_plot(
                    s, turns, c.stages, "Spectrum over order", f"cycles per {c.angle_unit}"
                ),
                "alt": "Spectrum over order with the gear table",
            }
        )
        pictures.append(
            {"image": draw.trace_plot(s, "Held-out trace before and after"), "alt": "Held-out residual"}
        )
        pictures.append({"image": draw.gate_plot(s, "Gate"), "alt": "Largest score against surrogates"})
    return v, pictures, rig.name


def _stage_controls(found: Any) -> list[dict[str, Any]]:
    """Lines of the gear table at an order that is off by a resolution cell and a half."""
    from dataclasses import replace

    from plant.calibration.candidates.candidate import sine_columns
    from plant.calibration.decide.controls import _better

    out = []
    s, c = found.selection, found.context
    span = float(np.ptp(c.angle)) or 1.0
    for k, chosen in enumerate(s.chosen[:6]):
        x = chosen.candidate
        if x.kind == "line" and x.order and x.name != "position_friction":
            for shift in (1.5, -1.5):
                order = x.order + shift / span
                wrong = replace(x, columns=sine_columns(c.angle * order, c.session), shape=None)
                out.append(
                    {"what": f"order {order:.4g} in place of {x.order:.4g}", "accepted": _better(s, k, wrong)}
                )
    return out


def _domain(name: str, c: Any, order: float | None) -> tuple[Array, str]:
    if order is not None:
        return (c.angle / c.turn * order) % 1.0, f"phase of order {order:.5g}, turns"
    table = {
        "axis_angle": (c.angle, f"position, {c.angle_unit}"),
        "motor_angle": (c.angle, f"position, {c.angle_unit}"),
        "velocity": (c.speed, f"speed, {c.angle_unit}/s"),
        "reversal": (c.since, f"travel since reversal, {c.angle_unit}"),
        "time": (c.t, "time, s"),
    }
    if name == "temperature" and c.temperature is not None:
        return c.temperature, "temperature, degC"
    if name == "current" and c.load is not None:
        return c.load, f"load, {c.unit}"
    return table.get(name, (c.t, "time, s"))


def axis(
    runs: list[Run],
    hold_out: list[str],
    out: Path,
    plant: Path | None,
    plots: bool,
    tell: Callable[[str], None],
) -> Answer:
    """Answer for logs of one axis of the telescope."""
    from plant.calibration.axisanswer import axis_answer

    return axis_answer(runs, hold_out, out, plant, plots, tell)
