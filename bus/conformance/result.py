"""What one check found."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Level(StrEnum):
    """must: the protocol says so; should: a sound network does it."""

    MUST = "must"
    SHOULD = "should"


@dataclass(frozen=True, slots=True)
class CheckResult:
    """One check of one subject (a frame or a command); duration_s is the time the check took on the
    bus's clock."""

    check: str
    subject: str
    level: Level
    passed: bool
    expected: str
    observed: str
    duration_s: float


def summary(results: Sequence[CheckResult]) -> dict[str, Any]:
    """Machine-readable: counts, the verdict (every `must` holds), and all results."""
    failed = Counter(str(result.level) for result in results if not result.passed)
    return {
        "format": "schmidt-conformance 1",
        "passed": not failed[Level.MUST],
        "checks": len(results),
        "failed_must": failed[Level.MUST],
        "failed_should": failed[Level.SHOULD],
        "results": [asdict(result) for result in results],
    }
