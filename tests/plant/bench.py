"""Small helpers of the plant's tests: a model without effects, an axis driven for a while, friction
vectors.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from plant import model
from plant.kernels import layout as at
from plant.model import PlantModel
from plant.parts import EffectModel, Number
from plant.plant import Plant

SECOND = 1_000_000_000


def bare(name: str = "low_preload") -> PlantModel:
    """Return a plant model without effects."""
    return model.with_effects(model.with_effects(model.load(name), "ra", ()), "dec", ())


def switching(name: str, drop_v: float = 0.7) -> PlantModel:
    """Return a plant model whose motors have freewheel diodes: its power stage is solved."""
    base = model.load(name)
    drop = Number(drop_v, "V", "ASSUMPTION: a silicon diode")
    axes = {
        axis: replace(part, motor=replace(part.motor, diode_drop=drop))
        for axis in ("ra", "dec")
        for part in [getattr(base.axes, axis)]
    }
    return replace(base, axes=replace(base.axes, **axes))


def with_effect(effect: EffectModel, base: PlantModel | None = None) -> PlantModel:
    """Return a plant model with one effect, on the right ascension axis."""
    return model.with_effects(base or bare(), "ra", (effect,))


def changed(base: PlantModel, **values: float) -> PlantModel:
    """Return the model with RA numbers changed; `gear__stiffness=…` means axes.ra.gear.stiffness."""
    for word, value in values.items():
        base = model.with_value(base, "axes.ra." + word.replace("__", "."), value)
    return base


def truth(plant: Plant, until_s: float, duties: tuple[float, float]) -> NDArray[np.float64]:
    """Drive RA with constant duties and return its truth rows every 10 ms."""
    rows: list[NDArray[np.float64]] = []
    plant.record(lambda axis, part: rows.append(part) if axis == "ra" else None)
    plant.ra.drive(plant.now_ns, *duties)
    plant.advance(plant.now_ns + round(until_s * SECOND))
    plant.record(None)
    return np.concatenate(rows)


def lugre(
    sigma0: float,
    sigma1: float,
    sigma2: float,
    coulomb: float,
    stiction: float,
    rate: float,
    exponent: float = 2.0,
) -> NDArray[np.float64]:
    """Return LuGre parameters as the kernels take them."""
    f = np.zeros(at.FRICTION_SIZE)
    f[at.F_SIGMA0], f[at.F_SIGMA1], f[at.F_SIGMA2] = sigma0, sigma1, sigma2
    f[at.F_COULOMB], f[at.F_STICTION], f[at.F_RATE], f[at.F_EXPONENT] = coulomb, stiction, rate, exponent
    return f
