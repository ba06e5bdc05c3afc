"""Interpolation between a sensor's lines."""

from typing import Any

import numpy as np

from calibration.balances.candidate import waves
from calibration.names.inplant import OF_ABSOLUTE, Facts, Made, value
from calibration.names.lines import stage_lines
from calibration.names.name import FULL_RATES, RATES, SENSORS, Candidate, Finding, Name, Scene, candidate

RESOLVED = 0.3  # periods per row: where hardly a row is slower, the log cannot show the error. ASSUMPTION
SLOW_ROWS = 0.02  # of the rows, that are as slow at least. ASSUMPTION
# signal periods per turn of an RCN 700 or 800 (hardware.md 1.3), where a finding does not say
LINES = 32768.0


def columns(s: Scene) -> list[Candidate]:
    """Sines at the stages that are declared as a sensor's lines.

    Those of an axis' absolute encoder are at its line count (signal periods per turn) and twice it. They need
    a rate that is compared and a count that is declared.
    """
    lines = s.view.rig.encoder_periods
    if not s.rates or lines is None:
        return stage_lines(s, "encoder_subdivision")
    periods = np.abs(s.view.speed[s.view.rows]) / (2 * np.pi) * lines * s.view.period_s
    if np.mean(periods < RESOLVED) < SLOW_ROWS:
        return []
    both = s.at(waves(lines * s.view.x, (1, 2)))
    more: dict[str, Any] = {"kind": "line", "order": float(lines), "harmonic": 1}
    return [candidate("encoder_subdivision", both, "amplitude", "second", **more)]


def to_plant(f: Finding, facts: Facts) -> Made:
    """Of the absolute encoder."""
    values = {"lines": f.order or LINES, "encoder": 1.0}
    for size, phase in (("amplitude", "phase"), ("second", "second_phase")):
        if size in f.parameters:
            values |= {size: value(f, size), phase: value(f, phase) + OF_ABSOLUTE}
    return Made().add(f.name, facts, values)


NAME = Name(
    name="encoder_subdivision",
    channels=(SENSORS, RATES, FULL_RATES),
    columns=columns,
    experiment="a slow motion over some lines of the sensor",
    to_plant=to_plant,
)
