"""How currents are sampled: the ripple's peak at the PWM's falling edge, and a converter that rounds down."""

from __future__ import annotations

import numpy as np

from calibration.channels.bridge import MORE, SURE
from calibration.channels.duties import duties
from calibration.channels.frame import Frame, fill
from calibration.channels.problem import Problem
from calibration.channels.torque import saturated
from calibration.readers.run import Array
from calibration.statistics.regression import gls, under

RIPPLE = (0.004, 0.03)  # R / (2 L f): L/R of 0.8 to 5 ms and 20 kHz (hardware.md 1.2, 2.4), a quarter of room
TRUNCATION = (0.25, 0.8)  # counts that a converter which rounds down reads too low, 0.5 at even spread
AS_GOOD = 0.1  # of its gain, that it may explain less where it is to stand for all of it


def add_sampling(p: Problem, duty: Array, supply: Array, power: Array, ampere: float) -> None:
    """Add how the converter samples to the base, where the log shows it.

    Sampled at the falling edge of the PWM (paper 3.3) the current reads V d (1-d) / (2 L f) above its mean,
    and a
    converter that rounds down half a count below. Both are declared, both are bounded; a log sampled
    otherwise keeps
    its base, and what looks like a ripple but fits better as a supply that gives way is left to that effect.
    """
    ripple, offset = -supply * duty * (1 - duty), np.full(len(duty), ampere)
    sag = duty * power

    def fit(*columns: Array) -> tuple[float, Array, Array]:
        x = np.column_stack([p.base, *columns])
        f = gls(p.y, x, p.train, p.ar_order, p.block)
        loglik = under(p.y, x, p.train, common)
        return loglik, f.beta, np.sqrt(np.maximum(np.diag(f.covariance), 1e-300))

    richest = np.column_stack([p.base, ripple, offset, sag])
    common = gls(p.y, richest, p.train, p.ar_order, p.block).whitener

    at = p.base.shape[1]

    def sound(beta: Array, error: Array) -> bool:
        counts = float(beta[at + 1] / beta[0])
        return bool(
            RIPPLE[0] < beta[at] < RIPPLE[1]
            and TRUNCATION[0] < counts < TRUNCATION[1]
            and beta[at] > SURE * error[at]
            and beta[at + 1] > SURE * error[at + 1]
        )

    other = fit(sag, offset)[0]
    without = fit()[0]
    alone, beta, error = fit(ripple, offset)
    both, beta2, error2 = fit(ripple, offset, sag)
    as_good = other - alone < AS_GOOD * (alone - without)
    if (as_good and sound(beta, error)) or (both > other + MORE and sound(beta2, error2)):
        p.base = np.column_stack([p.base, ripple, offset])
        p.base_labels += [("current_ripple", "1"), ("conversion_offset", "ohm")]
        return
    # efforts that hardly differ leave the ripple to the resistance, but not the half count of a converter
    # that rounds down; a supply must explain twice as much to be heard instead
    rounded, beta3, error3 = fit(offset)
    counts = float(beta3[at] / beta3[0]) if beta3[0] > 0 else 0.0
    sure = TRUNCATION[0] < counts < TRUNCATION[1] and beta3[at] > SURE * error3[at]
    if sure and rounded > without + MORE and fit(sag)[0] - rounded < rounded - without:
        p.base = np.column_stack([p.base, offset])
        p.base_labels += [("conversion_offset", "ohm")]


def mean_currents(frame: Frame, p: Problem, beta: Array) -> None:
    """Turn sampled currents into mean ones, in place, by what `add_sampling` found; `beta` is the E channel's
    fit."""
    found = dict(zip((name for name, _ in p.base_labels), beta, strict=False))
    if "conversion_offset" not in found:
        return
    ripple, offset = found.get("current_ripple", 0.0), found["conversion_offset"]
    volts, full = frame.scale["supply_V"], frame.scale["adc_A_per_count"]
    duty = duties(frame, fill(frame.columns["effort"], frame.run)[0])
    for key in "ab":
        i, d = frame.columns[f"current_{key}"], duty[key]
        wrong = ripple * volts * d * (1 - d) - offset * full
        sound = (i > 0) & ~saturated(frame, i)
        frame.columns[f"current_{key}"] = np.where(sound, i - wrong / beta[0], i)


def undo_sampling(frame: Frame, ripple: float) -> None:
    """Turn sampled currents into mean ones, in place, by what a plant file declares.

    `ripple` in A/V: at the falling edge the current is ripple V d (1 - d) above its mean; a converter that
    rounds down reads half a count too low.
    """
    duty = duties(frame, fill(frame.columns["effort"], frame.run)[0])
    for key in "ab":
        i, d = frame.columns[f"current_{key}"], duty[key]
        wrong = ripple * frame.scale["supply_V"] * d * (1 - d) - 0.5 * frame.scale["adc_A_per_count"]
        sound = (i > 0) & ~saturated(frame, i)
        frame.columns[f"current_{key}"] = np.where(sound, i - wrong, i)
