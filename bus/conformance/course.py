"""What a board's own counters tell from frame to frame: its uptime, lost interrupts, errors, its sequence."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, Final, NamedTuple

from bus.conformance.result import CheckResult, doubted, judged
from bus.protocol import State

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
