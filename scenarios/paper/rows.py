"""One row of the table: published beside emulated, with the verdict and its reason."""

from dataclasses import dataclass, field
from typing import Any

from scenarios.paper.published import PUBLISHED


@dataclass(frozen=True)
class Row:
    """Result of one experiment. emulated: the figure in the row's unit; details: everything else that was
    measured."""

    id: str
    emulated: float
    passed: bool
    reason: str
    details: dict[str, Any] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """Return the row as the JSON file has it."""
        said = PUBLISHED[self.id]
        return {
            "id": self.id,
            "published": said.figure,
            "emulated": round(self.emulated, 6),
            "unit": said.unit,
            "passed": self.passed,
            "reason": self.reason,
            "where": said.where,
            "quote": said.quote,
            "bound": said.bound,
            **self.details,
        }


def verdict(checks: list[tuple[bool, str]]) -> tuple[bool, str]:
    """Return (all hold, what was found; what failed comes first and is marked)."""
    failed = [text for holds, text in checks if not holds]
    held = [text for holds, text in checks if holds]
    words = ["MISS: " + "; ".join(failed)] if failed else []
    if held:
        words.append("; ".join(held))
    return not failed, ". ".join(words)
