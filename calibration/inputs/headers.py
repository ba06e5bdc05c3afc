"""What a column's name says: its channel, its unit, the factor to it."""

import re
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import yaml

_UNIT = re.compile(r"\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_PART = re.compile(r"[^\W\d_]+")
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])")

# letters of a name that is a unit by itself: longer than m, s, in. ASSUMPTION
SHORT = 2


class Said(NamedTuple):
    """Channel ("" where the name says none), its unit and the factor to it; `asked`: not measured;
    `angle`: of something that turns."""

    channel: str = ""
    unit: str = ""
    scale: float = 1.0
    asked: bool = False
    angle: bool = False


@cache
def _table() -> dict[str, dict[str, Any]]:
    return dict(yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8")))


def said(name: str) -> Said:
    """What a header says: "Position [mm]", "torque_Nm", "goalPos (deg)"."""
    words, units = _table()["words"], _table()["units"]
    bracket = _UNIT.search(name)
    inside = "" if not bracket or bracket[1][:1].isdigit() or bracket[1].startswith(":") else bracket[1]
    parts = [p.lower() for p in _PART.findall(_HUMP.sub("_", _UNIT.sub("", name)))]
    ends = [p.lower() for p in _PART.findall(name)]
    last = ends[-1] if ends and (len(ends) > 1 or len(ends[0]) > SHORT) else ""
    last = "" if last in words["asked"] else last
    hint, unit, scale = units.get(inside.lower() or last, ("", inside, 1.0))
    told = [channel for channel, known in words.items() if set(parts) & set(known)]
    told = [channel for channel in told if channel not in ("count", "label") or len(parts) == 1]
    channel = next((c for c in told if c not in ("asked", "angle")), "")
    alike = {hint, channel} <= {"current", "force", "effort", "normal"}
    channel = channel if not hint or alike else hint
    return Said(channel, unit, float(scale), "asked" in told, "angle" in told)
