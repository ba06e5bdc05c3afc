"""What was repaired in columns, as findings: sensors and clocks come before any physics."""

import numpy as np

from calibration.finding import Finding, Parameter, deviation, of_columns
from calibration.inputs.run import Repair, Run
from calibration.names import NAMES

#: kind of repair -> name of the catalogue
CALLED = {kind: n.name for n in NAMES.values() for kind in n.repairs}
FORCES = ("effort", "current", "force", "acceleration")
SAID = {"saturation", "leap", "rounded"}  # told, but no fault of the log
FEWEST = {"repeat": 10}  # rows before a few chance repeats are a finding
# rows of spikes in a force: noise with heavy tails makes one or two; a position's has none. ASSUMPTION
FEWEST_OF_FORCE = 3
# -log10 p: a jump of a counter's whole length, or a row twelve deviations off, is no noise. ASSUMPTION
CERTAIN = 12.0


def repairs_found(records: list[Run], own: tuple[str, ...] = ()) -> list[Finding]:
    """One finding per kind and column, over all files. `own`: channels whose spikes may be the drive's: a
    command whose law is another than the declared one jumps where that law does."""
    groups: dict[tuple[str, str], list[Repair]] = {}
    for fix in (x for r in records for x in r.repairs if x.kind not in SAID):
        if fix.kind != "spike" or fix.channel not in own:
            groups.setdefault((fix.kind, fix.channel), []).append(fix)
    out = []
    for (kind, channel), found in groups.items():
        rows = sum(x.rows for x in found)
        least = FEWEST_OF_FORCE if kind == "spike" and channel in FORCES else FEWEST.get(kind, 1)
        if rows < least:
            continue
        where = f"{channel} column" if channel != "all" else "all columns"
        files = f" in {len(found)} of {len(records)} files" if len(records) > 1 else ""
        parameters = {"count": Parameter(float(rows), "rows", float(rows), float(rows))}
        if kind == "jitter":
            shake = float(np.sqrt(np.mean([x.size**2 for x in found])))
            parameters = {"deviation": deviation(shake, rows, "s")}
        size = found[0].size
        if kind in ("wrap", "signed"):
            parameters["length"] = Parameter(size, "rig units", size, size)
        note = f"{where}{files}: {found[0].note}"
        out.append(of_columns(CALLED[kind], parameters, evidence=CERTAIN, share=0.0, note=note))
    return out
