"""The answer for PHD2 guide logs: verdict, error table, controls of the worm, pictures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.answers import GATE, Answer, calibrated, errors, gate_rows, refusals, too_short
from calibration.decide.controls import _better, _flipped
from calibration.decide.merge import merge
from calibration.decide.missing import above_floor, lives_in
from calibration.decide.select import Selection
from calibration.decide.verdict import Verdict, judge
from calibration.decide.withdraw import withdraw
from calibration.drift.look import GuideResult, analyse_guide, harmonics
from calibration.drift.mounts import SIDEREAL_DAY_S
from calibration.inputs.declaration import Rig
from calibration.readers.run import Run
from calibration.report import plots as draw

FEW = 4  # parts of a mount, whose turns are looked at for what is left


def guide_answer(runs: list[Run], rig: Rig | None, hold_out: list[str], plots: bool) -> Answer:
    """Answer for PHD2 guide logs."""
    title = f"Guide log, {runs[0].header.get('mount', 'unnamed mount')}"
    found = analyse_guide(runs, rig, hold_out)
    if isinstance(found, str):
        return (
            Verdict(
                "cannot tell",
                [],
                reasons=[found],
                separating="guide one section for at least three turns of the worm (half an hour for most"
                " mounts), without a slew",
                not_identifiable=["everything: the log is too short"],
            ),
            [],
            title,
        )
    s = found.selection
    tried = _worm_controls(found)
    effects, withdrawn = withdraw(merge(found.findings), tried)
    verdict, separating = judge(effects, [f"{what} was close, but {why}" for _, what, why in withdrawn])
    if not effects and found.not_identifiable:
        verdict = "cannot tell"
        separating = "a longer section without a slew: two turns in its first 60 %, for " + "; ".join(
            found.not_identifiable
        )
    v = Verdict(
        verdict,
        effects,
        errors("position", s, found.problem.floor),
        found.held_out,
        calibrated(s, ("offset",)),
        found.not_identifiable,
        tried,
        separating,
        list(dict.fromkeys([*(n for r in runs for n in r.notes), *found.notes, *too_short(s, "")])),
        thresholds=gate_rows({"position": s}),
        refused=[*withdrawn, *refusals({"position": s})],
    )
    v.remarks = _still_missing(found, v)
    v.reasons += v.remarks
    return v, _guide_plots(found) if plots else [], title


def _still_missing(found: GuideResult, v: Verdict) -> list[str]:
    """What is beyond twice the floor when every part has been tried, and where it lives."""
    p = found.problem
    clock = p.domains.get("clock", p.t)
    parts = found.stages if len(found.stages) <= FEW else {}  # usual wheels that were only tried say nothing
    domains = {"time": p.t, **{f"the turn of {n}": (clock * rate) % 1.0 for n, rate in parts.items()}}
    *_, where = lives_in(found.selection, domains)
    return [
        f"something is still missing in {row}: {ratio:.1f} floors are left, {where}"
        for row, ratio in above_floor(v.error).items()
    ]


def _worm_controls(found: GuideResult) -> list[dict[str, Any]]:
    out = []
    s = found.selection
    for k, chosen in enumerate(s.chosen):
        c = chosen.candidate
        which = {"name": c.name, "stage": c.stage, "harmonic": c.harmonic}
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
                what = f"one tooth {word}: {1 / rate:.2f} s"
                out.append({"what": what, "accepted": _better(s, k, wrong), **which})
            for factor in (0.9, 1.1):
                wrong = replace(c, columns=harmonics(s.problem, c.frequency * factor, max(c.width // 2, 1)))
                out.append(
                    {
                        "what": f"wrong period: {1 / (c.frequency * factor):.1f} s",
                        "accepted": _better(s, k, wrong),
                        **which,
                    }
                )
        out.append({"what": f"sign flipped ({c.name})", "accepted": _flipped(s, k), **which})
    return out


def _guide_plots(found: GuideResult) -> list[dict[str, str]]:
    s, p = found.selection, found.problem
    out = []
    if s.chosen and s.chosen[0].candidate.frequency:
        f0 = s.chosen[0].candidate.frequency
        out.append(
            {
                "image": draw.domain_plot(
                    _first_section(s),
                    (p.domains.get("clock", p.t) * f0) % 1.0,
                    f"phase of the period of {1 / f0:.2f} s, turns",
                    "Drive error over the period that explains it",
                ),
                "alt": "Fitted frames of the first section, offset, drift and other effects taken away; "
                "the phase of every further section is its own",
            }
        )
    out.append(
        {
            "image": draw.period_plot(s, found.stages, "Amplitude over period"),
            "alt": "Fitted frames; before: offset and drift only, after: with the effects",
        }
    )
    out.append(
        {
            "image": draw.trace_plot(s, "Held-out drive error before and after"),
            "alt": "Frames nothing was fitted to, except the offset of each dither",
        }
    )
    out.append({"image": draw.gate_plot(s, "Is anything there at all?"), "alt": GATE})
    return out


def _first_section(s: Selection) -> Selection:
    """The same selection with the first section's rows only: each section has a phase of its own."""
    p = s.problem
    first = p.session == p.session[p.train][0] if p.train.any() else p.valid
    return replace(s, problem=replace(p, valid=p.valid & first))
