"""What counts as declared: the paper's tables, or the plant file the log was made with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from plant.calibration.channels.declared import DECLARED
from plant.calibration.readers.run import Run

SIGMA_0 = 5.9e6  # N m/rad; design.md, the near miss that reaches the paper's rows together
STIFFNESS = {"ra": 3.08e6, "dec": 2.46e6}  # N m/rad per train, paper Table 1
TABLE_1 = (1.0, 0.5)  # readings of that number, per train: it may mean one train, or both side by side
# a log whose note starts with this was made by the emulator: its plant file is what is declared
OWN = "schmidt"


@dataclass(frozen=True)
class Declared:
    """Declared numbers of one axis, SI; `lines` are (name, stage, harmonic) of periodic effects already
    declared."""

    coulomb: float
    stiction: float
    stribeck_speed: float
    viscous: float
    sigma_0: float
    stiffness: float
    lines: tuple[tuple[str, str, int], ...] = ()
    readings: tuple[float, ...] = (1.0,)  # of the stiffness: a plant file says what it means


def declared_numbers(runs: list[Run], plant: Path | None) -> Declared:
    """From `plant`, from the project's plant file for the emulator's own logs, else from the paper's
    tables."""
    axis, preload = runs[0].header["axis"], runs[0].header.get("preload", "low")
    note = runs[0].header.get("note", "").lower()
    own = note.startswith(OWN)
    if plant is None and not own:
        d = DECLARED[preload]
        return Declared(
            d["coulomb"],
            d["stiction"],
            d["stribeck_speed"],
            d["viscous"],
            SIGMA_0,
            STIFFNESS[axis],
            readings=TABLE_1,
        )
    from plant.model import default_files, load

    files = default_files()
    named = [name for name in files if note.endswith(f"plant {name}")]
    model = load(plant if plant is not None else files[named[0] if named else f"{preload}_preload"])
    part = getattr(model.axes, axis)
    f = part.friction
    lines = tuple(
        (e.name, e.stage, e.harmonic)
        for e in part.effects
        if e.enabled and e.stage and e.name in ("gear_eccentricity", "gear_mesh")
    )
    return Declared(
        f.coulomb.si,
        f.stiction.si,
        f.stribeck_rate.si,
        f.viscous.si,
        f.bristle_stiffness.si,
        part.gear.stiffness.si / 2,
        lines,
    )
