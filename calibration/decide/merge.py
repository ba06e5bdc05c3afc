"""One cause shows up in several channels: its traces become one finding."""

from dataclasses import replace

from calibration.finding import UNKNOWN, Finding
from calibration.names import NAMES
from calibration.names.name import Beside

# share of the held-out mean square, that the torque's effects explain: what is left is no wind. ASSUMPTION
EXPLAINED = 0.4
# share of the mean square of another channel, up to which anything may be a trace. ASSUMPTION
ANY_TRACE = 0.3
# part of the strongest torque effect's share: a further one that takes less is its remainder. ASSUMPTION
SUPERFLUOUS = 0.25
WEAK = 25.0  # -log10 p below which such a small one is not worth its name. ASSUMPTION


def merge(findings: list[Finding]) -> list[Finding]:
    """Findings of all channels as a list of effects, strongest first."""
    out = _without_remainders(_without_traces(_same_key(_resolve_gain(findings))))
    return sorted(out, key=lambda f: -(f.share + min(f.evidence, 1000.0) / 1e5))


def traces(findings: list[Finding], kept: list[Finding]) -> list[tuple[str, str, str]]:
    """Refusals (channel, what, why) of the names that `merge` took for traces of others."""
    names = {f.name for f in kept}
    why = f"taken for a trace of {', '.join(sorted(names))}"
    return [(f.channel, f.name, why) for f in findings if f.name not in names]


def _beside(f: Finding) -> Beside:
    return NAMES[f.name].beside


def _resolve_gain(findings: list[Finding]) -> list[Finding]:
    """What the torque shows of a name that the electrical channel settles: it does, or says who may."""
    electrical = {f.name for f in findings if f.channel == "E"}
    out = []
    for f in findings:
        others = _beside(f).settled_by
        if f.channel == "T" and others:
            if electrical & {f.name, *others}:
                continue
            f = replace(f, equivalent=list(dict.fromkeys([*f.equivalent, *others])))
        out.append(f)
    return out


def _place(f: Finding) -> tuple[str, str | None]:
    """Where a name is one effect."""
    return f.name, None if _beside(f).single else f.domain if f.name == UNKNOWN else f.stage


def _is_twist(f: Finding) -> bool:
    """Whether the encoders show by how much the trains are twisted."""
    return f.channel == "K" and "amplitude" in f.parameters


def _same_key(findings: list[Finding]) -> list[Finding]:
    """One finding of a name and place; its twist, which the encoders show, beside its torque."""
    twists = {f.key: f.parameters["amplitude"] for f in findings if _is_twist(f)}
    torques = {_place(f) for f in findings if f.channel == "T"}
    best: dict[tuple[str, str | None], Finding] = {}
    # of one late column the sensors tell most, whatever its share
    for f in sorted(findings, key=lambda f: ("SKETU".find(f.channel) * (f.domain == "clock"), -f.share)):
        if _is_twist(f) and _place(f) in torques:
            continue
        if f.channel == "T" and f.key in twists:
            f = f.having(kinematic=twists[f.key])
        first = best.setdefault(_place(f), f)
        if not _beside(f).single and f.harmonic != first.harmonic and f.channel == first.channel:
            best[(f"{f.name} {f.harmonic}", f.stage)] = f
    return list(best.values())


def _without_traces(findings: list[Finding]) -> list[Finding]:
    """Findings that are plausible, and no traces of others."""
    explained = max((f.share for f in findings if f.channel == "T" and not _beside(f).leftover), default=0.0)
    plausible = [f for f in findings if _beside(f).plausible(f)]
    kept = [f for f in plausible if not _beside(f).leftover or explained <= EXPLAINED]
    return [f for f in kept if not any(_is_trace(f, other) for other in findings if other is not f)]


def _is_trace(f: Finding, of: Finding) -> bool:
    """Whether `f` can be a trace of another one. In one channel only a remainder is: both were fitted."""
    b = _beside(of)
    if f.name in b.shadows.get(f.channel, ()):
        return True
    if f.name not in b.consequences.get(of.channel, ()):
        return False
    if f.channel == of.channel == "T" and not _beside(f).leftover:
        return f.share < SUPERFLUOUS * of.share
    return _beside(f).leftover or f.share <= max(of.share, ANY_TRACE)


def _without_remainders(findings: list[Finding]) -> list[Finding]:
    """Findings but for weak ones of the torque beside a much stronger one there."""
    least = SUPERFLUOUS * max((f.share for f in findings if f.channel == "T"), default=0.0)
    return [f for f in findings if f.channel != "T" or not 0 < f.share < least or f.evidence >= WEAK]
