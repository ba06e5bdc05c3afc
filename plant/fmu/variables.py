"""What an exported axis has: duties, counters, readings, parameters with units, switches of effects."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from operator import attrgetter
from typing import Final, NamedTuple

from plant.effects import REGISTRY
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.parts import AxisModel, EffectModel, PlantModel
from plant.plant import LATE
from plant.units import UNITS, to_si
from plant.world import PATHS, Numbers, declared, numbers_of

REALS: Final = (
    ("current_a", "A", "current of motor A at the PWM's falling edge"),
    ("current_b", "A", "current of motor B at the PWM's falling edge"),
    ("angle", "rad", "true angle of the axis"),
    ("rate", "rad/s", "true rate of the axis"),
    ("torque", "N m", "torque of both gear trains on the axis"),
    ("friction", "N m", "friction torque on the axis"),
)
COUNTERS: Final = (
    ("incremental", at.OUT_INCREMENTAL, "velocity", None),
    ("absolute", at.OUT_ABSOLUTE, "position", "absolute"),
    ("auxiliary", at.OUT_AUXILIARY, "position", "auxiliary"),
    ("tachometer_a", at.OUT_TACH_A, "tachometers", None),
    ("tachometer_b", at.OUT_TACH_B, "tachometers", None),
)
"""Name, reading, the column whose delay it has, the number that says its bits; as plant/axis.py."""
FIRST_REAL, FIRST_COUNTER, FIRST_SWITCH, FIRST_PARAMETER = 10, 20, 50, 1000
"""References, as plant/fmu/wrapper.c has them."""
_STRUCTURAL = ("encoder", "kinematic")
"""Parameters that say where an effect acts: they are chosen when the axis is exported."""


class Parameter(NamedTuple):
    """A number the importer may set: SI units, unit of the plant file; name empty: fixed in the export."""

    name: str
    start: float
    low: float = -1e300
    high: float = 1e300
    unit: str = "1"
    source: str = ""


@dataclass(frozen=True)
class Exported:
    """One axis, ready to be written. enabled: each effect; switchable: its name, empty: acts elsewhere."""

    model: PlantModel
    axis: str
    seed: int
    parameters: tuple[Parameter, ...]
    of_effects: tuple[Mapping[str, int], ...]
    """Where in `parameters` those of each effect are."""
    enabled: tuple[bool, ...]
    switchable: tuple[str, ...]

    @property
    def part(self) -> AxisModel:
        """The axis as its file has it."""
        part: AxisModel = getattr(self.model.axes, self.axis)
        return part


def exported(model: PlantModel, axis: str, seed: int) -> Exported:
    """Return what an axis has, from the model."""
    part: AxisModel = getattr(model.axes, axis)
    bare = replace(part, effects=())
    still = replace(model, axes=replace(model.axes, **{axis: bare}))
    parameters = list(_declared(still, axis, seed))
    places: list[dict[str, int]] = []
    for k, effect in enumerate(part.effects):
        made = list(_of_effect(k, effect))
        places.append({name: len(parameters) + j for j, (name, _) in enumerate(made)})
        parameters += [parameter for _, parameter in made]
    names = tuple(f"effects[{k}].{e.name}.enabled" if _acts(e) else "" for k, e in enumerate(part.effects))
    enabled = tuple(effect.enabled for effect in part.effects)
    return Exported(model, axis, seed, tuple(parameters), tuple(places), enabled, names)


def _declared(model: PlantModel, axis: str, seed: int) -> Iterator[Parameter]:
    """Those of `Numbers`, in its order."""
    given = declared(model, axis)
    for name, start in numbers_of(model, axis, seed, 0.0)._asdict().items():
        if name in PATHS:
            number, path = given[name], PATHS[name].replace("axis", f"axes.{axis}", 1)
            part = attrgetter(path.rpartition(".")[0])(model)
            meta = next(field.metadata for field in fields(part) if field.name == name)
            low, high = (to_si(float(meta[word]), str(meta["unit"])) for word in ("low", "high"))
            yield Parameter(PATHS[name], start, min(low, start), max(high, start), number.unit, number.source)
        else:
            yield Parameter("start_angle" if name == "angle" else "", start, unit="rad")


def _of_effect(k: int, model: EffectModel) -> Iterator[tuple[str, Parameter]]:
    for spec in REGISTRY[model.name].parameters:
        given = model.parameters.get(spec.name)
        unit = spec.unit if given is None else given.unit
        start = to_si(spec.default, unit) if given is None else given.si
        name = f"effects[{k}].{model.name}.{spec.name}"
        shown = _acts(model) and spec.name not in _STRUCTURAL
        low, high = min(to_si(spec.low, spec.unit), start), max(to_si(spec.high, spec.unit), start)
        source = spec.source if given is None else given.source
        yield spec.name, Parameter(name if shown else "", start, low, high, unit, source)


def _acts(model: EffectModel) -> bool:
    """Whether the effect acts in the plant; others act in the host's log."""
    return model.name == LATE or any(t.hook != Hook.LOG for t in REGISTRY[model.name].terms)


def base_unit(unit: str) -> str:
    """Return the unit a number of the FMU has; empty: none."""
    return "" if UNITS[unit][0] == "1" else UNITS[unit][0]


NUMBER_OF: Final = {name: k for k, name in enumerate(Numbers._fields)}
