"""A name whose negative control was accepted is withdrawn: what is wrong on purpose must not fit as well."""

from __future__ import annotations

from typing import Any

from calibration.finding import Finding

#: (channel, what, why) as in the report's `refused`
Refused = tuple[str, str, str]


def withdraw(findings: list[Finding], controls: list[dict[str, Any]]) -> tuple[list[Finding], list[Refused]]:
    """Findings that keep their name, and a refusal for each that does not.

    A control belongs to the finding of the same `name`, `stage`, `harmonic` and `channel`; one that says
    nothing of these (other drives' rows) withdraws nothing.
    """
    failed: dict[tuple[Any, ...], list[str]] = {}
    for c in controls:
        if c["accepted"] and "name" in c:
            failed.setdefault((c["name"], c["stage"], c["harmonic"]), []).append(c["what"])
    kept, refused = [], []
    for f in findings:
        wrong = failed.get(f.key)
        if wrong:
            place = f" on {f.stage}" if f.stage else ""
            why = f"withdrawn: accepted as well with {', '.join(w.split(' (')[0] for w in wrong)}"
            refused.append((f.channel, f.name + place, why))
        else:
            kept.append(f)
    return kept, refused
