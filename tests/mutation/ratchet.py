"""What has been reached: shares killed by module, which may only rise, and survivors that have a reason."""

from pathlib import Path

import yaml

FLOOR = Path(__file__).with_name("floor.yaml")
REASONS = Path(__file__).with_name("survivors.yaml")


def key(path: str, label: str) -> str:
    """A survivor without its line, which moves."""
    return f"{path}: {label.partition(': ')[2]}"


def reasons() -> dict[str, str]:
    """Why each survivor that is known may live, by its key."""
    found: dict[str, str] = yaml.safe_load(REASONS.read_text(encoding="utf-8")) or {}
    return found


def floors() -> dict[str, float]:
    """Shares killed, per cent, by module."""
    found: dict[str, float] = yaml.safe_load(FLOOR.read_text(encoding="utf-8")) or {}
    return found


def fallen(measured: dict[str, float]) -> list[str]:
    """Modules that are below their floor, in words."""
    least = floors()
    pairs = ((path, share, least.get(path, 0.0)) for path, share in measured.items())
    return [f"{path}: {share:.1f} % killed, was {floor:g} %" for path, share, floor in pairs if share < floor]


def tighten(measured: dict[str, float]) -> None:
    """Raise the floors to what was measured."""
    least = floors()
    for path, share in measured.items():
        least[path] = max(least.get(path, 0.0), int(share * 10) / 10)
    head = "".join(f"{line}\n" for line in FLOOR.read_text(encoding="utf-8").splitlines() if line[:1] == "#")
    FLOOR.write_text(head + yaml.safe_dump(least), encoding="utf-8")
