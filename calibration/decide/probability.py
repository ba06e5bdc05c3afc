"""How often answers of the same kind were right on sealed development logs: the probability of a name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from calibration.decide.thresholds import STILL_MISSING, Earned
from calibration.finding import Finding

#: channel of an effect -> the row of the error table it is judged by
ROWS = {"T": "torque", "K": "position", "E": "electrical", "S": "velocity"}


def kind_of(effect: Finding, place: int, error: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Kind of an answer: by what is left in its channel, by whether the log tells its name from others, by
    its place in the list. None where the channel's floor is not known."""
    row = error.get(ROWS.get(effect.channel, ""))
    if not row or not row["floor"]:
        return None
    if row["after"] > STILL_MISSING * row["floor"]:
        return "above"
    if effect.equivalent:
        return "ambiguous"
    return "sole" if place == 0 else "further"


def probability(
    effect: Finding,
    place: int,
    error: Mapping[str, Mapping[str, Any]],
    earned: Mapping[str, Earned] | None,
) -> float | None:
    """That the name itself is right; None for drives and kinds of answer that no sealed logs were made of."""
    kind = kind_of(effect, place, error)
    if earned is None or kind is None or kind not in earned:
        return None
    return earned[kind].probability
