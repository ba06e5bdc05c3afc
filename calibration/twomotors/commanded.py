"""The command of an axis with two motors: its change against the controller's law."""

from __future__ import annotations

import numpy as np

from calibration.channels.command import command_candidates, command_problem, pulses
from calibration.decide.select import select
from calibration.decide.sizes import largest_amplitude
from calibration.finding import Finding, middle
from calibration.statistics.regression import gls
from calibration.twomotors.result import AxisResult

# times what the rounding of the effort leaves of its change, before a law of its own is looked for: below, a
# law that fits better is how small numbers round (the plant's own logs: 1.0; a wrong gain: 1.9 and more)
LEAST_LAW = 1.2
PULSES = 8.0  # a quarter of the regular spikes: 32 of them
# steps of the effort: a line on the command below the effort's own step is a beat of quantised columns
LEAST_COMMAND = 0.8


def command_channel(result: AxisResult, rng: np.random.Generator) -> None:
    """Change of effort against the law of the controller."""
    command = command_problem(result.frame, result.held, result.declared.own)
    if command is None:
        return
    p, rates = command
    null = gls(p.y, p.base, p.train, p.ar_order, p.block)
    s = select(p, command_candidates(p, rates, null.residual), rng, margin=0.02)
    if s.chosen and s.chosen[0].candidate.name == "unknown" and s.held.before < LEAST_LAW * p.floor:
        s = select(p, [], rng)
    result.selections["U"] = s
    if not s.chosen or s.chosen[0].candidate.kind != "line" or largest_amplitude(s) > LEAST_COMMAND:
        result.collect(s)
    found = pulses(p, s.after.residual)
    if found is not None and found.score > PULSES:
        result.findings.append(
            Finding(
                "unknown",
                "S",
                "command",
                evidence=found.evidence,
                share=found.share,
                note=f"pulses on the command, every {found.period:.2f} s",
                parameters={
                    "size": middle(found.sizes, p.unit),
                    "period": middle(found.gaps, "s"),
                },
            )
        )
