"""How patient and how bold the checks are."""

from collections.abc import Callable
from dataclasses import dataclass

from bus.conformance.result import CheckResult


def _nobody(_result: CheckResult) -> None:
    """Nobody wants to see results as they come."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """listen_s: how long telemetry is collected; at least three of the longest period, or periods go
    unchecked.

    reply_s: how long an answer may take. quiet_s: how long to watch for a second answer.
    answer_s: how long a sound board takes, seconds. ASSUMPTION: two periods of the 5 ms control loop, the
        slowest a host can close a loop over the bus with.
    period_tolerance: of the mean period, relative. 2 %: crystals are within 0.01 %, the rest is for the
        PC's clock.
    stamps_s: uncertainty of the tester's time stamps, seconds; 0 in process. 1 ms: a full-speed USB adapter
        hands over frames once per USB frame (USB 2.0, 8.4.3).
    speed: simulated seconds per second of the bus's time stamps (`schmidt serve --speed`).
    motion: also send commands that power or move something. Off by default: the bus may be a real
        telescope's. Everything is stopped at the end.
    flood: also fill the bus. Off by default: a board rightly remembers, and reports, what it had to drop.
    canopen: check what a CANopen master expects, and nothing else.
    each: called with every result as it is found.
    """

    listen_s: float = 4.2
    reply_s: float = 1.0
    quiet_s: float = 0.03
    answer_s: float = 0.010
    period_tolerance: float = 0.02
    stamps_s: float = 0.001
    speed: float = 1.0
    motion: bool = False
    flood: bool = False
    canopen: bool = False
    each: Callable[[CheckResult], None] = _nobody
