"""Names that a log may earn, in the order of the plant's effects: one file per name.

A file says where its name can be seen, its columns, bounds and signs, and the experiment that separates it.
It also says what the name is in a plant file.
"""

from importlib import import_module
from pkgutil import iter_modules

from calibration.balances.candidate import Candidate
from calibration.names.name import Name
from calibration.names.scene import Scene
from plant.effects import REGISTRY

_FILES = {m.name for m in iter_modules(__path__)}
_FOUND = (import_module(f"{__name__}.{n}") for n in REGISTRY if n in _FILES)

NAMES: dict[str, Name] = {m.NAME.name: m.NAME for m in _FOUND if hasattr(m, "NAME")}


def offered(scene: Scene) -> list[Candidate]:
    """All names' candidates in a balance; a pair's other values of declared numbers are read off the fit."""
    names = (n for n in NAMES.values() if scene.channel in n.channels)
    return [c for n in names if scene.pair is None or n.changed is None for c in n.columns(scene)]
