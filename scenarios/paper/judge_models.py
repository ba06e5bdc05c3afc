"""Verdicts on E7 to E10: identification, linear model, tuning rule."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from plant.parts import PlantModel
from scenarios.paper.friction_map import FrictionFit
from scenarios.paper.linear import DeadTimeModel
from scenarios.paper.log import Log
from scenarios.paper.measures import Step, peak_percent
from scenarios.paper.published import INERTIA, TABLE_2, TABLE_2_TOLERANCE
from scenarios.paper.rows import Row, verdict
from scenarios.paper.rundown import RunDown
from scenarios.paper.runs import TRACKING
from scenarios.paper.tuning import Gains, closed_time_constant, simc

INERTIA_TOLERANCE = 5.0
RISE_BAND = (0.67, 1.5)
OVERSHOOT_POINTS = 15.0
SETTLED_PERCENT = 1.0
INTEGRAL_BAND = (1.0 / 1.5, 1.5)
NAMES = {"viscous": "σ2", "coulomb": "Tc", "stiction": "Ts", "stribeck_rate": "vs"}


def e7(fits: Mapping[str, FrictionFit], units: Mapping[str, float]) -> Row:
    """Table 2 from the emulator's logs; the row's figure is the largest deviation, as a share of its
    tolerance.

    units: factors from N m at the axis to the unit in which the plants read Table 2's torques.
    """
    checks, details, worst, worst_share = [], {}, 0.0, -1.0
    for preload, fit in fits.items():
        found = {}
        for name, printed in TABLE_2[preload].items():
            scale = units[preload] if name in ("coulomb", "stiction") else 1.0
            value = float(getattr(fit, name)) * scale
            off = (value / printed - 1.0) * 100.0
            found[name] = {"published": printed, "emulated": round(value, 7), "off_percent": round(off, 2)}
            checks.append(
                (abs(off) <= TABLE_2_TOLERANCE[name], f"{preload} {NAMES[name]} {value:.4g} ({off:+.1f} %)")
            )
            if abs(off) / TABLE_2_TOLERANCE[name] > worst_share:
                worst, worst_share = off, abs(off) / TABLE_2_TOLERANCE[name]
        details[preload] = found | {
            "exponent": round(fit.exponent, 4),
            "misfit_percent": round(fit.misfit_percent, 3),
        }
    passed, reason = verdict(checks)
    read = (
        "N m at the axis" if all(abs(unit - 1.0) < 1e-6 for unit in units.values()) else "N mm at the motor"
    )
    return Row("E7", worst, passed, f"{reason}. Tc and Ts in {read}", details | {"torque_unit": read})


def e8(results: Sequence[RunDown]) -> Row:
    """Moment of inertia from run-downs in both directions: their mean."""
    inertia = sum(result.inertia for result in results) / len(results)
    stop = sum(result.stop_s for result in results) / len(results)
    off = (inertia / INERTIA - 1.0) * 100.0
    each = ", ".join(f"{result.inertia:.0f}" for result in results)
    passed, reason = verdict(
        [
            (
                abs(off) <= INERTIA_TOLERANCE,
                f"J = {inertia:.0f} kg m² ({off:+.1f} %; {each}), at rest after {stop:.2f} s",
            )
        ]
    )
    return Row("E8", inertia * 1e3, passed, reason, {"off_percent": round(off, 2), "stop_s": round(stop, 3)})


def e9(full: Step, linear: Step, setpoint: float) -> Row:
    """Step to 600 arcsec/s: emulator against equation (6)."""
    ratio = full.rise_s / linear.rise_s
    gap = abs(full.overshoot_percent - linear.overshoot_percent)
    settled = abs(full.settled - linear.settled) / setpoint * 100.0
    passed, reason = verdict(
        [
            (
                RISE_BAND[0] <= ratio <= RISE_BAND[1],
                f"rise {full.rise_s * 1e3:.0f} ms, linear {linear.rise_s * 1e3:.0f} ms",
            ),
            (
                gap <= OVERSHOOT_POINTS,
                f"overshoot {full.overshoot_percent:.0f} %, linear {linear.overshoot_percent:.0f} %",
            ),
            (settled <= SETTLED_PERCENT, f"settled means {settled:.2f} % apart"),
        ]
    )
    details = {"emulator": vars(full) | {}, "linear": vars(linear) | {}}
    return Row("E9", ratio, passed, reason, details)


@dataclass(frozen=True)
class Tuned:
    """The rule applied to a plant: reduced model, the time constant asked for, gains, and those of the plant
    file."""

    model: DeadTimeModel
    closed_s: float
    gains: Gains
    plant: Gains


def tuned(model: DeadTimeModel, plant: PlantModel) -> Tuned:
    """Return the rule's gains at the closed-loop time constant that gives the plant file's Kp."""
    own = Gains(plant.controller.kp.si, plant.controller.ki.si)
    closed = closed_time_constant(model, own.kp)
    return Tuned(model, closed, simc(model, closed), own)


def e10(rule: Tuned, tracking: Log, high: Mapping[float, Log]) -> Row:
    """Gains of the tuning rule against those of the plant file, and the loop with the rule's gains."""
    ratio = rule.gains.ki / rule.plant.ki
    dead = rule.model.dead_s + rule.model.fast_s / 2.0
    peak = peak_percent(tracking.rate, TRACKING)
    worst = max(peak_percent(log.rate, speed) for speed, log in high.items())
    passed, reason = verdict(
        [
            (
                rule.closed_s >= dead,
                f"Kp {rule.gains.kp:.4g} at a closed-loop time constant of {rule.closed_s * 1e3:.0f} ms "
                f"(dead time {dead * 1e3:.1f} ms)",
            ),
            (
                INTEGRAL_BAND[0] <= ratio <= INTEGRAL_BAND[1],
                f"Ki {rule.gains.ki:.4g}, plant file {rule.plant.ki:.4g}",
            ),
            (peak <= 25.0, f"peak at 15″/s with the rule's gains {peak:.1f} %"),
            (worst <= 7.0, f"at 600 and 1000″/s {worst:.1f} %"),
        ]
    )
    details = {
        "model": {
            "gain_counts_per_step": round(rule.model.gain, 5),
            "slow_s": round(rule.model.slow_s, 6),
            "fast_s": round(rule.model.fast_s, 6),
            "dead_s": rule.model.dead_s,
        },
        "rule": {
            "kp": round(rule.gains.kp, 5),
            "ki": round(rule.gains.ki, 6),
            "closed_s": round(rule.closed_s, 5),
        },
        "plant_file": {"kp": rule.plant.kp, "ki": rule.plant.ki},
    }
    return Row("E10", ratio, passed, reason, details)
