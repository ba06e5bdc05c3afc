"""`schmidt rig`: what was understood of a drive's files, before anything is fitted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from calibration.inputs.declaration import Friction, FrictionLaw, Motors, Rig
from calibration.inputs.logs import read_drive
from calibration.inputs.record import Record, Signal, signal_of
from calibration.inputs.rigfile import load_rig

MOST_POINTS = 4000  # drawn per column


def show(rig_file: Path, logs: list[Path], out: Path | None) -> str:
    """Text for the terminal: the declaration and a table of columns per file; `out`: a PNG of all columns.

    Raises CalibrationInputError as `schmidt calibrate` would.
    """
    rig = load_rig(rig_file)
    drive = read_drive(logs, rig) if logs else None
    lines = [_declaration(rig)]
    records = drive.records if drive is not None else []
    if drive is not None and records:
        lines.append(f"files start by {drive.clock}")
        for r in records:
            lines += ["", _head(r), *_table(r.signals)]
            lines += [f"  ! {x.channel}: {x.note}" for x in r.repairs]
    elif drive is not None:
        for run in drive.runs:
            at = f"{run.name}: {run.rows} rows, {run.duration_s:.6g} s"
            lines += [
                "",
                at,
                *_table({c: signal_of(c, c, SI.get(c, ""), x, 0) for c, x in run.columns.items()}),
            ]
    if out is not None and records:
        _draw(records, rig, out)
        lines += ["", f"plot: {out}"]
    return "\n".join(lines)


#: units of the columns of logs whose format says what they are, as they are read
SI = {
    "t": "s",
    "position": "rad",
    "aux": "rad",
    "velocity": "rad/s",
    "setpoint": "rad/s",
    "effort": "1",
    "current_a": "A",
    "current_b": "A",
    "motor_a": "rad/s",
    "motor_b": "rad/s",
    "supply": "V",
    "temperature": "degC",
    "ra": "arcsec",
    "dec": "arcsec",
    "dither": "arcsec",
}


def _declaration(rig: Rig) -> str:
    what = "; ".join(
        f"{r.channel} in {r.unit}"
        + (f", times {r.gain:g}" if r.gain != 1 else "")
        + (f", over {r.divide_by}" if r.divide_by else "")
        for r in rig.responses
    )
    known = ", ".join(f"{k} = {v:g}" for k, v in rig.constants.items())
    unit = rig.columns["position"].unit if "position" in rig.columns else "turns"
    stages = ", ".join(
        f"{g.name} {g.period:g} {unit}" if g.period else f"{g.name} {g.period_s:g} s" for g in rig.stages
    )
    law = rig.controller
    gains = ", ".join(f"{k} = {v:g}" for k, v in law.gains.items()) if law else ""
    parts = [rig.name]
    if rig.motors is not None:
        parts += [*_motors(rig.motors), *(_friction(f) for f in rig.friction)]
    elif rig.drifts:
        parts.append("explains a position at constant rate over time")
    else:
        parts += [f"explains {what}", f"estimates {', '.join(rig.estimate) or 'its usual terms'}"]
    return "\n".join(
        [
            *parts,
            *([f"knows {known}"] if known else []),
            *([_friction_law(rig.friction_law, unit)] if rig.friction_law is not None else []),
            *([f"stages {stages}"] if stages else []),
            *([f"controlled by a {law.law}, {gains}"] if law else []),
        ]
    )


def _motors(m: Motors) -> list[str]:
    first = f"two motors: {m.torque_constant:g} N m/A, {m.resistance:g} ohm"
    return [
        f"{first}, trains of {m.train_stiffness:g} N m/rad, counter torque {100 * m.counter_torque:g} %",
        "explains torque, volts, encoders and command of the axis, as far as it has the columns",
    ]


def _friction_law(law: FrictionLaw, unit: str) -> str:
    dip = f"{law.stiction_ratio:g} times Coulomb's from rest, Stribeck {law.stribeck_speed:g} {unit}/s"
    dip += f" to the power {law.stribeck_exponent:g}" if law.stribeck_exponent != 2.0 else ""
    bristles = f"bristles of {law.bristle_travel:g} {unit}" if law.bristle_travel is not None else ""
    return "friction law: " + "; ".join([dip] * (law.stiction_ratio != 1.0) + [bristles] * bool(bristles))


def _friction(f: Friction) -> str:
    when = f" ({f.state})" if f.state else ""
    return (
        f"friction{when}: Coulomb {f.coulomb:g} N m, stiction {f.stiction:g} N m,"
        f" Stribeck {f.stribeck_rate:g} rad/s, viscous {f.viscous:g} N m s/rad,"
        f" bristles {f.bristle_stiffness:g} N m/rad"
    )


def _head(r: Record) -> str:
    gaps = r.gaps()
    lost = f", {len(gaps)} gaps of {sum(b - a for a, b in gaps):.4g} s in all" if gaps else ", no gaps"
    rate = 1 / r.period_s
    start = f", starts at {r.start_s:.6g} s" if r.start_s is not None else ""
    return f"{r.name}: {r.rows} rows, {r.duration_s:.6g} s at {rate:.5g} Hz{lost}{start}"


def _table(signals: Mapping[str, Signal]) -> list[str]:
    rows = [("channel", "column", "unit", "low", "high", "quantum", "missing", "wraps")]
    for s in signals.values():
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
