"""Parameters that a report may print: the plant's, and those that the page on reports lists."""

import re
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

from calibration.names import NAMES
from calibration.names.inplant import IN_RUN
from plant.effects import REGISTRY

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "calibration-report.md"


@cache
def listed() -> dict[str, set[str]]:
    """Patterns of parameters by effect, of the page's table."""
    out: dict[str, set[str]] = {name: set() for name in NAMES}
    table = PAGE.read_text(encoding="utf-8").partition("\n## Parameters\n")[2].partition("\n## ")[0]
    for names, parameters in re.findall(r"^\| (`[^|]*) \| (`[^|]*) \|", table, re.MULTILINE):
        for name in re.findall(r"`([^`]+)`", names):
            out[name] |= set(re.findall(r"`([^`]+)`", parameters))
    return out


def knows(name: str, parameter: str) -> bool:
    """Whether a report may print it: the plant's effect or file has it, or the page says what it is.

    A harmonic ends in its number. A time from the start of every run ends in IN_RUN.
    """
    known, changed = parameter.removesuffix(IN_RUN), NAMES[name].changed
    plants = {p.name for p in REGISTRY[name].parameters}
    written = set(changed.numbers.values()) if changed is not None else set()
    plain = known.rstrip("0123456789").removesuffix("_")
    return plain in plants | written or any(fnmatch(known, pattern) for pattern in listed()[name])
