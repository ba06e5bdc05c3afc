"""Electrical effects (channel E), as volts over duty, current, speed and time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate, ramp
from calibration.channels.electrical import Electrical
from calibration.channels.recursions import lowpass
from calibration.finding import Finding
from calibration.readers.run import Array

FOLLOWS = 2.0  # of the share: a lagging motor's current that follows the leading one's has 1
ABOVE = 0.5  # quantile of the duties that drive, above which no dead band's knee lies (ASSUMPTION)
# duties where the search for a dead band begins; 0.3 to 5 % of a period is what bridges lose. ASSUMPTION
KNEES = (0.003, 0.006, 0.012, 0.025, 0.05)
SHORTEST = 0.01  # of the rows: may have pulses shorter than a dead band taken for a constant (ASSUMPTION)
COPPER = 0.00393  # 1/K, temperature coefficient of copper at 20 degC


def electrical_effects(e: Electrical, clock: Array) -> list[Candidate]:
    """Candidates of the stacked E problem; `clock` (n,) is the session time of one motor's rows."""
    r, k = e.resistance, e.constant
    t = np.concatenate([clock, clock])
    out = [
        *dead_bands(e),
        Candidate(
            "unknown",
            "current",
            (k * share_of_effort(e) * e.lagging * leading_speed(e))[:, None],
            (("following", "1"),),
            sign=1,
            most=FOLLOWS,
        ),
        Candidate("diode_braking", "velocity", (-k * e.dragged)[:, None], (("fraction", "1"),), sign=1),
        Candidate("supply_sag", "current", (e.duty * e.sum_power)[:, None], (("resistance", "ohm"),), sign=1),
        Candidate(
            "supply_sag",
            "current",
            (e.duty * np.tile(e.current[: len(e.duty) // 2] + e.current[len(e.duty) // 2 :], 2))[:, None],
            (("resistance", "ohm"),),
            sign=1,
            fixed={"of_the_sum": (1.0, "0 currents drawn from the supply, 1 currents of the motors")},
        ),
        Candidate(
            "backlash_loss",
            "reversal",
            (e.duty * e.supply * e.lagging)[:, None],
            (("counter_loss", "1"),),
            sign=1,
        ),
    ]
    offset = -r * e.ampere_per_count
    each = offset * np.column_stack([e.motor == 0, e.motor == 1])
    out.append(Candidate("adc_offset", "current", each, (("offset_a", "counts"), ("offset_b", "counts"))))
    for name, mask in (("a", e.motor == 0), ("b", e.motor == 1)):
        out += [
            Candidate(
                "adc_offset",
                "current",
                (offset * mask)[:, None],
                (("offset", "counts"),),
                fixed={"motor": (float(name == "b"), "0 A, 1 B")},
            ),
            Candidate(
                "adc_gain",
                "current",
                (-r * e.current * mask)[:, None],
                (("gain", "1"),),
                fixed={"motor": (float(name == "b"), "0 A, 1 B")},
            ),
            Candidate(
                "magnet_weakening",
                "velocity",
                (-k * e.pulling * mask)[:, None],
                (("fraction", "1"),),
                sign=1,
                fixed={"motor": (float(name == "b"), "0 A, 1 B")},
            ),
        ]
    for tau in (20.0, 40.0, 60.0, 90.0, 140.0, 220.0, 350.0):
        shape = _heating(e, clock)
        out.append(
            Candidate(
                "winding_heating",
                "time",
                shape(np.array([tau])),
                (("thermal_resistance", "K/W"),),
                sign=1,
                fixed={"tau": (tau, "s")},
                shape=shape,
                steps=(0.05 * tau,),
            )
        )
    low, high = float(clock.min()), float(clock.max())
    span = high - low
    for at in np.linspace(0.05, 0.95, 16) * span + low:
        if 0.02 < np.mean(t > at) < 0.98:
            shape = _weakening(e, t)
            out.append(
                Candidate(
                    "magnet_weakening",
                    "time",
                    shape(np.array([at, 0.05 * span])),
                    (("fraction", "1"),),
                    fixed={"onset": (float(at), "s"), "ramp": (0.05 * span, "s")},
                    sign=1,
                    shape=shape,
                    steps=(0.02 * span, 0.02 * span),
                )
            )
    return out


def dead_bands(e: Electrical) -> list[Candidate]:
    """Volts that a pulse loses to the driver, per duty lost: behind the split between the motors, or on the
    command before it. A pulse shorter than the dead band is lost whole, which tells it from an ADC's offset.
    Where none is as short, it is a constant, and so is what one converter reads wrong of both motors."""
    out = []
    for before, share in enumerate((np.ones(len(e.duty)), share_of_effort(e))):
        place = {"before_split": (1.0, "0 behind, 1 before the split between the motors")} if before else {}
        split = np.where(share > 0, e.duty / np.maximum(share, 1e-9), 0.0)
        out.append(
            Candidate(
                "pwm_deadband",
                "command",
                (e.supply * share)[:, None],
                (("u0", "1"),),
                sign=1,
                fixed=place,
                most=float(np.quantile(split[e.problem.train], SHORTEST)),
                twins=() if before else ("adc_offset",),
            )
        )
        driven = split[e.problem.train & (split > 0)]
        widest = float(np.quantile(driven, ABOVE)) if len(driven) else 0.0
        shape = _swallowed(e.supply * share, split, widest)
        out += [
            Candidate(
                "pwm_deadband",
                "command",
                shape(np.array([knee])),
                (("u0", "1"),),
                sign=1,
                fixed={"knee": (knee, "1"), **place},
                shape=shape,
                steps=(0.1 * knee,),
                searched=1,
            )
            for knee in KNEES
            if knee < widest
        ]
    return out


def _swallowed(volts: Array, duty: Array, widest: float) -> Callable[[Array], Array]:
    """`volts` where the duty exceeds the knee, in proportion below it: a knee above every duty would be the
    supply itself."""
    return lambda p: (volts * np.minimum(duty / float(np.clip(p[0], 1e-4, widest)), 1.0))[:, None]


def share_of_effort(e: Electrical) -> Array:
    """A motor's duty over the leading motor's (2 n,): 1 where it leads, the counter torque's share where it
    lags."""
    n = len(e.duty) // 2
    lead = np.maximum(np.maximum(e.duty[:n], e.duty[n:]), 1e-9)
    return np.asarray(e.duty / np.concatenate([lead, lead]))


def leading_speed(e: Electrical) -> Array:
    """rad/s (2 n,) of the motor that leads, in the way it pulls: a lagging motor whose current follows the
    leading one's lacks that one's back-EMF, times its share."""
    n = len(e.duty) // 2
    lead = np.where(e.lagging[:n] > 0, e.pulling[n:], e.pulling[:n])
    return np.concatenate([lead, lead])


def brush_effects(e: Electrical, angle: dict[str, Array]) -> list[Candidate]:
    """`unknown` over the angle of either motor, as a resistance and as a voltage: six harmonics of the
    motor turn.

    `angle` (n,) per motor in turns.
    """
    out = []
    for k, key in enumerate("ab"):
        x = 2 * np.pi * np.concatenate([angle[key], angle[key]])
        waves = np.column_stack([g(h * x) for h in range(1, 7) for g in (np.cos, np.sin)])
        mask = (e.motor == k).astype(float)
        for weight, unit in ((mask, "V"), (mask * e.current, "ohm")):
            out.append(
                Candidate(
                    "unknown",
                    "motor_angle",
                    waves * weight[:, None],
                    (("amplitude", unit),),
                    kind="line",
                    stage="motor",
                    harmonic=1,
                    fixed={"motor": (float(k), "0 A, 1 B")},
                )
            )
    return out


def _weakening(e: Electrical, t: Array) -> Callable[[Array], Array]:
    """Volts per fraction of K lost, from an onset over a ramp."""
    return lambda p: (-e.constant * e.pulling * ramp(t, float(p[0]), float(p[1])))[:, None]


def weakened(chosen: list[tuple[Candidate, Array]], clock: Array, ratio: float = 1.0) -> dict[str, Array]:
    """Part of what its current reads that each motor makes torque of, (n,) over `clock`, from the E channel's
    accepted effects: what its magnets have left, and no more than it really draws; `ratio` as in
    `from_whole`."""
    out = {"a": np.ones(len(clock)), "b": np.ones(len(clock))}
    for c, beta in chosen:
        if c.name == "adc_gain":
            key = "ab"[int(c.fixed["motor"][0])]
            out[key] = out[key] * (1.0 - float(beta[0]))
        if c.name != "magnet_weakening":
            continue
        at = c.fixed
        lost = ratio * float(beta[0]) * (ramp(clock, at["onset"][0], at["ramp"][0]) if "onset" in at else 1.0)
        for k, key in enumerate("ab"):
            if "motor" not in at or at["motor"][0] == k:
                out[key] = out[key] - lost
    return out


def reading_error(chosen: list[tuple[Candidate, Array]]) -> float:
    """Relative standard error of all torques from a current's gain: volts show that the two motors' readings
    differ, and hardly which of them is right."""
    return max((abs(float(beta[0])) / 2 for c, beta in chosen if c.name == "adc_gain"), default=0.0)


def _heating(e: Electrical, clock: Array) -> Callable[[Array], Array]:
    """Volts per K/W: R alpha R i (i^2 low-passed), the winding's own loss heating it."""
    return lambda p: (COPPER * e.resistance**2 * e.current * _heat(e, clock, max(float(p[0]), 1.0)))[:, None]


def _heat(e: Electrical, clock: Array, tau: float) -> Array:
    """Low-passed i^2 of each motor, cold at the log's start."""
    n = len(clock)
    return np.concatenate([lowpass(e.current[:n] ** 2, clock, tau), lowpass(e.current[n:] ** 2, clock, tau)])


def followed(f: Finding) -> Finding:
    """A current that follows the other motor's, said in words: the catalogue has no name for it."""
    if "following" not in f.parameters:
        return f
    return replace(f, note="the lagging motor's current follows the leading one's, not its own duty")


def from_whole(f: Finding, ratio: float) -> Finding:
    """A weakening found with the mean constant of the log, `ratio` times the one before it, told of that."""
    if f.name != "magnet_weakening" or "fraction" not in f.parameters:
        return f
    return replace(f, parameters={**f.parameters, "fraction": f.parameters["fraction"].times(ratio)})


def from_cold(f: Finding, ratio: float) -> Finding:
    """A heating found with the mean resistance of the log, `ratio` times the cold one, told of the cold
    one."""
    if f.name != "winding_heating" or "thermal_resistance" not in f.parameters:
        return f
    p = f.parameters["thermal_resistance"]
    told = p.times(ratio**2)
    return replace(f, parameters={**f.parameters, "thermal_resistance": told})
