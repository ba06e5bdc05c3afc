"""report.json of any drive: from what was looked at and the closed loop run again to the verdict."""

from dataclasses import asdict
from typing import Any

from calibration.decide.selection import Selection
from calibration.decide.verdict import conventions, effect_as_dict, judge
from calibration.decide.withdraw import Refused
from calibration.look.looked import Looked
from calibration.replay.held import Replay

MOST_HIDDEN = 2
"""Names of one answer whose worth was ever measured: the sealed logs hide two effects at most. arithmetic"""
LARGEST_STATISTIC = 1e6
"""Of a channel's gate, that report.json holds: a log without noise has an infinite one. ASSUMPTION."""


def report_of(found: Looked, again: Replay) -> dict[str, Any]:
    """report.json, with a few fields beside the contract's; `again` is the closed loop's replay."""
    verdict, separating = judge(list(found.effects), found.needs)
    error = {b.row: b.error for b in found.balances if b.held_out and b.row} | dict(found.rows)
    notes = [*found.notes, *(x for b in found.balances for x in b.notes)]
    short = [x for b in found.balances for x in b.short]
    names = {(e.name, e.stage) for e in found.effects if not e.of_column}
    earned = found.earned if len(names) <= MOST_HIDDEN else None
    return {
        "verdict": verdict,
        "effects": [effect_as_dict(e, k, error, earned) for k, e in enumerate(found.effects)],
        "error": error,
        **({"closed_loop": again.rows} if again.rows else {}),
        "held_out": list(found.held_out),
        "calibrated": {name: asdict(p) for name, p in found.calibrated.items()},
        "not_identifiable": found.unsure,
        "separating_experiment": separating,
        "controls": [{**row, "channel": b.key} for b in found.balances for row in b.controls],
        "thresholds": {b.key: _gate(b.selection) for b in found.balances},
        "reasons": list(dict.fromkeys([*notes, *again.reasons, *short, *found.said])),
        "conventions": conventions(found.effects),
        "refused": [{"channel": c, "what": w, "why": y} for c, w, y in _refused(found)],
    }


def _gate(s: Selection) -> dict[str, float]:
    return {"threshold": s.scores.threshold, "statistic": min(s.statistic, LARGEST_STATISTIC)}


def _refused(found: Looked) -> list[Refused]:
    """Everything that was tried and rejected, with the first reason of each."""
    seen: dict[tuple[str, str], str] = {}
    for b in found.balances:
        for r in b.selection.refused:
            seen.setdefault((b.key, r.what), r.why)
    return [*found.refused, *((key, what, why) for (key, what), why in seen.items())]
