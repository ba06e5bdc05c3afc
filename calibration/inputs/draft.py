"""A rig file drafted from a log: from names and units of its columns, and from what moves with what."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.ndimage import gaussian_filter1d

from calibration.arrays import Array
from calibration.errors import CalibrationInputError
from calibration.inputs.clock import STRAY
from calibration.inputs.declaration import GUESSED
from calibration.inputs.loose import Loose, read_loose, said
from calibration.inputs.repair import counter_length
from calibration.inputs.run import quantum
from calibration.inputs.thresholds import GAP, LARGEST_NUMBER
from calibration.inputs.units import PER_TURN, units_per_turn

SOFT = 5.0  # rows: standard deviation of the filter before a rate or a force is compared. ASSUMPTION
IS_RATE = 0.8  # share of a column's variance that a rate must explain, to be that rate. ASSUMPTION
BESIDE = 0.5  # of what the direction alone leaves of a column, that its rate may. ASSUMPTION
# likewise rate, direction and acceleration of a column that is a force by nothing else. ASSUMPTION
IS_FORCE = 0.05
SAME_PLACE = 0.99  # correlation of two columns that show one place. ASSUMPTION
# of a factor between a rate and a column, that is a factor between two units all the same. ASSUMPTION
NEAR = 0.03
TURNS = 3.0  # turns that a log has of a stage worth declaring. ASSUMPTION
STEADY = 0.2  # of the mean, that a steady speed or supply may scatter. ASSUMPTION
EITHER_WAY = 0.05  # share of rows that move either way, before friction is told from an offset. ASSUMPTION
SINCE_1970_S = 1e9  # s since 1970, from where a stamp is the time of day: the year 2001. definition
# of what another column of its channel and unit moves: a joint that stands beside one that moves. ASSUMPTION
STANDS = 0.01
LEAST_BITS = 6  # bits of a sensor's turn, at least, by which its unit is guessed. ASSUMPTION
# of a power of two of steps, that a turn may be off it: what six digits of a scale leave. arithmetic
WHOLE_BITS = 1e-4
WHOLE_DECIMALS = 1e-3  # of a power of ten, likewise, that a decimal's step may be off it. arithmetic
#: between a rate's unit and the position's, per s
FACTORS = (1.0, 1 / 60, 6.0, np.pi / 30, np.pi / 180, 180 / np.pi, 1e-3)
FORCES = ("force", "current", "effort")


@dataclass
class _Role:
    """A column in its channel; `why` where it was guessed, `x` (n,) in `unit`."""

    column: str | int
    unit: str
    x: Array
    scale: float = 1.0
    why: str = ""
    more: dict[str, Any] = field(default_factory=dict)

    def line(self, channel: str) -> str:
        """Of the rig file."""
        told: dict[str, Any] = {} if self.column == "" else {"column": self.column}
        told |= {"unit": self.unit or "units", **self.more}
        return _flow(f"  {channel}", told | ({"scale": self.scale} if self.scale != 1 else {}), self.why)


@dataclass
class _Draft:
    """What was said of a log so far: `left` are columns without a channel."""

    left: dict[str | int, Array]
    roles: dict[str, _Role] = field(default_factory=dict)
    fields: dict[str, tuple[Any, str]] = field(default_factory=dict)
    unsaid: list[str] = field(default_factory=list)
    period_s: float = 1.0

    def put(self, channel: str, column: str | int, unit: str, scale: float = 1.0, why: str = "") -> _Role:
        """Give a column its channel."""
        self.roles[channel] = _Role(column, unit, self.left.pop(column) * scale, scale, why)
        return self.roles[channel]

    def rate(self, x: Array) -> Array:
        """Of a column (n,), per s."""
        return np.asarray(gaussian_filter1d(np.gradient(x), SOFT)) / self.period_s


def draft(path: Path) -> str:
    """A rig file's text; CalibrationInputError for a log without two columns, or that needs no rig file."""
    loose = read_loose(path)
    finite = {c: np.where(np.abs(x) <= LARGEST_NUMBER, x, np.nan) for c, x in loose.columns.items()}
    columns = {c: x for c, x in finite.items() if np.isfinite(x).sum() > SOFT and np.nanstd(x) > 0}
    good = {c: np.flatnonzero(np.isfinite(x)) for c, x in columns.items()}
    d = _Draft({c: np.interp(np.arange(len(x)), good[c], x[good[c]]) for c, x in columns.items()})
    d.unsaid += [f"{c!r} holds one number, or none" for c in loose.columns if c not in columns]
    d.unsaid += [f"{c!r} holds words" for c in loose.words]
    _clock(d, loose)
    rows = len(next(iter(columns.values()), ()))
    if not d.left:
        raise CalibrationInputError(path, "has no column of numbers that move, beside the time")
    _by_name(d)
    _by_motion(d)
    _response(d)
    d.unsaid += [f"{c!r}: a channel for it; it is left out" for c in d.left]
    text = [f"# Drafted from {path.name!r}: {rows} rows at {1 / d.period_s:.5g} Hz. Check what is 'guessed'."]
    text += [*(f"# could not say: {x}" for x in d.unsaid), _flow("rig", path.stem, ""), "columns:"]
    text += [role.line(channel) for channel, role in d.roles.items()]
    told = {k: (v, "") for k, v in loose.fields.items()} | d.fields
    return "\n".join([*text, *(_flow(k, v, why) for k, (v, why) in told.items()), ""])


def _flow(key: str, value: Any, why: str) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, width=np.inf, allow_unicode=True, sort_keys=False)
    return f"{key}: {text.removesuffix('...' + chr(10)).strip()}" + (f"   # guessed: {why}" if why else "")


def _clock(d: _Draft, loose: Loose) -> None:
    """The time: by its name, else a column that goes on evenly."""
    steps = {c: np.diff(x) for c, x in d.left.items() if np.isfinite(loose.columns[c]).all()}
    forward = {c: s for c, s in steps.items() if np.mean(s < 0) <= STRAY and np.median(s) > 0}
    named = [c for c in forward if c == loose.stamp or said(c).channel == "time"]
    even = [c for c, s in forward.items() if not said(c).channel and np.quantile(s, 0.9) < 3 * np.median(s)]
    if not (found := [*named, *even]):
        d.fields["sample_period_s"] = 1.0, "the log has no time; give the s between two rows"
        return
    column = found[0]
    forward_steps, says = np.maximum(forward[column], 0.0), said(column)
    step = float(np.median(forward_steps))
    scale, why = (says.scale, "") if says.channel == "time" and says.unit else (1.0, "")
    if not says.unit and column != loose.stamp:
        digits = int(max(np.log10(max(d.left[column][0], 1.0)) - 8.5, 0) // 3)  # s since 1970 have ten digits
        whole = step >= 1 and np.allclose(d.left[column] % 1, 0)
        scale, why = 1e-3 ** (digits or int(whole)), "its unit, by the size of its steps"
    role = d.put("time", column, "s", scale, why if scale != 1 else "")
    role.more |= {"format": "iso"} if column == loose.stamp else {}
    steps_in = forward_steps[forward_steps < GAP * step]
    d.period_s = float(np.mean(steps_in)) * scale
    if column == loose.stamp or role.x[0] > SINCE_1970_S:
        d.fields["wall_time"] = {"from": "time"}, ""


def _by_name(d: _Draft) -> None:
    for column, x in sorted(d.left.items(), key=lambda item: (said(item[0]).asked, _stands(d, item[0]))):
        says = said(column)
        channel = "reference" if says.asked and says.channel in ("", "position") else says.channel
        if channel == "supply" and np.std(x) > STEADY * abs(np.mean(x)):
            channel = "effort"
        if channel == "label" and np.allclose(x % 1, 0) and "runs" not in d.fields:
            d.fields["runs"] = {"column": column}, ""
            d.left.pop(column)
        elif says.asked and channel in FORCES and not d.roles.keys() & FORCES:
            d.put("effort", column, says.unit, says.scale, "asked for, but no other column is a force")
        elif (says.asked and channel != "reference") or channel in ("count", "label", "time"):
            d.left.pop(column)
            why = "asked for, not measured" if says.asked else channel
            d.unsaid.append(f"{column!r}: {why}; it is left out")
        elif channel and channel not in d.roles:
            d.put(channel, column, says.unit, says.scale)


def _stands(d: _Draft, column: str | int) -> bool:
    """Whether a column hardly moves beside another one of its channel and unit."""
    kind = said(column).channel, said(column).unit
    alike = [np.ptp(x) for c, x in d.left.items() if (said(c).channel, said(c).unit) == kind]
    return bool(np.ptp(d.left[column]) < STANDS * max(alike))


def _by_motion(d: _Draft) -> None:
    """Position and rate: the one is the other's slope."""
    if not d.roles.keys() & {"position", "velocity"} and d.left:
        d.put("position", *_smoothest(d))
    if "position" not in d.roles:
        d.roles["position"] = _integral(d)
        return
    p = d.roles["position"]
    if length := counter_length(p.x / p.scale):
        p.more["wrap"], p.x = length, np.unwrap(p.x, period=length * abs(p.scale))
    _unit(d, p)
    rate = d.rate(p.x)
    near = {c: _like(gaussian_filter1d(x, SOFT), rate) for c, x in d.left.items()}
    if "velocity" not in d.roles and near:
        column = max(near, key=lambda c: near[c][0])
        # friction goes with it, too
        by_side, _ = _like(gaussian_filter1d(d.left[column], SOFT), np.sign(rate))
        if 1 - near[column][0] < min(1 - IS_RATE, BESIDE * (1 - by_side)):
            d.put("velocity", column, "", 1.0, "goes with the position's rate")
    if "velocity" in d.roles:
        _scaled(d, d.roles["velocity"], p, rate)


def _integral(d: _Draft) -> _Role:
    """A position that no column shows: of the speed, or of one that the rig file has to say."""
    v, more = d.roles.get("velocity"), {"integrated": True}
    if v is None:
        steps = {"steps": [[0, 1.0]], **more}
        return _Role("", "turn", np.arange(9.0), why="there is none; give the speed", more=steps)
    unit = v.unit.removesuffix("/s") if v.unit.endswith("/s") else "units"
    why, x = "there is none: the speed's integral", np.cumsum(v.x) * d.period_s
    return _Role(v.column, unit, x, v.scale, why, more)


def _smoothest(d: _Draft) -> tuple[str | int, str, float, str]:
    """Of the columns that say nothing: the one whose slope another shows, else the smoothest."""
    soft = {c: gaussian_filter1d(x, SOFT) for c, x in d.left.items()}
    pairs = [(_like(soft[b], d.rate(a)), c) for c, a in d.left.items() for b in soft if b != c]
    for (share, slope), column in sorted(pairs, key=lambda pair: -pair[0][0])[:1]:
        if share > IS_RATE and slope > 0:
            return column, said(column).unit, 1.0, "another column is its rate"
    joined = {c: np.unwrap(x, period=counter_length(x) or 4 * np.ptp(x)) for c, x in d.left.items()}
    column = min(joined, key=lambda c: float(np.std(np.diff(joined[c])) / np.ptp(joined[c])))
    return column, said(column).unit, 1.0, "the smoothest column"


def _like(y: Array, x: Array) -> tuple[float, float]:
    """Share of y's variance that x explains, and y per x."""
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y) / max(float(x @ x), 1e-300)
    return 1 - float(np.sum((y - slope * x) ** 2)) / max(float(y @ y), 1e-300), slope


def _unit(d: _Draft, p: _Role) -> None:
    """Of the position, by its sensor's step: a power of two of them is a turn."""
    step, length = quantum(p.x), p.more.get("wrap", 0.0) * abs(p.scale)
    if not p.unit:
        p.unit, p.why = "units", "; ".join(filter(None, [p.why, "its unit is not said"]))
        for unit in ("rad", "deg", "turn"):
            parts = np.log2(PER_TURN[unit] / step) if step else 0.5
            if parts > LEAST_BITS and abs(parts - round(parts)) < WHOLE_BITS:
                p.unit, p.why = unit, f"its unit: a turn is {2 ** round(parts)} of its steps"
        if p.unit == "units" and said(p.column).angle and np.ptp(p.x) < 2 * PER_TURN["rad"]:
            p.unit, p.why = "rad", "its unit, as the name is an angle's"
    turn = units_per_turn(p.unit) or length
    if not units_per_turn(p.unit) and length:
        d.fields["turn"] = length, "the counter's length is a turn"
    if turn and np.ptp(p.x) > TURNS * turn:
        shaft = {"name": "shaft", "period": float(turn), "harmonics": 12, "kind": GUESSED}
        d.fields["stages"] = [shaft], "one turn of the position; give the gear table"
    else:
        d.unsaid.append("the gear table (stages)")


def _scaled(d: _Draft, v: _Role, p: _Role, rate: Array) -> None:
    """The measured rate in the position's unit, or left out."""
    soft = gaussian_filter1d(v.x, SOFT)  # as the rate is
    share, _ = _like(soft, rate)
    steady = np.std(rate) < STEADY * abs(np.mean(rate))
    if share < IS_RATE and not steady:
        d.unsaid.append(f"what {v.column!r} is: it does not go with the position's rate; it is left out")
        del d.roles["velocity"]
        return
    factor = float(np.mean(rate) / np.mean(v.x)) if steady else float(rate @ soft / (soft @ soft))
    v.scale, v.x = v.scale * factor, v.x * factor
    near = min(FACTORS, key=lambda f: abs(float(np.log(f / abs(v.scale)))))
    fits = abs(np.log(near / abs(v.scale))) < NEAR
    v.scale = float(f"{np.copysign(near, factor):.12g}" if fits else f"{v.scale:.5g}")
    v.unit = f"{p.unit}/s"
    v.why = "; ".join(filter(None, [v.why, "" if fits else "its factor, by the position's rate"]))


def _response(d: _Draft) -> None:
    """What is explained: a force, one sensor against another, a speed, a free motion."""
    p = d.roles["position"]
    rate = d.rate(p.x)
    top = float(np.quantile(np.abs(rate), 0.95))
    both = bool(min(np.mean(rate > EITHER_WAY * top), np.mean(rate < -EITHER_WAY * top)) > EITHER_WAY)
    varied = both or bool(np.std(rate) > STEADY * abs(np.mean(rate)))
    found = [c for c in FORCES if c in d.roles]
    if not found:
        _same_place(d, p, rate)
        found = [c for c in ("position2",) if c in d.roles] or _unnamed(d, rate) or _against_the_set_point(d)
    if "reference" in d.roles:
        d.roles["reference"].unit = d.roles["reference"].unit or p.unit
    kept = {"time", "position", "velocity", "temperature", "supply", "reference", "acceleration", *found[:1]}
    terms = ["inertia"] * varied + ["viscous"] * varied + ["coulomb"] * both + ["offset"]
    if found and found[0] in FORCES:
        force, normal = d.roles[found[0]], d.roles.get("normal")
        told = {"channel": found[0], "unit": force.unit or "units"}
        if normal is not None and normal.unit == force.unit:
            told, kept = told | {"unit": "1", "divide_by": "normal"}, kept | {"normal"}
        d.unsaid += [f"{d.roles[c].column!r} is not explained: {found[0]} is" for c in found[1:]]
    elif found:
        told, terms = {"channel": "position2", "unit": d.roles["position2"].unit or p.unit}, []
    elif "velocity" in d.roles and (not both or p.more.get("integrated")):
        told, terms = {"channel": "velocity", "unit": d.roles["velocity"].unit}, ["offset"]
    elif both:
        told, terms = {"channel": "acceleration", "unit": f"{p.unit}/s2"}, ["viscous", "coulomb", "offset"]
    else:
        told, terms = {"channel": "position", "unit": p.unit}, []
        d.fields.pop("stages", None)
    for channel in set(d.roles) - kept:
        d.roles.pop(channel)
    d.fields["response"] = told, "" if found else "the log shows no force"
    if terms:
        d.fields["estimate"] = terms, ""


def _same_place(d: _Draft, p: _Role, rate: Array) -> None:
    """Another sensor of the position, or a set point: that leads, a sensor does not."""
    for column, x in list(d.left.items()):
        steps, own = quantum(x), quantum(p.x / p.scale)
        told = steps and abs(np.log10(steps) - np.rint(np.log10(steps))) > WHOLE_DECIMALS
        alike = bool(told and own and np.isclose(steps or 0.0, own, rtol=1e-3))
        if abs(np.corrcoef(x, p.x)[0, 1]) < SAME_PLACE and not alike:
            continue
        ahead = _like(x - p.x / p.scale, rate)[1]
        if not alike and "reference" not in d.roles:
            other = d.put("reference", column, p.unit, p.scale, "it moves as the position does")
            if ahead < 0:
                p.column, other.column, p.x, other.x = other.column, p.column, other.x, p.x
        elif "position2" not in d.roles:
            d.put("position2", column, p.unit, p.scale, "it has the position's steps")


def _against_the_set_point(d: _Draft) -> list[str]:
    """Without a force: what is measured against what is asked for."""
    if "reference" not in d.roles or "velocity" in d.roles:
        return []
    d.roles["position2"], d.roles["position"] = d.roles["position"], d.roles.pop("reference")
    d.roles["position2"].why = "against what is asked for, as the log shows no force"
    return ["position2"]


def _unnamed(d: _Draft, rate: Array) -> list[str]:
    """The column without a name that goes most with the motion, as a force."""
    motion = np.column_stack([rate, np.sign(rate), np.gradient(rate), np.ones(len(rate))])
    shares = {}
    for column, x in d.left.items():
        y = gaussian_filter1d(x, SOFT)
        left = y - motion @ np.linalg.lstsq(motion, y, rcond=None)[0]
        shares[column] = 1 - float(np.var(left) / max(np.var(y), 1e-300))
    best = max(shares, key=lambda c: shares[c], default=None)
    if best is None or shares[best] < IS_FORCE:
        return []
    why = f"rate, direction and acceleration explain {100 * shares[best]:.0f} % of it"
    d.put("effort", best, said(best).unit, 1.0, why)
    return ["effort"]
