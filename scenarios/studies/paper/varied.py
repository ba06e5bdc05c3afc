"""The rows with one number of the drive off, at both preloads: which of them stand."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

from plant.model import get, with_value
from plant.parts import PlantModel
from scenarios.studies.paper.rows import Row
from scenarios.studies.paper.starts import with_inertia

Plants = Mapping[str, PlantModel]
Change = Callable[[PlantModel, float], PlantModel]


def _number(path: str) -> Change:
    """Multiplies one number of the RA axis; the declination's plays no part in any row."""
    where = f"axes.ra.{path}"
    return lambda model, factor: with_value(model, where, get(model, where).value * factor)


NUMBERS: Final[Mapping[str, Change]] = {
    "J": with_inertia,
    "K": _number("motor.torque_constant"),
    "R": _number("motor.resistance"),
    "Tc": _number("friction.coulomb"),
    "Ts": _number("friction.stiction"),
}
"""Inertia with the rotors', torque constant and EMF, winding, Coulomb friction, stiction."""


def variations(plants: Plants, percent: float) -> dict[str, Plants]:
    """Return plants by what is off, each number once below and once above what is declared."""
    return {
        f"{name} {sign}{percent:g} %": {
            preload: change(model, 1.0 + float(f"{sign}{percent}") / 100.0)
            for preload, model in plants.items()
        }
        for name, change in NUMBERS.items()
        for sign in "-+"
    }


_HEAD = Path(__file__).with_name("varied.md").read_text("utf-8")


def markdown(found: Mapping[str, Sequence[Row]], command: str, percent: float) -> str:
    """Return what stands and what falls as a section of a page: a table, and by how much a row falls that
    stands elsewhere."""
    starts = min(row.starts for rows in found.values() for row in rows)
    head = _HEAD.format(command=command, percent=percent, starts=starts)
    lines = [head, "| row | " + " | ".join(found) + " |", "|---|" + "---|" * len(found)]
    falls = ["", "| off | row | missed by most (limit) | worst |", "|---|---|---|---|"]
    for rows in zip(*found.values(), strict=True):
        cells = ("·" if row.passed else "**miss**" for row in rows)
        lines.append(f"| {rows[0].id} | " + " | ".join(cells) + " |")
        for name, row in zip(found, rows, strict=True):
            if not row.passed and any(other.passed for other in rows):
                falls.append(f"| {name} | {row.id} | {row.decided} |")
    return "\n".join(lines + falls) + "\n"
