"""What one check found."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any


class Level(StrEnum):
    """ok: as it should be. info: told, not judged. issue: a sound network does better. error: against the
    protocol."""

    OK = "ok"
    INFO = "info"
    ISSUE = "issue"
    ERROR = "error"


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckResult:
    """One check of one subject (a frame or a command); duration_s: the time it took on the bus's clock."""

    check: str
    subject: str
    level: Level
    expected: str
    observed: str
    duration_s: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong."""
        return self.level in (Level.OK, Level.INFO)


def judged(
    check: str, subject: str, passed: bool, expected: str, observed: str, duration_s: float = 0.0
) -> CheckResult:
    """A check that passed, or is an error."""
    return CheckResult(
        check=check, subject=subject, level=Level.OK if passed else Level.ERROR,
        expected=expected, observed=observed, duration_s=duration_s,
    )  # fmt: skip


def doubted(
    check: str, subject: str, passed: bool, expected: str, observed: str, duration_s: float = 0.0
) -> CheckResult:
    """A check that passed, or is an issue."""
    found = judged(check, subject, passed, expected, observed, duration_s)
    return found if passed else replace(found, level=Level.ISSUE)


def told(check: str, subject: str, observed: str) -> CheckResult:
    """Something worth knowing that is neither right nor wrong."""
    return CheckResult(check=check, subject=subject, level=Level.INFO, expected="", observed=observed)


def summary(results: Sequence[CheckResult]) -> dict[str, Any]:
    """Machine-readable: counts per level, the verdict (no `error`), and all results."""
    counts = Counter(result.level for result in results)
    return {
        "format": "schmidt-conformance 2",
        "passed": not counts[Level.ERROR],
        "checks": len(results),
        **{str(level): counts[level] for level in Level},
        "results": [asdict(result) for result in results],
    }
