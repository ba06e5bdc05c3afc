"""The effects a drive shows and the declared model lacks: one file each in this folder."""

from importlib import import_module
from pkgutil import iter_modules

from plant.effects.base import Effect

_FILES = {m.name: import_module(f"{__name__}.{m.name}") for m in iter_modules(__path__)}
#: effects by name: every file of this folder that declares one, in the catalogue's order
REGISTRY: dict[str, Effect] = dict(
    sorted(
        ((name, file.EFFECT) for name, file in _FILES.items() if hasattr(file, "EFFECT")),
        key=lambda pair: pair[1].catalogue_row,
    )
)
