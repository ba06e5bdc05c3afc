"""`schmidt rig`: what was understood of a drive's files, before anything is fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from calibration.inputs.declaration import Rig
from calibration.inputs.record import Record
from calibration.inputs.rigfile import load_rig
from calibration.inputs.tables import read_table, set_starts

MOST_POINTS = 4000  # drawn per column


def show(rig_file: Path, logs: list[Path], out: Path | None) -> str:
    """Text for the terminal: the declaration and a table of columns per file; `out`: a PNG of all columns.

    Raises CalibrationInputError as `schmidt calibrate` would.
    """
    rig = load_rig(rig_file)
    records = [r for path in logs for r in read_table(path, rig)]
    lines = [_declaration(rig)]
    if records:
        lines.append(f"files start by {set_starts(records, rig)}")
    for r in records:
        lines += ["", _head(r), *_table(r)]
        lines += [f"  ! {x.channel}: {x.note}" for x in r.repairs]
    if out is not None and records:
        _draw(records, rig, out)
        lines += ["", f"plot: {out}"]
    return "\n".join(lines)


def _declaration(rig: Rig) -> str:
    what = "; ".join(
        f"{r.channel} in {r.unit}"
        + (f", times {r.gain:g}" if r.gain != 1 else "")
        + (f", over {r.divide_by}" if r.divide_by else "")
        for r in rig.responses
    )
    known = ", ".join(f"{k} = {v:g}" for k, v in rig.constants.items())
    stages = ", ".join(
        f"{g.name} {g.period:g} {rig.columns['position'].unit}" if g.period else f"{g.name} {g.period_s:g} s"
        for g in rig.stages
    )
    law = rig.controller
    gains = ", ".join(f"{k} = {v:g}" for k, v in law.gains.items()) if law else ""
    parts = [rig.name, f"explains {what}", f"estimates {', '.join(rig.estimate) or 'its usual terms'}"]
    return "\n".join(
        [
            *parts,
            *([f"knows {known}"] if known else []),
            *([f"stages {stages}"] if stages else []),
            *([f"controlled by a {law.law}, {gains}"] if law else []),
        ]
    )


def _head(r: Record) -> str:
    gaps = r.gaps()
    lost = f", {len(gaps)} gaps of {sum(b - a for a, b in gaps):.4g} s in all" if gaps else ", no gaps"
    rate = 1 / r.period_s
    start = f", starts at {r.start_s:.6g} s" if r.start_s is not None else ""
    return f"{r.name}: {r.rows} rows, {r.duration_s:.6g} s at {rate:.5g} Hz{lost}{start}"


def _table(r: Record) -> list[str]:
    rows = [("channel", "column", "unit", "low", "high", "quantum", "missing", "wraps")]
    for s in r.signals.values():
        step = "none" if s.quantum is None else f"{s.quantum:.3g}"
        rows.append(
            (s.channel, s.column, s.unit, f"{s.low:.5g}", f"{s.high:.5g}", step, str(s.missing), str(s.wraps))
        )
    wide = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  " + "  ".join(c.ljust(w) for c, w in zip(row, wide, strict=True)).rstrip() for row in rows]


def _draw(records: list[Record], rig: Rig, out: Path) -> None:
    """Every column over the clock that the files share."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    names = [c for c in rig.columns if c != "time"]
    fig, axes = plt.subplots(len(names), 1, figsize=(9.0, 1.6 * len(names) + 0.6), sharex=True, squeeze=False)
    for ax, name in zip(axes[:, 0], names, strict=True):
        for k, r in enumerate(records):
            step = max(r.rows // MOST_POINTS, 1)
            t, x = r.columns["t"][::step] + (r.start_s or 0.0), r.columns[name][::step]
            broken = np.diff(t, prepend=t[0]) > 2.5 * step * r.period_s
            ax.plot(t, np.where(broken, np.nan, x), lw=0.7, color=f"C{k % 2}")
        ax.set_ylabel(f"{name}\n{rig.columns[name].unit}", fontsize=8)
        ax.tick_params(labelsize=8)
        for side in ("top", "right"):
            ax.spines[side].set_visible(False)
    axes[-1, 0].set_xlabel("time, s", fontsize=8)
    axes[0, 0].set_title(rig.name, fontsize=9, loc="left")
    fig.tight_layout()
    out.parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(out, format="png", dpi=110)
    plt.close(fig)
