"""What earlier benches on this machine found, and whether a figure got worse by more than the noise."""

import json
import platform
import statistics
from collections.abc import Collection
from pathlib import Path
from typing import Any

_ENOUGH = 3
"""Earlier benches before a fall can be told from noise."""
_SIGMAS = 3.0
_MAD = 1.4826
"""Median absolute deviation to standard deviation of a normal distribution."""
_LEAST = 0.03
"""Share below which nothing is called a change."""


def machine() -> str:
    """What must be the same for figures to be compared."""
    return f"{platform.node()} {platform.machine()} Python {platform.python_version()}"


def read(path: Path) -> list[dict[str, float]]:
    """Figures of earlier benches on this machine."""
    if not path.exists():
        return []
    lines = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.strip())
    return [each["figures"] for each in lines if each["machine"] == machine()]


def add(path: Path, figures: dict[str, float], more: dict[str, Any]) -> None:
    """Append a bench."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"machine": machine(), "figures": figures, **more}) + "\n")


def falls(before: list[dict[str, float]], now: dict[str, float], costs: Collection[str] = ()) -> list[str]:
    """One line for every figure worse than the median of earlier benches by more than three deviations.

    Worse is smaller, but for those in `costs`, where it is larger.
    """
    found = []
    for name, value in now.items():
        values = [each[name] for each in before if name in each]
        if len(values) < _ENOUGH:
            continue
        middle = statistics.median(values)
        noise = _MAD * statistics.median(abs(each - middle) for each in values)
        worse = value - middle if name in costs else middle - value
        if worse > max(_SIGMAS * noise, _LEAST * middle):
            moved = "rose" if name in costs else "fell"
            found.append(
                f"{name} {moved} from {middle:.3g} ± {noise:.2g} ({len(values)} benches) to {value:.3g}"
            )
    return found
