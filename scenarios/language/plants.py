"""The plant a scenario asks for: file, effects switched on by name, single numbers overridden."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from plant.yamltext import nearest
from scenarios.language.document import ScenarioError

if TYPE_CHECKING:
    from plant.model import PlantModel
    from plant.parts import EffectModel


def named(given: Any) -> dict[str, Any]:
    """A `plant` of a document as a block, when it is only a name."""
    return {"file": given} if isinstance(given, str) else given


def plant_model(given: dict[str, Any], beside: Path) -> PlantModel:
    """Load and change a plant; `beside` is the folder that relative file names are also looked for in."""
    from plant import model as plants

    try:
        model = plants.load(_source(str(given["file"]), beside))
        for axis in ("ra", "dec"):
            blocks = [{"name": e} if isinstance(e, str) else e for e in given.get("effects", [])]
            extra = [_effect(each) for each in blocks if each.get("axis", axis) == axis]
            if extra:
                model = plants.with_effects(model, axis, (*getattr(model.axes, axis).effects, *extra))
        model = plants.with_mount_errors(model, given.get("mount", True))
        for path, value in given.get("overrides", {}).items():
            try:
                number = float(value)
            except ValueError:
                raise ScenarioError(f"plant: overrides: {path}: {value!r} is no number") from None
            model = plants.with_value(model, path, number, "scenario override")
        if given.get("overrides"):
            model = plants.loads(plants.dumps(model), "with its overrides")  # the bounds hold for them, too
            _check_friction(model)
    except ScenarioError:
        raise
    except (ValueError, TypeError, KeyError, ArithmeticError) as error:
        raise ScenarioError(f"plant: {' '.join(str(error).split())}") from None
    return model


def _check_friction(model: PlantModel) -> None:
    """Raise ScenarioError when an axis takes less to break away than to slide."""
    for axis in ("ra", "dec"):
        friction = getattr(model.axes, axis).friction
        low, high = friction.coulomb, friction.stiction
        if high.si < low.si:
            raise ScenarioError(
                f"plant: overrides: axes.{axis}.friction.stiction {high.value:g} {high.unit} is below "
                f"coulomb, {low.value:g} {low.unit}"
            )


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


def _effect(given: dict[str, Any]) -> EffectModel:
    """One effect, checked as a plant file's is; numbers without a unit are in the effect's own."""
    import yaml

    from plant.effects import REGISTRY
    from plant.reading import ModelError, Reader

    class Here(Reader):
        def fail(self, _node: yaml.Node, path: str, what: str) -> ModelError:
            return ModelError(f"{path}: {what}")  # there is no file whose line could be named

    spec = REGISTRY.get(given["name"])
    units = {} if spec is None else {each.name: each.unit for each in spec.parameters}
    block: dict[str, Any] = {word: given[word] for word in ("name", "stage", "harmonic") if word in given}
    for word, value in given.get("parameters", {}).items():
        number = value if isinstance(value, dict) else {"value": value}
        whole = {"unit": units.get(word, "1"), "source": "scenario", **number}
        block.setdefault("parameters", {})[word] = whole
    node = yaml.compose(yaml.safe_dump(block))
    assert node is not None
    return Here("plant").effect(node, f"effect {given['name']}")
