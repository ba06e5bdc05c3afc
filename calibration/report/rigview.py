"""`schmidt rig`: what was understood of a drive's files, before anything is fitted."""

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from jinja2 import Environment, FileSystemLoader

from calibration.balances.balance import problem_of
from calibration.balances.thresholds import FEWEST_ROWS
from calibration.balances.view import WINDOW, view_of
from calibration.balances.width import NARROW, USUAL
from calibration.decide.accept import least_share
from calibration.inputs.declaration import Response, Rig
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import Run, Signal, signal_of
from calibration.inputs.thresholds import MOST_POINTS
from calibration.look.settled import one_filter
from calibration.report.plots import drawn, figure

# candidates that a balance has before one is known to be none of it. ASSUMPTION
USUAL_CANDIDATES = 1000
TABLES = 4  # runs that have a table of their columns: of more there is a line each. ASSUMPTION


def show_rig(rig_file: Path, logs: list[Path], out: Path | None = None) -> str:
    """Text for the terminal: the declaration and a table of columns per file; `out`: a PNG of all columns.

    Raises CalibrationInputError as `schmidt calibrate` would.
    """
    rig = load_rig(rig_file)
    lines = _declaration(rig).splitlines()
    drive = read_drive(logs, rig) if logs else None
    records = drive.records if drive is not None else []
    if drive is not None and records:
        lines.append(f"files start by {drive.clock}")
        for k, r in enumerate(records):
            lines += [*[""] * (k <= TABLES), _head(r), *(_table(r.signals.values()) if k < TABLES else [])]
            lines += [f"  ! {x.channel}: {x.note}" for x in r.repairs]
        lines += ["", *(x for response in rig.responses for x in _power(records, rig, response))]
    elif drive is not None:
        for run in drive.runs:
            signals = [signal_of(c, c, SI.get(c, ""), x, 0) for c, x in run.columns.items()]
            lines += ["", f"{run.name}: {run.rows} rows, {run.duration_s:.6g} s", *_table(signals)]
    if out is not None and records:
        _draw(records, rig, out)
        lines += ["", f"plot: {out}"]
    return "\n".join(lines)


#: units of the columns of logs whose format says what they are, as they are read
SI = {"t": "s", "effort": "1", "supply": "V", "temperature": "degC"}
SI |= dict.fromkeys(("position", "aux"), "rad") | dict.fromkeys(("current_a", "current_b"), "A")
SI |= dict.fromkeys(("velocity", "setpoint", "motor_a", "motor_b"), "rad/s")
SI |= dict.fromkeys(("ra", "dec", "dither"), "arcsec")


def _declaration(rig: Rig) -> str:
    """What the rig file says of the drive."""
    env = Environment(loader=FileSystemLoader(Path(__file__).parent), trim_blocks=True, lstrip_blocks=True)
    env.filters["g"] = "{:g}".format
    env.filters["listed"] = lambda numbers: ", ".join(f"{k} = {v:g}" for k, v in numbers.items())
    unit = rig.columns["position"].unit if "position" in rig.columns else "turns"
    return env.get_template("rig.txt.j2").render(rig=rig, unit=unit)


def _power(records: list[Run], rig: Rig, response: Response) -> Iterator[str]:
    """What a log of these rows could show of a response: its filter, and how often it passes each stage. Also
    the smallest line that would have a name beside a rest as large as the response is now."""
    if rig.motors is not None or rig.drifts or sum(r.rows for r in records) < FEWEST_ROWS:
        return
    view, finer = (view_of(records, rig, response, limits) for limits in (USUAL, NARROW))
    made = partial(problem_of, view, records, [])
    if view.dynamic:
        one_filter(view, made)
    p = made()
    if not (p.train.any() and p.test.any()):
        return
    width = WINDOW * view.sigma * view.period_s
    through = f"a filter of {width:.3g} s" if view.filter.sigma else "no filter"
    if finer.wide < view.wide:
        through += f" ({WINDOW * finer.wide * view.period_s:.3g} s where that shows nothing)"
    yield f"{response.channel}: {p.train.sum()} rows to fit through {through}, {p.blocks} independent blocks"
    span = float(np.ptp(view.x[view.rows][p.train]))
    if response.is_force and not view.both:
        yield "  it moves one way, which does not separate Coulomb friction from an offset"
    turns = [f"{span / g.period:.4g} of {g.name}" for g in rig.stages if g.period]
    if turns:
        yield f"  turns: {', '.join(turns)}"
    if not rig.estimate:
        yield f"  its terms: {', '.join(name for name, _ in p.base_labels)}"
    rest = float(np.std(p.plain_fit(p.train)[1][p.train]))
    share = least_share(p, USUAL_CANDIDATES)
    yield f"  the declared terms leave {rest:.3g} {p.unit} rms"
    line = f"a line of {rest * np.sqrt(2 * share):.3g} {p.unit} or more, {100 * share:.0f} % of its square"
    yield f"  could be named beside that: {line if share < 1 else 'nothing, as the log is too short'}"


def _head(r: Run) -> str:
    gaps = r.gaps()
    lost = f", {len(gaps)} gaps of {sum(b - a for a, b in gaps):.4g} s in all" if gaps else ", no gaps"
    rate = 1 / r.period_s
    start = f", starts at {r.start_s:.6g} s" if r.start_s is not None else ""
    return f"{r.name}: {r.rows} rows, {r.duration_s:.6g} s at {rate:.5g} Hz{lost}{start}"


def _table(signals: Iterable[Signal]) -> list[str]:
    rows = [("channel", "column", "unit", "low", "high", "quantum", "missing", "wraps")]
    for s in signals:
        step = "none" if s.quantum is None else f"{s.quantum:.3g}"
        numbers = (f"{s.low:.5g}", f"{s.high:.5g}", step, str(s.missing), str(s.wraps))
        rows.append((s.channel, s.column, s.unit, *numbers))
    wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  " + "  ".join(c.ljust(w) for c, w in zip(row, wide, strict=True)).rstrip() for row in rows]


def _draw(records: list[Run], rig: Rig, out: Path) -> None:
    """Every column over the clock that the files share."""
    names = [c for c in rig.columns if c != "time"]
    fig, axes = figure(9.0, 1.6 * len(names) + 0.6, rows=len(names), sharex=True, squeeze=False)
    for ax, name in zip(axes[:, 0], names, strict=True):
        for k, r in enumerate(records):
            step = max(r.rows // MOST_POINTS, 1)
            t, x = r.columns["t"][::step] + (r.start_s or 0.0), r.columns[name][::step]
            broken = np.diff(t, prepend=t[0]) > step * r.gap_s
            ax.plot(t, np.where(broken, np.nan, x), lw=0.7, color=f"C{k % 2}")
        ax.set_ylabel(f"{name}\n{rig.columns[name].unit}")
    axes[-1, 0].set_xlabel("time, s")
    axes[0, 0].set_title(rig.name, loc="left")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(drawn(fig))
