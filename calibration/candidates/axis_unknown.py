"""What an effect outside the catalogue enters the drive's plant as: a smooth function of one domain."""

from __future__ import annotations

import numpy as np

from calibration.candidates.axis_torque import Friction
from calibration.candidates.candidate import Candidate
from calibration.candidates.context import Context
from calibration.candidates.friction import stop_operator
from calibration.candidates.orders import order_spectrum, peaks
from calibration.candidates.unknown import spline_columns
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask


def unknown_torques(c: Context, f: Friction, e: Array, rows: Mask, period_s: float) -> list[Candidate]:
    """Smooth functions of speed, travel since reversal, and lines at fixed Hz."""
    out = []
    w = c.speed / (float(np.quantile(np.abs(c.speed), 0.95)) or 1.0)
    drag = np.column_stack([w * np.abs(w), w**3])
    out.append(Candidate("unknown", "velocity", drag, (("square", c.unit), ("cube", c.unit))))
    speed = np.sign(c.speed) * np.log1p(np.abs(c.speed) / 5e-5)
    knots = spline_columns(speed, 9)
    out.append(
        Candidate("unknown", "velocity", knots, tuple((f"knot_{k}", c.unit) for k in range(knots.shape[1])))
    )
    loops = [stop_operator(c.angle, c.session, r) / r for r in (3e-4, 1e-3, 3e-3, 8e-3, 0.02)]
    out.append(
        Candidate(
            "unknown",
            "reversal",
            np.column_stack(loops),
            tuple((f"loop_{k}", c.unit) for k in range(len(loops))),
        )
    )
    for r, loop in zip((3e-4, 1e-3, 3e-3, 8e-3, 0.02), loops, strict=True):
        out.append(
            Candidate("unknown", "reversal", loop[:, None], (("loop", c.unit),), fixed={"travel": (r, "rad")})
        )
    out += fixed_lines(c, e, rows, period_s, f.clock)
    return out


def fixed_lines(
    c: Context, e: Array, rows: Mask, period_s: float, clock: Array, count: int = 3
) -> list[Candidate]:
    """The strongest lines at fixed Hz with their next four harmonics: periodic in time, at every speed."""
    span = float(np.ptp(clock))
    x = np.where(rows, e, 0.0)
    hertz, power = order_spectrum(
        x, clock, rows.astype(float), min(0.5 / period_s, 2e5 / max(float(np.ptp(clock)), 1.0))
    )
    power = np.where(hertz < max(0.05, 4 / span), 0.0, power)
    out = []
    for f0 in peaks(hertz, power, count, 3.0 / span):
        x = 2 * np.pi * float(f0) * clock
        one = np.column_stack([np.cos(x), np.sin(x)])
        out.append(
            Candidate(
                "unknown",
                "time",
                one,
                (("amplitude", c.unit),),
                kind="line",
                frequency=float(f0),
                fixed={"frequency": (float(f0), "Hz")},
            )
        )
        if f0 * 5 < 0.45 / period_s:
            more = [g(h * x) for h in range(1, 6) for g in (np.cos, np.sin)]
            out.append(
                Candidate(
                    "unknown",
                    "time",
                    np.column_stack(more),
                    (("amplitude", c.unit),),
                    kind="line",
                    frequency=float(f0),
                    fixed={"frequency": (float(f0), "Hz")},
                )
            )
    return out
