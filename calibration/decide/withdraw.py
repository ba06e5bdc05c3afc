"""Findings that keep their name: what speaks against one when everything has been fitted and tried."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from calibration.decide.rules import negative
from calibration.decide.selection import Selection
from calibration.decide.thresholds import LUCK_Z
from calibration.finding import UNKNOWN, Finding

#: (channel, what, why) as in the report's `refused`
Refused = tuple[str, str, str]
Against = Callable[[Finding], str]
"""Why a finding does not keep its name; empty when it does."""


def withdraw(findings: Sequence[Finding], *against: Against) -> tuple[list[Finding], list[Refused]]:
    """Findings that keep their name, and a refusal for each that does not."""
    said = [(f, next(filter(None, (says(f) for says in against)), "")) for f in findings]
    refused = [
        (f.channel, f"{f.name} on {f.stage}" if f.stage else f.name, f"withdrawn: {why}")
        for f, why in said
        if why
    ]
    return [f for f, why in said if not why], refused


def accepted(f: Finding, controls: Sequence[Mapping[str, Any]]) -> list[str]:
    """Accepted controls of the finding's name and place, or of its order: a line may have been renamed."""
    line = f"in place of {f.order:.4g} (" if f.order else None
    return [
        c["what"].split(" (")[0]
        for c in controls
        if c["accepted"]
        and ((c["name"], c["stage"], c["harmonic"]) == f.key or bool(line and line in c["what"]))
    ]


def failed_controls(controls: Sequence[Mapping[str, Any]]) -> Against:
    """What is wrong on purpose must not fit as well."""

    def says(f: Finding) -> str:
        wrong = accepted(f, controls)
        return f"accepted as well with {', '.join(wrong)}" if wrong else ""

    return says


def against_nature(selections: Mapping[str, Selection]) -> Against:
    """A fit with a negative mass, friction, resistance or torque constant names nothing in its channel."""
    wrong = {channel: negative(s, LUCK_Z) for channel, s in selections.items()}

    def says(f: Finding) -> str:
        name = wrong.get(f.channel)
        if not name:
            return ""
        s, p = selections[f.channel], selections[f.channel].problem
        return f"beside it {name} would be {p.named(s.after)[name].value:.3g} {dict(p.base_labels)[name]}"

    return says


def unnamed(findings: list[Finding], controls: Sequence[Mapping[str, Any]]) -> list[Finding]:
    """The findings of a rig's balance; what loses its name stays as `unknown`."""
    out = []
    for f in findings:
        wrong = accepted(f, controls)
        if wrong and f.name != UNKNOWN:
            note = f"{wrong[0]} fits as well: the name {f.name} is withdrawn. {f.note}".strip()
            f = replace(f, name=UNKNOWN, stage=None, harmonic=None, equivalent=[], note=note)
        out.append(f)
    return out
