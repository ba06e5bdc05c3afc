"""The gear table of a rig: tooth counts to periods."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Stage

HARMONICS = 2  # looked for unless the stage says otherwise


def stages_of(path: Path, items: list[dict[str, Any]]) -> list[Stage]:
    """Resolve tooth counts to periods: a stage with `of` turns teeth[0]/teeth[1] as fast as the one named."""
    known: dict[str, Stage] = {}
    for item in items:
        name = item["name"]
        if name in known:
            raise CalibrationInputError(path, f"stages: '{name}' is given twice")
        period, period_s = item.get("period"), item.get("period_s")
        if "of" in item and "teeth" not in item:
            raise CalibrationInputError(path, f"stages.{name}: 'of' needs 'teeth'")
        if "teeth" in item:
            if period is not None or period_s is not None:
                raise CalibrationInputError(path, f"stages.{name}: give a period or teeth, not both")
            other = known.get(item.get("of", ""))
            if other is None:
                raise CalibrationInputError(path, f"stages.{name}: 'of' must name a stage given before it")
            factor = item["teeth"][1] / item["teeth"][0]
            period = other.period * factor if other.period else None
            period_s = other.period_s * factor if other.period_s else None
        if period is None and period_s is None:
            raise CalibrationInputError(
                path, f"stages.{name}: give 'period', 'period_s', or 'teeth' with 'of'"
            )
        known[name] = Stage(name, period, period_s, item.get("harmonics", HARMONICS), item.get("kind"))
    return list(known.values())
