"""When periodic frames come: mean period, jitter, longest gap, and how much of that the bus explains."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np

from bus.conformance.result import CheckResult, doubted, judged
from bus.conformance.settings import Settings

_FRAME_S = 135e-6
"""Eight data bytes at 1 Mbit/s with every stuff bit, and the intermission (Davis et al. 2007, eq. 2)."""
_RELEASE_S = 0.5e-3
"""What a board may add: its interrupts in front of the one that sends. ASSUMPTION, a tenth of the fastest
loop."""
_MISSED = 1.5
"""Gaps longer than this many periods are a frame that was left out."""


def queueing_s(messages: Sequence[Any], identifier: int) -> float:
    """Longest a frame waits for the bus, seconds: one frame of less, all of more priority.

    Response time analysis without release jitter (Davis, Burns, Bril, Lukkien, Real-Time Systems 35, 2007,
    eq. 5). messages: of the DBC, `cycle_time` in ms; those without one (commands and replies) are taken to
    come once. inf: the bus is full.
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
    settings: Settings, subject: str, period_ms: int, stamps: Sequence[float], queueing: float, lost: int = 0
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
    counts = np.round((times - times[0]) / mean)
    grid = np.polyval(np.polyfit(counts, times, 1), counts)
    jitter = float(np.ptp(times - grid))
    # The tester may have lost a frame, or have stamped it late: worth a look, not a verdict on the board.
    expected = f"within {allowed:.3f} ms"
    yield doubted("jitter", subject, jitter <= allowed, expected, f"{jitter:.3f} ms", took)
    limit = _MISSED * period_ms + allowed
    observed = f"{min(gaps):.3f}..{max(gaps):.3f} ms"
    yield doubted("gap", subject, max(gaps) <= limit, f"at most {limit:.3f} ms", observed, took)
