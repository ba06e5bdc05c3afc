"""When periodic frames come, how much of that the bus explains, and what the board's own counters tell."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil
from typing import Any, Final, NamedTuple

import numpy as np

from bus.conformance.result import CheckResult, doubted, judged
from bus.conformance.settings import Settings
from bus.protocol import State

_FRAME_S = 135e-6
"""Eight data bytes at 1 Mbit/s with every stuff bit, and the intermission (Davis et al. 2007, eq. 2)."""
_RELEASE_S = 0.5e-3
"""Of a board: its interrupts in front of the one that sends. ASSUMPTION: a tenth of the fastest loop."""
_MISSED = 1.5
"""Gaps longer than this many periods are a frame that was left out."""


def queueing_s(messages: Sequence[Any], identifier: int) -> float:
    """Longest a frame waits for the bus, seconds: one frame of less, all of more priority.

    Response time analysis without release jitter (Davis, Burns, Bril, Lukkien, Real-Time Systems 35, 2007,
    eq. 5). messages: of the DBC, `cycle_time` in ms; of those without one (commands and replies) one
    is taken to come. inf: the bus is full.
    """
    higher = [message for message in messages if message.frame_id < identifier]
    periods = [message.cycle_time / 1e3 for message in higher if message.cycle_time]
    wait = _FRAME_S
    while True:
        again = _FRAME_S * (2 + sum(ceil((wait + 1e-6) / period) for period in periods))
        if again <= wait:
            return wait
        wait = again
        if wait > 1.0:
            return float("inf")


def check_timing(
    settings: Settings, subject: str, period_ms: int, stamps: Sequence[float], queueing: float, lost: int
) -> Iterator[CheckResult]:
    """Period, jitter and gap of one frame. stamps: when it was heard, seconds; queueing: seconds the bus may
    hold it up. lost: frames that the tester has dropped; whose they were is not known."""
    ms = 1e3 * settings.speed
    times = np.asarray(stamps) * ms
    gaps = [later - earlier for earlier, later in pairwise(times.tolist())]
    usual = float(np.median(gaps)) or float(period_ms)  # a gap holds several where frames were lost
    mean = sum(gaps) / (sum(max(1, round(gap / usual)) for gap in gaps) if lost else len(gaps))
    observed = f"mean {mean:.3f} ms" + (f", {lost} frames were lost here" if lost else "")
    allowed = (queueing + _RELEASE_S) * 1e3 + settings.stamps_s * ms
    took = float(stamps[-1] - stamps[0])
    yield judged(
        "period", subject, abs(mean - period_ms) <= settings.period_tolerance * period_ms,
        f"{period_ms} ms ± {settings.period_tolerance:.1%}", observed, took,
    )  # fmt: skip
    if not mean:  # an interface without time stamps
        return
    counts = np.round((times - times[0]) / mean)
    grid = np.polyval(np.polyfit(counts, times, 1), counts)
    jitter = float(np.ptp(times - grid))
    # The tester may have lost a frame, or have stamped it late: worth a look, not a verdict on the board.
    expected = f"within {allowed:.3f} ms"
    yield doubted("jitter", subject, jitter <= allowed, expected, f"{jitter:.3f} ms", took)
    limit = _MISSED * period_ms + allowed
    observed = f"{min(gaps):.3f}..{max(gaps):.3f} ms"
    yield doubted("gap", subject, max(gaps) <= limit, f"at most {limit:.3f} ms", observed, took)


_DISTURBED: Final = 96
"""A transmit error counter above this marks a heavily disturbed bus (CAN 2.0, part A, section 7)."""
_COUNTS: Final = 1.0
"""Uptime is whole seconds: a difference of two readings is up to one off."""


class Row(NamedTuple):
    """A frame heard: seconds on the board's clock, and its signals by name."""

    time_s: float
    signals: dict[str, Any]


def check_course(subject: str, rows: Sequence[Row], uncertainty_s: float) -> Iterator[CheckResult]:
    """Judge the counters that `rows`, frames of one kind in their order, have. uncertainty_s: of `time_s`."""
    if not rows:
        return
    told = {name: [row.signals[name] for row in rows] for name in rows[0].signals}
    if "Uptime" in told:
        went = sum((b - a) & 0xFFFF for a, b in pairwise(told["Uptime"]))
        took = rows[-1].time_s - rows[0].time_s
        expected, observed = f"{took:.2f} s more, ± {_COUNTS + uncertainty_s:.3f} s", f"{went} s more"
        yield judged("uptime", subject, abs(went - took) <= _COUNTS + uncertainty_s, expected, observed)
    if "Overruns" in told:
        first, last = told["Overruns"][0], told["Overruns"][-1]
        yield judged("overruns", subject, first == last, "none new", f"{first} at first, {last} at last")
    if "Tec" in told:
        most = max(told["Tec"])
        yield judged("error counter", subject, most <= _DISTURBED, f"TEC up to {_DISTURBED}", f"TEC {most}")
    if "State" in told:
        fault = State.FAULT in told["State"]
        yield judged("state", subject, not fault, "no FAULT", "FAULT" if fault else "none")
    if "Sequence" in told:
        steps = {(b - a) & 0xFF for a, b in pairwise(told["Sequence"])}
        observed = f"steps of {', '.join(map(str, sorted(steps))) or 'none'}"
        # One that stands is the board's; one that skips may be a frame the tester has lost.
        verdict = judged if 0 in steps else doubted
        yield verdict("sequence", subject, steps <= {1}, "one more in every frame", observed)
