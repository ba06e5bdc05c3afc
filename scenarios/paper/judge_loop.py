"""Verdicts on E1 to E6: velocity errors, closed and open loop."""

from collections.abc import Sequence

from scenarios.paper.log import Log
from scenarios.paper.measures import (
    cycles,
    line_amplitude,
    means,
    peak_percent,
    peaks,
    rms_percent,
    strongest_line,
)
from scenarios.paper.rows import Row, verdict
from scenarios.paper.runs import LOW, TRACKING, HighSpeed, LowSpeed

TRACKING_LIMIT = 25.0
RMS_LIMIT = 100.0 / TRACKING
VERY_HIGH = 100.0
CYCLES = 3
HIGH_BAND = (2.0, 7.0)
SLOW_SLEW_LIMIT = 1.0
OPEN_BAND = (10.0, 15.0)
LINE_BAND = (0.04, 0.06)
LOWEST_BAND = (80.0, 115.0)
NEAREST = 15.0
LINE_LEFT = 0.3


def e1(log: Log) -> Row:
    """Tracking, low preload."""
    peak = peaks(log, TRACKING)
    rms = rms_percent(means(log.true_rate), TRACKING)
    passed, reason = verdict(
        [
            (
                peak.logged <= TRACKING_LIMIT,
                f"peak {peak.logged:.1f} % of 5 ms counts (true {peak.true:.1f} %, "
                f"1 s mean {peak.second:.2f} %)",
            ),
            (rms <= RMS_LIMIT, f"rms of 1 s means {rms:.2f} %"),
        ]
    )
    return Row("E1", peak.logged, passed, reason, peak.as_dict() | {"rms_1s_percent": round(rms, 4)})


def e2(log: Log) -> Row:
    """Tracking, high preload."""
    peak = peaks(log, TRACKING)
    found = cycles(log.true_rate, TRACKING)
    passed, reason = verdict(
        [
            (
                peak.logged > VERY_HIGH,
                f"peak {peak.logged:.0f} % of 5 ms counts (1 s mean {peak.second:.0f} %)",
            ),
            (found >= CYCLES, f"{found} limit cycles in {log.t_s[-1] - log.t_s[0]:.0f} s"),
        ]
    )
    return Row("E2", peak.logged, passed, reason, peak.as_dict() | {"limit_cycles": found})


def e3(runs: Sequence[HighSpeed]) -> Row:
    """Closed loop, 600 to 1000 arcsec/s."""
    each = {f"{run.setpoint:g}": peaks(run.closed, run.setpoint) for run in runs}
    logged = [peak.logged for peak in each.values()]
    passed, reason = verdict(
        [
            (
                HIGH_BAND[0] <= max(logged) <= HIGH_BAND[1],
                "peaks " + ", ".join(f"{peak.logged:.1f} % at {k}″/s" for k, peak in each.items()),
            ),
        ]
    )
    return Row("E3", max(logged), passed, reason, {"by_speed": {k: p.as_dict() for k, p in each.items()}})


def e4(logs: Sequence[tuple[float, Log]]) -> Row:
    """Closed loop, 1 to 3 deg/s."""
    each = {f"{speed:g}": peaks(log, speed) for speed, log in logs}
    worst = max(peak.logged for peak in each.values())
    text = ", ".join(f"{float(k) / 3600:g}°/s {p.logged:.2f} %" for k, p in each.items())
    passed, reason = verdict([(worst < SLOW_SLEW_LIMIT, "peaks " + text)])
    return Row("E4", worst, passed, reason, {"by_speed": {k: p.as_dict() for k, p in each.items()}})


def e5(runs: Sequence[HighSpeed]) -> Row:
    """Open loop, high speed: errors about the set point the effort had held when the loop was opened."""
    opened = [(run, run.opened) for run in runs if run.opened is not None]
    each = {f"{run.setpoint:g}": peaks(log, run.setpoint) for run, log in opened}
    logged = {k: peak.logged for k, peak in each.items()}
    worst = max(logged, key=lambda k: logged[k])
    closed = max(peak_percent(run.closed.rate, run.setpoint) for run, _ in opened)
    top = logged[worst]
    passed, reason = verdict(
        [
            (
                OPEN_BAND[0] <= top <= OPEN_BAND[1],
                "largest peaks " + ", ".join(f"{v:.1f} % at {k}″/s" for k, v in logged.items()),
            ),
            (top > closed, f"closed loop {closed:.1f} %"),
        ]
    )
    return Row("E5", top, passed, reason, {"by_speed": {k: p.as_dict() for k, p in each.items()}})


def e6(run: LowSpeed) -> Row:
    """100 arcsec/s, open against closed loop, and the lowest open-loop speed."""
    nearest, lowest = run.nearest, run.lowest
    if nearest is None or lowest is None:
        return Row(
            "E6", 0.0, False, "MISS: the axis did not keep moving at any open-loop effort below 160″/s"
        )
    mean = float(nearest.rate.mean())
    line = strongest_line(nearest.rate, 0.01, 0.2)
    left = line_amplitude(run.closed.rate, line.frequency_hz) / line.amplitude
    open_peak, closed_peak = peaks(nearest, mean), peaks(run.closed, LOW)
    passed, reason = verdict(
        [
            (LINE_BAND[0] <= line.frequency_hz <= LINE_BAND[1], f"open loop at {mean:.0f}″/s: line at "
             f"{line.frequency_hz:.4f} Hz of {line.amplitude:.1f}″/s"),
            (abs(mean - LOW) <= NEAREST, f"open-loop run {mean:.0f}″/s"),
            (left <= LINE_LEFT, f"closed loop leaves {100 * left:.0f} % of it"),
            (
                closed_peak.logged < open_peak.logged,
                f"peak {open_peak.logged:.0f} % open, {closed_peak.logged:.0f} % closed",
            ),
            (LOWEST_BAND[0] <= lowest <= LOWEST_BAND[1], f"lowest open-loop speed {lowest:.0f}″/s"),
        ]
    )  # fmt: skip
    details = {
        "open_mean_arcsec_s": round(mean, 2),
        "line_amplitude_arcsec_s": round(line.amplitude, 3),
        "closed_over_open_line": round(left, 4),
        "lowest_open_loop_arcsec_s": round(lowest, 2),
        "open": open_peak.as_dict(),
        "closed": closed_peak.as_dict(),
    }
    return Row("E6", line.frequency_hz, passed, reason, details)
