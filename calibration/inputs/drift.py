"""A table of a position at constant rate, as the sections that a guide log has."""

from __future__ import annotations

import numpy as np

from calibration.inputs.declaration import Rig
from calibration.inputs.record import Record
from calibration.readers.guide import CLOCK
from calibration.readers.run import Run


def sections_of(records: list[Record], rig: Rig) -> list[Run]:
    """Every record as a section: `ra` the response, in its unit; no dithers, no jumps but repaired ones."""
    response = next(r for r in rig.responses if r.channel == "position")
    out = []
    for r in records:
        y = r.columns["position"] * response.gain
        good = np.isfinite(y)
        columns = {"t": r.columns["t"][good], "ra": y[good], "segment": np.zeros(int(good.sum()))}
        header = {"unit": response.unit, "mount": rig.name}
        if rig.wall_time:
            header[CLOCK] = f"{r.start_s or 0.0:.6f}"
        notes = [f"{r.name}, {x.channel}: {x.note}" for x in r.repairs]
        out.append(Run(r.name, r.path, r.name, columns, header=header, notes=notes))
    return out
