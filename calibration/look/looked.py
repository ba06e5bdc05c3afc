"""A drive that was looked at: its balances, effects with the names they keep, residuals above the floor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.slowoffset import SLOW
from calibration.decide.accept import FEW, SHORT, least_share
from calibration.decide.parameters import interval
from calibration.decide.residual import Left, Place, lives_in, part_left
from calibration.decide.selection import Selection
from calibration.decide.thresholds import STILL_MISSING, Earned
from calibration.decide.withdraw import Refused
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.look.axis_result import AxisResult

# floors that are left before they are an effect without a name, or a reason not to say "nothing": the
# emulator's own sound logs, whose boards keep clocks of their own, leave 4.1 at most
# (tests/calibration/test_own_logs.py), a brush that sticks at times 5.5 (development seed 1043)
EFFECT = 5.0
# of the mean square: a log in which only more could be named has shown nothing. ASSUMPTION, half by that word
WEAK = 0.5
# of the rows held out, that are not judged, before the others say "nothing". ASSUMPTION: most of them
UNTOLD = 0.5
# of what is left, over one domain: fewer floors are an effect, too. The same sound logs have 0.29 at most, a
# drag with the square of the speed 0.49 (development seed 1061)
MOST = 0.4


@dataclass(frozen=True, kw_only=True)
class Options:
    """Files to hold out, folder to write into, declared plant file, whether to replay, whom to tell."""

    hold_out: list[str] = field(default_factory=list)
    out: Path = Path(".")
    plant: Path | None = None
    replay: bool = True
    tell: Callable[[str], None] = lambda _: None


@dataclass(frozen=True, kw_only=True)
class Spectrum:
    """Amplitude over what goes round: `turns` (n_fitted,), turns of every known part per one of `turns`, and
    the label. `periods`: drawn over seconds per turn, section by section."""

    turns: Array
    stages: Mapping[str, float]
    label: str
    periods: bool = False


@dataclass(frozen=True, kw_only=True)
class Balance:
    """One balance with what was selected on it.

    key: its letter in report.json. row: of the error table, None where it has none. floor: rms that sensors
    leave, measured apart from the fit. before, declared: held-out rms before a fault of a column was undone,
    where one was, and the declared model then. numbers: the declared ones, re-calibrated. not_identifiable:
    what this motion cannot tell. needs: of the log, before "nothing" could be said. remarks: notes that the
    terminal repeats.
    For pictures: over gives the values (n_fitted,) that an effect is drawn over, and their label; direction
    (n_fitted,) is the motion's.
    """

    key: str
    row: str | None
    selection: Selection
    floor: float | None = None
    before: float | None = None
    declared: Selection | None = None
    findings: Sequence[Finding] = ()
    numbers: Mapping[str, Parameter] = field(default_factory=dict)
    controls: Sequence[dict[str, Any]] = ()
    missing: Left | None = None
    not_identifiable: Sequence[str] = ()
    needs: Sequence[str] = ()
    notes: Sequence[str] = ()
    remarks: Sequence[str] = ()
    over: Callable[[Candidate], tuple[Array, str]] | None = None
    spectrum: Spectrum | None = None
    direction: Array | None = None

    @property
    def error(self) -> dict[str, Any]:
        """Its row of the error table; a floor that is not known is None."""
        s, floor = self.selection, self.floor
        return {
            "unit": s.problem.unit,
            "before": s.held.before if self.before is None else self.before,
            "after": s.held.after,
            "floor": floor if floor is not None and np.isfinite(floor) and floor > 0 else None,
        }

    @property
    def held_out(self) -> bool:
        """Whether it has a row of the error table, and held-out rows for it."""
        return self.row is not None and bool(np.isfinite(self.selection.held.before))

    @property
    def times(self) -> float:
        """Floors that are left on held-out rows; 0 where they or the floor are not known."""
        floor = self.error["floor"]
        return float(self.selection.held.after / floor) if self.held_out and floor else 0.0

    @property
    def fitted_times(self) -> float:
        """Floors that are left on the rows that were fitted; 0 where the floor is not known."""
        floor = self.error["floor"]
        return float(np.sqrt(self.selection.fitted_square) / floor) if floor else 0.0

    @property
    def still(self) -> str:
        """What is missing, as the report says it; empty where nothing is."""
        if (m := self.missing) is None:
            return ""
        of_it = f" ({100 * m.share:.0f} % of its mean square)" if m.share else ""
        return f"something is still missing in {self.row}: {m.times:.1f} floors are left, {m.where}{of_it}"

    @property
    def short(self) -> list[str]:
        """What it holds too little of, where nothing else is named."""
        s, p = self.selection, self.selection.problem
        power = least_share(p, s.looked_at) if not s.chosen and s.looked_at else 0.0
        few = f"{p.train.sum() * p.period_s:.3g} s to fit show only what is {100 * power:.0f} % of it"
        at_the_floor = 0 < self.times <= 1  # what hides below it needs a better sensor, no longer log
        why_not = [] if s.chosen or at_the_floor else s.refused
        refused = [r for r in why_not if r.why.startswith(SHORT)]
        said = [*([few] if power > WEAK else []), *(f"{r.what}: {r.why}" for r in refused)]
        if not s.chosen and p.untold > UNTOLD:
            said.append(f"{100 * p.untold:.0f} % of the rows held out go where no fitted row did")
        return [f"channel {self.key}: {x}" for x in said]


@dataclass(frozen=True, kw_only=True)
class Looked:
    """Everything that the answer is made of.

    effects: with the names they keep, strongest first. needs: of the log, before "nothing" could be said.
    rows: of the error table that no balance has. notes, remarks: of no single balance. header: of an axis log
    that the emulator can run; axis: what its closed loop is run again with.
    """

    title: str
    balances: Sequence[Balance] = ()
    effects: Sequence[Finding] = ()
    needs: Sequence[str] = ()
    rows: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    held_out: Sequence[str] = ()
    not_identifiable: Sequence[str] = ()
    refused: Sequence[Refused] = ()
    notes: Sequence[str] = ()
    remarks: Sequence[str] = ()
    earned: Mapping[str, Earned] | None = None
    header: dict[str, str] | None = None
    axis: AxisResult | None = None

    @classmethod
    def nothing(cls, title: str, why: str, need: str, header: dict[str, str] | None = None) -> Looked:
        """Logs that say nothing, and what would."""
        everything = [f"everything: {why}"]
        return cls(title=title, header=header, needs=[need], notes=[why], not_identifiable=everything)

    @property
    def calibrated(self) -> dict[str, Parameter]:
        """The declared model's numbers of all balances."""
        return {name: p for b in self.balances for name, p in b.numbers.items()}

    @property
    def unsure(self) -> list[str]:
        """What this motion cannot tell."""
        return [*self.not_identifiable, *(x for b in self.balances for x in b.not_identifiable)]

    @property
    def said(self) -> list[str]:
        """What no reader of the verdict should miss."""
        missing = [b.still for b in self.balances if b.missing is not None]
        return [*self.remarks, *(x for b in self.balances for x in b.remarks), *missing]


def missing_over(b: Balance, places: Sequence[Place], stacked: int = 1) -> Left | None:
    """A residual beyond STILL_MISSING floors, over one of `places`, of `stacked` things on end."""
    if b.times <= STILL_MISSING or b.floor is None:
        return None
    nowhere = (None, 0.0, "not looked for")
    domain, share, where = lives_in(b.selection, places, stacked) if places else nowhere
    part = part_left(b.error["before"], b.selection.held.after, b.floor)
    return Left(b.times, part, domain, where, share, effect=b.times > EFFECT or share > MOST)


def unnamed_where_missing(
    effects: list[Finding], needs: Sequence[str], balances: Sequence[Balance]
) -> tuple[list[Finding], list[str]]:
    """What stays far above the floor without any name is `unknown`, else a need.

    It is so over its domain. What hangs on nothing that the log holds, and not on time either, is a need.
    What is much on the fitted rows, too, is no luck of a log that is too short for something.
    """
    large = [(b, m) for b in balances if (m := b.missing) is not None and m.effect]
    if not effects:
        close = any(r.why.startswith((SHORT, FEW)) for b in balances for r in b.selection.refused)
        sure = [(b, m) for b, m in large if not needs or (b.fitted_times > EFFECT and not close)]
        effects = [
            Finding(UNKNOWN, b.key, m.domain, note=b.still) for b, m in sure if m.domain and not m.noise
        ]
    more = [f"{b.still}: a column of what may drive it, or one quantity changed at a time" for b, _ in large]
    return effects, list(dict.fromkeys([*needs, *more]))


def calibrated(s: Selection, skip: tuple[str, ...] = (), model: float | None = None) -> dict[str, Parameter]:
    """The declared model's parameters with intervals, where the log has them at all. `model` is the model's
    own error, of a value, where it is known to be another one than `interval` takes."""
    out: dict[str, Parameter] = {}
    for k, (name, unit) in enumerate(s.problem.base_labels):
        if name in (*skip, SLOW) or name in out or not s.problem.base[:, k].any():
            continue
        value, error = float(s.after.beta[k]), float(s.after.errors[k])
        low, high = interval(value, error, s.problem.blocks, None if model is None else model * value)
        out[name] = Parameter(value, unit, low, high)
    return out
