"""docs/results/measured-drives.md, from the answers that `python -m tests.measured --page` got."""

import math
import re
import statistics
from collections.abc import Sequence
from datetime import date
from typing import NamedTuple

from tests.measured.truth import RIGHT, WRONG, Answer

AT_FLOOR = 1.2
"""An error up to so many floors counts as one at the floor: the blind tests' limit of the median."""
MEANT_S = 20.0
"""What a calibration should take, processor time (docs/results/speed.md)."""
MOST = 4
"""Harmonics that a cell of the table lists."""
GROUPS = 2
"""Names that it lists, so that it has no more words than a sentence may."""


class Source(NamedTuple):
    """Where a data set comes from."""

    keys: str
    what: str
    place: str
    licence: str


SOURCES = (
    Source("xl330", "geared servo that lifts a weight", "github.com/Rhoban/bam", "Apache-2.0"),
    Source("ripple", "servo motors at constant speed", "github.com/Otteri/torque-ripple-data", "none seen"),
    Source("torque_steps", "servo stand, torque steps", "github.com/malik-robert/HSM150-data", "none seen"),
    Source("ur10e", "robot arm, one joint", "github.com/shamilmamedov/dynamic_calibration", "none seen"),
    Source("servo_command", "hobby servo and encoder", "github.com/mauicv/servo-sysid", "none seen"),
    Source(
        "emps",
        "linear axis with ball screw (Janot, Gautier, Brunot 2019)",
        "nonlinearbenchmark.org",
        "to be cited; Apache-2.0 where it is mirrored",
    ),
    Source("servo_cogging", "brushed servo, no load", "github.com/adamb314/ServoProject", "CC BY 3.0 US"),
    Source("servo_output", "geared servo, two encoders", "github.com/adamb314/ServoProject", "CC BY 3.0 US"),
    Source("pendulum", "free swings", "github.com/dynamicslab/MultiArm-Pendulum", "MIT"),
    Source("tribometer", "friction test", "github.com/jchristopherson/FrictionModels.jl", "MIT"),
    Source("phd2", "guide logs of telescope mounts", "github.com/OpenPHDGuiding/phd2", "BSD-3-Clause"),
)
"""In the order of the cases. `keys`: how the keys of its logs begin."""

_HEAD = """# Published measurements of other drives

    python -m tests.measured --page docs/results/measured-drives.md

The command asks {count} questions about published logs, judges the answers and writes this page. One
question is one log, or one choice of the held-out run. The data lie beside the checkout and are not part
of this repository. Measured on {day}. How the finder decides: [calibration](../reference/calibration.md).

## Missed
{missed}
- Measured logs were changed on purpose by a known amount (`tests/calibration/test_changed_logs.py`).
  Three changes were not noticed: a late load of one servo, a load a few per cent larger, and mains
  pick-up of the tribometer.
- The rules were developed with these very logs in view. The figures say that they fit, not that they
  generalise. Of 42 other logs, met for the first time on 2026-11-27, 17 answers are right or hold the
  right class. Ten are half right, twelve say nothing or another domain, and three have a wrong name alone.
  Of 25 further ones eighteen are right or hold the right class. Four say `unknown` where a delay or nothing
  more is there, and three have a wrong name alone. Then rules were corrected, and 23 more were met.
  Seventeen are right or hold the right class, five are `unknown`, four of them with nothing missing.
  One has a name that its truth lacks.
  After further corrections 20 questions were asked of 17 logs, from 11 repositories. Fifteen answers are
  right or hold the right class. Four have a name too many beside the right one. One has a wrong name alone.
  Then 12 questions were asked of ten logs, from eight repositories. Eight answers are right or hold the right
  class, and one is half right. Two hold wrong names only, as a class. One is `unknown` with nothing missing.

## Found
{found}
Errors are held-out rms values of the first balance. *Own* is an ordinary least squares with the
physically right terms, on the same rows. It exists where such terms can be written down.

| log | unit | before | after | floor | own | judged | named |
|---|---|---|---|---|---|---|---|
{rows}

## What counts as right
`tests/measured/cases.py` says what is physically in each log, and what may be named beside it. The
sources below say so, or a least squares shows it. An answer is **right** when everything that is needed
is named, by name or by class, and nothing else. It is **half** when a part is named, or `unknown` stands
for it. It is **missed** when nothing is said, and **wrong** when another name comes first. Some logs hold
nothing that can be named: there *nothing* is right.

## The data
The logs were published by others, for their own ends. Where no licence was seen they are read here only,
and not passed on.

| logs | what | from | licence |
|---|---|---|---|
{sources}
"""


def _figure(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.3g}"


def _named(effects: Sequence[str]) -> str:
    """`gear_mesh motor h6, h2`: harmonics of one name and place together, the first MOST of them."""
    groups: dict[tuple[str, str], list[str]] = {}
    for effect in effects:
        found = re.fullmatch(r"(.*?) (h\d+)( \(or .*\))?", effect)
        key = (found[1], found[3] or "") if found else (effect, "")
        groups.setdefault(key, []).append(found[2] if found else "")
    words = []
    for (name, others), places in groups.items():
        shown = ", ".join(place for place in places[:MOST] if place)
        rest = f" and {len(places) - MOST} more" if len(places) > MOST else ""
        words.append(" ".join(filter(None, (name, shown))) + rest + others)
    return "; ".join(words[:GROUPS]) + (f"; {len(words) - GROUPS} more" if len(words) > GROUPS else "")


def _row(a: Answer) -> str:
    cells = (
        f"`{a.key}`",
        a.unit,
        *map(_figure, (a.before, a.after, a.floor, a.own)),
        a.judged if a.judged == RIGHT else f"**{a.judged}**",
        _named(a.effects) or a.verdict,
    )
    return f"| {' | '.join(cells)} |".replace("|  |", "| |").replace("|  |", "| |")


def _missed(rows: Sequence[Answer]) -> list[str]:
    """The first bullets: answers that are not right, errors above the floor, slow logs."""
    lines = [
        f"- `{a.key}` is judged **{a.judged}**: {a.why or a.verdict}." for a in rows if a.judged != RIGHT
    ]
    floored = [a for a in rows if a.floor > 0 and a.after > 0]
    above = [a for a in floored if a.after > AT_FLOOR * a.floor]
    worst = max(above, key=lambda a: a.after / a.floor, default=None)
    if worst:
        lines.append(
            f"- {len(above)} of {len(floored)} errors stay above {AT_FLOOR:g} times their noise floor. "
            f"The worst is `{worst.key}`: its error is {worst.after / worst.floor:.0f} floors."
        )
    same = [f"`{a.key}`" for a in rows if not a.after < a.before]
    if same:
        lines.append(f"- The held-out error does not fall in {' and '.join(same)}.")
    slow = [a for a in rows if a.seconds > MEANT_S]
    if slow:
        longest = max(slow, key=lambda a: a.seconds)
        lines.append(
            f"- {', '.join(f'`{a.key}`' for a in slow)}: more processor time than is meant, "
            f"{longest.seconds:.0f} s at most."
        )
    return lines


def _found(rows: Sequence[Answer]) -> str:
    right = sum(a.judged == RIGHT for a in rows)
    wrong = sum(a.judged == WRONG for a in rows)
    falls = sum(a.after < a.before for a in rows)
    down = sum(a.floor > 0 and a.after <= AT_FLOOR * a.floor for a in rows)
    compared = [a.after / a.own for a in rows if a.own > 0 and not math.isnan(a.after)]
    lines = [
        f"**{right} of {len(rows)} answers are right**. "
        + (f"{wrong} are wrong." if wrong else "None is answered with a wrong name."),
        f"The held-out error falls in {falls} of {len(rows)}, and comes down to its floor in {down}.",
    ]
    if compared:
        lines.append(f"It is {statistics.median(compared):.2f} times that of *own*, as a median.")
    return "\n".join(lines)


def page(rows: Sequence[Answer], day: date) -> str:
    """The whole page, Markdown. Raises ValueError for a log whose source is not known."""
    for a in rows:
        if not any(a.key.startswith(source.keys) for source in SOURCES):
            raise ValueError(f"{a.key}: SOURCES has no such data")
    return _HEAD.format(
        count=len(rows),
        day=day.isoformat(),
        missed="\n".join(_missed(rows)),
        found=_found(rows),
        rows="\n".join(map(_row, rows)),
        sources="\n".join(
            f"| `{s.keys}`{'…' if sum(a.key.startswith(s.keys) for a in rows) > 1 else ''} | {s.what} | "
            f"<https://{s.place}> | {s.licence} |"
            for s in SOURCES
        ),
    )
