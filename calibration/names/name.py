"""What a name is to the finder, and what its file is written with.

A name makes candidates: the domain of their columns and the units of their sizes are the plant's.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.frame import Frame
from calibration.finding import UNKNOWN, Finding
from calibration.names.inplant import Facts, Made, as_found, value
from calibration.names.scene import FORCE, FULL_RATES, MOTOR, RATES, SENSORS, SPEED, VOLTS, Scene
from plant.effects import REGISTRY

__all__ = ["FORCE", "FULL_RATES", "MOTOR", "RATES", "SENSORS", "SPEED", "VOLTS", "Array", "Candidate"]
__all__ += ["Facts", "Finding", "Made", "Scene", "as_found", "value"]

# part of what the declared terms carry, that their own errors leave: neither an amplifier nor a sensor is
# linear to better. ASSUMPTION
OWN_ERRORS = 0.05
WORTH = 0.01  # share of the final held-out mean square, that leaving an effect out must add. ASSUMPTION
# the same share of one whose frequency or order was looked for among hundreds. ASSUMPTION
SEARCHED_WORTH = 0.04

TOLERANCE = 1.29  # times, either way: clear of 20 % (hardware.md 2.3) and of the scatter of an estimate
OF_CLOCKS = ("roller_slip", "damaged_tooth", UNKNOWN)  # what rows at a wrong time look like: steps and spikes
STEP = 0.1  # of a value that is tried, a small change for its refinement. ASSUMPTION
Size = str | tuple[str, str]
"""A parameter of the effect; with a unit of its own where the balance's is another than the plant's."""


def candidate(name: str, columns: Array, *sizes: Size, domain: str | None = None, **more: Any) -> Candidate:
    """One place of an effect: `columns` (n,) or (n, k), one size each; `more`: `Candidate`'s fields."""
    effect = REGISTRY[name]
    labels = tuple((s, effect.parameter(s).unit) if isinstance(s, str) else s for s in sizes)
    wide = columns[:, None] if columns.ndim == 1 else columns
    return Candidate(name, domain or effect.domain, wide, labels, **more)


def tried(
    name: str,
    shape: Callable[[Array], Array],
    *sizes: Size,
    at: Mapping[str, tuple[float, str]],
    steps: tuple[float, ...] | None = None,
    **more: Any,
) -> Candidate:
    """A first value of a search. `shape` gives columns (n, k) of the first len(steps) values of `at`, which
    hold a number and a unit each. `steps` are small changes of them, STEP of the first one unless given. What
    is searched for must pay, unless `more` says otherwise."""
    values = [value for value, _ in at.values()]
    steps = (STEP * values[0],) if steps is None else steps
    more = {"fixed": dict(at), "shape": shape, "steps": steps, "searched": len(steps), **more}
    return candidate(name, shape(np.array(values[: len(steps)])), *sizes, **more)


def grid(
    name: str,
    shape: Callable[[Array], Array],
    *sizes: Size,
    along: tuple[str, Iterable[float], str],
    step: float = STEP,
    beside: Mapping[str, tuple[float, str]] = MappingProxyType({}),
    **more: Any,
) -> list[Candidate]:
    """`tried` at every value `along` one parameter: its name, values and unit; `step` is a part of a value.

    `beside`: parameters that are not searched for.
    """
    called, values, unit = along
    at = ({called: (float(value), unit), **beside} for value in values)
    return [tried(name, shape, *sizes, at=one, steps=(step * one[called][0],), **more) for one in at]


def both_ways(s: Scene) -> str:
    """What a log lacks that goes one way only."""
    return "" if s.both else "motion in both directions over the same place"


def unstated(s: Scene, number: str) -> bool:
    """Whether the rig file of a drive neither estimates a friction number nor knows it."""
    return s.pair is None and number not in (*s.view.rig.estimate, *s.view.rig.constants)


def beside_stated(s: Scene, number: str, along: Array, unit: str) -> list[Candidate]:
    """A change of a friction number `along` full-rate rows, from the known one or from none at all."""
    name, known = f"{number}_change", s.pair is not None or number in s.view.rig.estimate
    return [] if known else [candidate(name, s.at(along), (name, unit))]


@dataclass(frozen=True, kw_only=True)
class Changed:
    """A name that is declared numbers being other ones.

    numbers: number of the drive (an attribute of `Declared`) -> parameter of the finding, the first one being
    its evidence. A parameter of the effect is the quotient with the declared number, another one the number.
    factor: either way, within which a number is as declared. seen: what the speeds must show
    (`decide.tolerance.seen_speeds`). precise: largest relative standard error.
    """

    numbers: Mapping[str, str]
    factor: float = TOLERANCE
    seen: str = "moved"
    precise: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Beside:
    """How a name's findings stand to others'.

    consequences: by the channel it is found in, names whose small findings are its traces. shadows: by the
    others' channel, names that are its traces whatever their size. single: a drive has one, whatever its
    place. leftover: it has no columns and is never more than what is left. settled_by: names of the
    electrical channel that settle it, as it does itself there; without them they are equivalent to it in
    the torque. of_constant: its size is a share of the torque constant. plausible: a finding that is one.
    """

    consequences: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    shadows: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    single: bool = False
    leftover: bool = False
    settled_by: tuple[str, ...] = ()
    of_constant: bool = False
    plausible: Callable[[Finding], bool] = lambda _: True


@dataclass(frozen=True, kw_only=True)
class Name:
    """One name of the catalogue.

    experiment: the cheapest one that tells it from what looks like it. channels: kinds of balance it can be
    seen in, a force's unless it says so. columns: its candidates along a motion; lacks: what a log would
    need to show it, empty when it has all. to_plant: what a finding is in a plant file.

    Of what moves the torque that a current promises: torque_kept gives the part (n,) that its motors keep. It
    takes a candidate, its size, the session time (n,) and the torque constant's quotient (before the effect
    was known, over now). torque_doubt is the relative standard error of all torques, of its size.
    relative: parameters whose columns were made with a coefficient of the base. Each has that one's name, and
    the power of its quotient (before the effect was known, over now). told: what a finding
    is whose sizes do not go together. nuisances: parameters of the search that the plant lacks, and what is
    noted of a finding that has one; none is reported.
    stamps: what the rows and stamps of an axis' log show of it; repairs: kinds of repair in any log's columns
    that are its trace.
    searched: its lines are looked for in what is left by what was found, and again under that. scaled: they
    are no plain sine of an order of their own over the position. waves_of_friction: they are friction's over
    the place. a_guess: of a function of the place it is the simplest form. random: its course is another one
    in every run. worth: share of the final held-out mean square that leaving it out must add. loop:
    parameters that are the width of a loop after every reversal. changed: the declared numbers that it is a
    change of, where it is no more. beside: how it stands to others.
    """

    name: str
    experiment: str
    channels: tuple[str, ...] = (FORCE,)
    columns: Callable[[Scene], list[Candidate]] = lambda _: []
    lacks: Callable[[Scene], str] = lambda _: ""
    torque_kept: Callable[[Candidate, float, Array, float], Array] | None = None
    torque_doubt: float = 0.0
    relative: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    told: Callable[[Finding], Finding] = lambda f: f
    nuisances: Mapping[str, str] = field(default_factory=dict)
    to_plant: Callable[[Finding, Facts], Made] = as_found
    stamps: Callable[[Frame], Finding | None] | None = None
    repairs: tuple[str, ...] = ()
    searched: bool = False
    scaled: bool = False
    waves_of_friction: bool = False
    a_guess: bool = False
    random: bool = False
    worth: float = WORTH
    loop: tuple[str, ...] = ()
    changed: Changed | None = None
    beside: Beside = field(default_factory=Beside)

    def retold(self, f: Finding, quotients: Mapping[str, float]) -> Finding:
        """`f` of the coefficients as they are now; `quotients` (before over now) by their names."""
        told = dict(f.parameters)
        for name, (of, power) in self.relative.items():
            if name in told and of in quotients:
                told[name] = told[name].times(quotients[of] ** power)
        found = self.told(replace(f, parameters=told))
        if found.name != self.name:
            return found
        notes = [found.note, *(self.nuisances[k] for k in self.nuisances if k in told)]
        kept = {k: p for k, p in found.parameters.items() if k not in self.nuisances}
        return replace(found, parameters=kept, note="; ".join(n for n in notes if n))
