"""A position at constant rate, the drive error of a guided mount: its worm and what that does not explain."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.guide import guide_problem, piece_s, usable
from calibration.balances.mounts import SIDEREAL_DAY_S, known_mount, parts
from calibration.balances.problem import Problem
from calibration.decide.controls import Wrong, controls
from calibration.decide.merge import merge
from calibration.decide.residual import Place
from calibration.decide.selection import Selection
from calibration.decide.withdraw import failed_controls, withdraw
from calibration.finding import Finding
from calibration.inputs.declaration import Rig
from calibration.inputs.run import Run
from calibration.look import looked
from calibration.look.jumps import with_jumps
from calibration.look.looked import Balance, Looked, Options, Spectrum
from calibration.look.worm import (
    LEAST_TURNS,
    Mount,
    findings,
    harmonics,
    is_seen,
    longest_span,
    sections_of,
    worms,
)

LEAST_ROWS = 100  # frames to fit. ASSUMPTION
# of a turn, over the whole log, by which a worm with a tooth more runs away from this one (ASSUMPTION)
TOOTH_APART = 0.3
WRONG_PERIODS = (0.9, 1.1)  # of a worm's rate: a tenth off is another wheel on any mount. ASSUMPTION
FEW = 4  # parts of a mount, whose turns are looked at for what is left. ASSUMPTION
OF_ALL_FRAMES = "offsets, drift and the dithers' gain are fitted to all frames, before and after alike"
TURN = "the turn of "  # words of where a rest lives
NEED = "guide one section for at least two turns of the worm (half an hour for most mounts), without a slew"
ON_THE_CLOCK = (
    "whole sections are held out, so the clock carries the worm's phase there, and a slew breaks it."
    " Without --hold-out a piece of every section is held out in its turn"
)


def look_at_drift(runs: list[Run], rig: Rig | None, options: Options) -> Looked:
    """Look at a position at constant rate, and put together what the answer is made of."""
    title = f"Guide log, {runs[0].header.get('mount', 'unnamed mount')}"
    sections, notes = usable(runs, options.hold_out)
    if all(r.among(options.hold_out) for r in sections):
        return Looked.nothing(title, "no section is long enough to say anything", NEED)
    mount = Mount(parts=parts(sections, rig), named=rig is not None or bool(known_mount(sections)))
    two_s = LEAST_TURNS * mount.periods_s[-1]
    need = NEED if rig is None else f"log two turns of the slowest part, {two_s:.3g} s, without a gap"

    made = partial(guide_problem, sections, options.hold_out, quickest_s=mount.periods_s[0])
    problem, held_out = made(mount.periods_s[-1])
    frames = int(problem.train.sum())
    if frames < LEAST_ROWS:
        few = f"{frames} frames to fit are too few to say anything (at least {LEAST_ROWS})"
        return Looked.nothing(title, few, need)
    s = worms(problem, lambda slowest_s: made(slowest_s)[0], mount)
    span, p, jumped = longest_span(problem), s.problem, list[Finding]()
    if not options.hold_out:
        s, jumped = with_jumps(s, partial(_when, sections, p))
        held_out = [f"pieces of {piece_s(p):.0f} s, in turn"]
        notes.append(OF_ALL_FRAMES)
    few = f"fewer than {LEAST_TURNS:.0f} turns in one section, and too few in all"
    slow = [f"{part.name} ({few})" for part in mount.parts if not is_seen(problem, part.rate)]
    if len(slow) > FEW and not mount.named:  # the log names no mount that is known
        slow = [f"{len(slow)} of the usual worms ({few})"]
    tried = controls(s, partial(wrong_worm, p), reversed_time=False)
    effects, refused = withdraw(merge(findings(s, mount, span)), failed_controls(tried))
    effects += jumped
    b = _balance(s, mount, slow, tried)
    needs = [f"{what} was close, but {why}" for _, what, why in refused]
    if slow:
        needs = [f"a longer section without a slew: two turns, for {'; '.join(slow)}"]
    if b.missing is not None and b.missing.where.startswith(f"over {TURN}"):  # of a part that the log names
        needs.append(b.still)
    effects, needs = looked.unnamed_where_missing(effects, [*needs, *b.short], [b])
    return Looked(
        title=title,
        balances=[b],
        effects=effects,
        needs=needs,
        held_out=held_out,
        refused=refused,
        notes=[*(n for r in runs for n in r.notes), *notes, *([ON_THE_CLOCK] if problem.domains else [])],
    )


def _balance(s: Selection, mount: Mount, slow: list[str], tried: list[dict[str, Any]]) -> Balance:
    """The drive error, with the phases over which it is drawn and what is missing in it."""
    p, stages = s.problem, {part.name: part.rate for part in mount.parts}
    clock = p.domains.get("clock", p.t)
    b = Balance(
        key="position",
        row="position",
        selection=s,
        floor=p.floor,
        numbers=looked.calibrated(s, ("offset",)),
        controls=tried,
        not_identifiable=slow,
        over=partial(_over, p, clock),
        spectrum=Spectrum(turns=p.t, stages=stages, label="period, s", periods=True),
    )
    near = stages if len(stages) <= FEW else {}  # usual wheels that were only tried say nothing
    turns = [Place(f"{TURN}{name}", None, (clock * rate) % 1.0) for name, rate in near.items()]
    missing = looked.missing_over(b, [Place("time", None, p.t), *turns])
    if missing is None:
        return b
    # no plant has an effect for what a night's air leaves; most of it over a part's turn is no air
    turning = missing.domain is None and missing.share > looked.MOST
    return replace(b, missing=replace(missing, effect=turning))


def _when(sections: list[Run], p: Problem, row: int) -> str:
    """The time of a row, as its section's table has it."""
    k = int(p.run[row])
    section = sections[k]
    at_s = section.columns["t"][0] + p.t[row] - p.t[p.run == k][0]
    return f"{at_s:.0f} s" + (f" of {section.name}" if len(sections) > 1 else "")


def _over(p: Problem, clock: Array, c: Candidate) -> tuple[Array, str]:
    """Phase or time, that an effect is drawn over."""
    if not c.frequency:
        return p.t, "time, s"
    return clock * c.frequency % 1.0, f"phase of the period of {1 / c.frequency:.2f} s, turns"


def wrong_worm(p: Problem, _: int, c: Candidate) -> list[Wrong]:
    """A part of a mount with one tooth more and less, and with another period."""
    if not c.stage or not c.frequency:
        return []
    out, waves = [], range(1, c.width // 2 // sections_of(p, c.frequency) + 1)
    for step, word in ((1, "more"), (-1, "less")):
        rate = c.frequency + step / SIDEREAL_DAY_S
        what = f"one tooth {word}: {1 / rate:.2f} s"
        if float(np.ptp(p.t)) < TOOTH_APART * SIDEREAL_DAY_S:
            out.append(Wrong(what=what, note="this log is too short to tell one tooth from the next"))
        else:
            out.append(Wrong(what=what, columns=harmonics(p, rate, waves)))
    for rate in (c.frequency * factor for factor in WRONG_PERIODS):
        out.append(Wrong(what=f"wrong period: {1 / rate:.1f} s", columns=harmonics(p, rate, waves)))
    return out
