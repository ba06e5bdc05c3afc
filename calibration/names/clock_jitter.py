"""Stamps that shake about the time they tell."""

import numpy as np

from calibration.balances.frame import Frame
from calibration.finding import deviation, of_columns
from calibration.names.name import OF_CLOCKS, Beside, Finding, Name
from calibration.statistics.tails import variance_log10

# rms of the stamps about a smooth course, s; an interrupt's own latency is a few microseconds. ASSUMPTION
JITTER_S = 4e-5
FEWEST_ROWS = 50  # rows of a run, before its course is fitted. ASSUMPTION


def stamps(frame: Frame) -> Finding | None:
    """Stamps about a smooth course of every run; None where they keep to it."""
    left = []
    for k in range(len(frame.runs)):
        rows = (frame.run == k) & frame.present
        t, c = frame.t[rows], frame.clock[rows]
        if len(t) > FEWEST_ROWS:
            left.append(c - np.polyval(np.polyfit(t - t[0], c, 2), t - t[0]))
    if not left:
        return None
    e = np.concatenate(left)
    sigma = float(np.std(e))
    if sigma < JITTER_S:
        return None
    evidence = variance_log10((sigma / JITTER_S) ** 2, len(e))
    found = {"deviation": deviation(sigma, len(e), "s")}
    return of_columns(NAME.name, found, evidence, share=1.0 - (JITTER_S / sigma) ** 2)


NAME = Name(
    name="clock_jitter",
    experiment="log an external pulse of known period beside the columns",
    stamps=stamps,
    repairs=("jitter",),
    beside=Beside(consequences={"S": OF_CLOCKS}),
)
