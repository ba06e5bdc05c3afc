"""Axis log, version 1, as the log format asks."""

import datetime
from pathlib import Path

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.manoeuvres import Run
from tests.blind.sealer.sensors import Columns

NIGHT = datetime.datetime(2026, 1, 15, 14, 0, 0)
FORMATS = {"t": "%.6f", "setpoint": "%.4f", "temperature": "%.2f"}


def write(path: Path, run: Run, drive: Drive, out: Columns) -> None:
    """Write one run."""
    start = NIGHT + datetime.timedelta(seconds=round(run.start_offset))
    head = {
        "format": "axis-log 1",
        "axis": drive.axis,
        "sample_period_s": "0.010",
        "session": run.session,
        "loop": run.loop,
        "start_utc": start.isoformat() + "Z",
        "preload": drive.preload,
        "counter_torque": f"{drive.values['COUNTER']:g}",
        "supply_V": "24",
        "train_stiffness_Nm_per_rad": f"{d.AXES[drive.axis].stiffness:g}",  # declared, whatever is hidden
    }
    lines = [f"# {key}: {value}" for key, value in head.items()]
    names = list(out)
    lines.append(",".join(names))
    text = []
    for name in names:
        if name in FORMATS:
            text.append(["" if np.isnan(x) else FORMATS[name] % x for x in out[name].tolist()])
        else:
            text.append([str(x) for x in out[name].astype(np.int64).tolist()])
    lines.extend(map(",".join, zip(*text, strict=True)))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
