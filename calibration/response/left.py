"""What is above the floor when every name has been tried: where it lives, and what it does to the names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.channels.view import View
from calibration.decide.heldout import predict_residual
from calibration.decide.judge import design, phases
from calibration.decide.missing import LEAST_SHARE, domain_share
from calibration.decide.select import Selection
from calibration.decide.thresholds import STILL_MISSING
from calibration.finding import Finding
from calibration.names.scene import Scene
from calibration.names.unknown import domains
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

# of the mean square above the floor: names that leave more than they take are not what the log mostly holds.
# ASSUMPTION, one half by that reasoning; looked at on development seeds and the opened seed 20261122
MOST_LEFT = 0.5
# floors of a force beyond which a domain is looked for: balances of forces of 144 sealed drives without an
# effect stay below 1.4 (seeds 1036 and 1038; one whose fitted files go one way only apart)
TELLING = 1.6
FEWEST = 60  # rows that are not fitted, where the position is resolved. ASSUMPTION: fewer are a few moves


@dataclass(frozen=True)
class Left:
    """What remains of a balance: `times` the floor, `part` of what was above it before; the domain it is a
    function of (None: of none that was tried), in words, and the share of its mean square there."""

    times: float
    part: float
    domain: str | None = None
    where: str = "in no domain that was tried"
    share: float = 0.0


def left_over(s: Selection, scene: Scene, floor: float | None) -> Left | None:
    """What is left beyond TELLING floors of a force, STILL_MISSING of sensors; of a force first where the
    position is resolved: the floor of all rows holds what a coarse sensor may hide. None where it is less, or
    no floor is known."""
    held, p = s.held, s.problem
    if not floor or not np.isfinite(held.after):
        return None
    if scene.force and p.resolved is not None:
        rows, noise = p.resolved
        test = p.test & rows
        if test.sum() >= FEWEST:
            before = _rms(predict_residual(p, p.base, s.before.beta, test))
            after = _rms(_residual(s)[test])
            if after > STILL_MISSING * noise:
                return _where(s, scene, rows, Left(after / noise, _part(before, after, noise)))
    if held.after <= (TELLING if scene.force else STILL_MISSING) * floor:
        return None
    return _where(s, scene, p.valid, Left(held.after / floor, _part(held.before, held.after, floor)))


def _part(before: float, after: float, floor: float) -> float:
    """Of what was above the floor."""
    return (after**2 - floor**2) / max(before**2 - floor**2, floor**2)


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


def _where(s: Selection, scene: Scene, rows: Mask, found: Left) -> Left:
    """`found` with the domain whose bin means take most of what is left of `rows`, file by file from the
    others' means: one file may hardly have been where it lives."""
    e, p = _residual(s), s.problem
    rows = rows & p.valid
    files = [p.session == k for k in np.unique(p.session[rows])]
    test = rows & p.held
    by_file = [(rows & ~f, rows & f) for f in files] if len(files) > 2 else []
    sign = np.sign(scene.view.direction[scene.view.rows])
    for domain, x, words in _places(scene):
        for shape, how in ((e, ""), (e * sign, ", against the motion"), (np.abs(e), ", in size")):
            z = shape - float(np.mean(shape[rows])) if how == ", in size" else shape
            share = max(domain_share(z, x, p.train & rows, test), _over_files(z, x, by_file))
            if share > max(found.share, LEAST_SHARE):
                found = Left(found.times, found.part, domain, f"over {words}{how}", share)
    return found


def _over_files(z: Array, x: Array, folds: list[tuple[Mask, Mask]]) -> float:
    weight = [float(np.sum(z[test] ** 2)) for _, test in folds]
    shares = [domain_share(z, x, train, test) for train, test in folds]
    return float(np.average(shares, weights=weight)) if sum(weight) > 0 else 0.0


def _places(scene: Scene) -> list[tuple[str, Array, str]]:
    """Domain, its values on the fitted rows, and words for it."""
    v: View = scene.view
    out = [(name, x, name.replace("_", " ")) for name, x in domains(scene)]
    x = v.x[v.rows]
    out += [("axis_angle", x % g.period, f"the turn of {g.name}") for g in v.rig.stages if g.period]
    return out


def _residual(s: Selection) -> Array:
    """Residual on all fitted rows, with the fresh nuisances and phases of what is held out."""
    p, chosen = s.problem, [c.candidate for c in s.chosen]
    x = design(p, chosen)
    e = np.asarray(p.y - x @ s.after.beta)
    e[p.test] = predict_residual(p, x, s.after.beta, p.test, phases(p, chosen))
    return e


def settle(findings: list[Finding], left: Left | None, channel: str) -> list[Finding]:
    """Findings with the names that they may keep: names that leave most of the log above its floor go, and
    what nobody named is `unknown` where it lives."""
    if left is None:
        return findings
    named = [f for f in findings if f.name != "unknown"]
    size = f"{left.times:.1f} floors are left {left.where}"
    if not findings:
        return [_unknown(left.domain, channel, left, size)] if left.domain else []
    if not named or left.part <= MOST_LEFT:
        return findings
    first = max(named, key=lambda f: f.share)
    names = ", ".join(dict.fromkeys(f.name for f in named))
    note = f"{names} would take {100 * (1 - left.part):.0f} % of what is above the floor only: {size}"
    return [_unknown(first.domain, channel, left, note), *[f for f in findings if f.name == "unknown"]]


def _unknown(domain: str, channel: str, left: Left, note: str) -> Finding:
    return Finding("unknown", channel, domain, share=left.share, note=note)
