"""The plant a scenario asks for: file, effects switched on by name, single numbers overridden."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenarios.document import ScenarioError
from scenarios.validate import nearest

if TYPE_CHECKING:
    from plant.model import EffectModel, PlantModel


def plant_model(given: dict[str, Any], beside: Path) -> PlantModel:
    """Load and change a plant; `beside` is the folder that relative file names are also looked for in."""
    from plant import model as plants

    try:
        model = plants.load(_source(str(given["file"]), beside))
        for axis in ("ra", "dec"):
            extra = [_effect(each) for each in given.get("effects", []) if _on(each, axis)]
            if extra:
                model = plants.with_effects(model, axis, (*getattr(model.axes, axis).effects, *extra))
        for path, value in given.get("overrides", {}).items():
            model = plants.with_value(model, path, float(value), "scenario override")
        if given.get("overrides"):
            model = plants.loads(plants.dumps(model), "with its overrides")  # the bounds hold for them, too
    except ScenarioError:
        raise
    except (ValueError, TypeError, KeyError, ArithmeticError) as error:
        raise ScenarioError(f"plant: {' '.join(str(error).split())}") from None
    return model


def _source(name: str, beside: Path) -> str | Path:
    from plant.model import default_files

    own = default_files()
    bare = name.replace("-", "_")
    if bare in own:
        return bare
    for path in (Path(name), beside / name):
        if path.is_file():
            return path
    if Path(name).suffix:
        raise ScenarioError(f"plant: {name}: no such file")
    raise ScenarioError(f"plant: {name!r} is not known; {nearest(bare, own)}")


def _on(given: Any, axis: str) -> bool:
    return isinstance(given, str) or given.get("axis", axis) == axis


def _effect(given: Any) -> EffectModel:
    from plant.effects import REGISTRY
    from plant.model import EffectModel, Number

    given = {"name": given} if isinstance(given, str) else given
    name = given["name"]
    if name not in REGISTRY or name == "unknown":
        raise ScenarioError(f"plant: effect {name!r} is not known; {nearest(name, REGISTRY)}")
    spec = REGISTRY[name]
    stage = given.get("stage")
    if spec.staged and stage not in spec.stages:
        raise ScenarioError(f"plant: effect {name} needs a stage; {nearest(str(stage), spec.stages)}")
    known = [parameter.name for parameter in spec.parameters]
    parameters = {}
    for word, value in given.get("parameters", {}).items():
        if word not in known:
            raise ScenarioError(f"plant: effect {name}: no parameter {word!r}; {nearest(word, known)}")
        unit = spec.parameter(word).unit
        if isinstance(value, dict):
            parameters[word] = Number(float(value["value"]), str(value.get("unit", unit)), "scenario")
        else:
            parameters[word] = Number(float(value), unit, "scenario")
        _check_bounds(spec, word, parameters[word].value, unit)
    return EffectModel(name, stage if spec.staged else None, int(given.get("harmonic", 1)), parameters)


def _check_bounds(spec: Any, word: str, value: float, unit: str) -> None:
    bounds = spec.parameter(word)
    if not bounds.low <= value <= bounds.high:
        raise ScenarioError(
            f"plant: effect {spec.name}: {word} = {value:g} is outside {bounds.low:g}..{bounds.high:g} {unit}"
        )
