"""Plant files: load, write, look up and override numbers.

A plant file is YAML; every number is {value, unit, source}. Errors name file, line, field and the nearest
valid word.
"""

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import yaml

from plant.effects import REGISTRY
from plant.parts import EffectModel, MountErrors, Number
from plant.parts import PlantModel as PlantModel
from plant.reading import ModelError as ModelError
from plant.reading import Reader
from plant.yamltext import TextError, check_yaml, nearest, read_text

FILES = Path(__file__).parent / "files"
DEFAULT = "low_preload_bridge"
FORMAT = "schmidt-plant 1"


def default_files() -> dict[str, Path]:
    """Return the plant files that come with the project, by name."""
    return {path.stem: path for path in sorted(FILES.glob("*.yaml"))}


def load(source: str | Path = DEFAULT) -> PlantModel:
    """Return the model in a file; a bare name (`low_preload`) means one of the project's own files."""
    path = Path(source)
    own = default_files()
    if str(source) in own and not path.exists():
        path = own[str(source)]
    try:
        text = read_text(path)
    except (FileNotFoundError, TextError) as error:
        reason = "no such plant file" if isinstance(error, OSError) else str(error)
        hint = "" if path.suffix else "; " + nearest(str(source), list(own))
        raise ModelError(f"{source}: {reason}{hint}") from None
    return loads(text, str(source))


def loads(text: str, name: str = "plant file") -> PlantModel:
    """Return the model in a YAML text; `name` is what errors call it."""
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        check_yaml(text)
        node = yaml.compose(text, Loader=loader)
    except TextError as error:
        raise ModelError(f"{name}, line {error.line}: {error.what}") from None
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise ModelError(f"{name}, line {line}: not YAML: {error.problem}") from None
    reader = Reader(name)
    if node is None:
        raise ModelError(f"{name}: is empty")
    top = reader.mapping(node, "")
    if "format" not in top or reader.scalar(top["format"][1], "format") != FORMAT:
        raise reader.fail(node, "format", f"expected 'format: {FORMAT}'")
    body = yaml.MappingNode(node.tag, [kv for kv in node.value if kv[0].value != "format"], node.start_mark)
    model: PlantModel = reader.part(body, "", PlantModel)
    return model


def _plain(part: Any) -> Any:
    if isinstance(part, Number):
        return {"value": part.value, "unit": part.unit, "source": part.source}
    if isinstance(part, EffectModel):
        effect: dict[str, Any] = {"name": part.name}
        if part.stage is not None:
            effect |= {"stage": part.stage, "harmonic": part.harmonic}
        if not part.enabled:
            effect["enabled"] = False
        if part.parameters:
            effect["parameters"] = {k: _plain(v) for k, v in part.parameters.items()}
        if part.function is not None:
            function = _plain(part.function)
            effect["function"] = {name: each for name, each in function.items() if name != "motor" or each}
        return effect
    if isinstance(part, tuple):
        return [_plain(child) for child in part]
    if dataclasses.is_dataclass(part):
        given = {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}
        return {name: _plain(value) for name, value in given.items() if value is not None}
    return part


def dumps(model: PlantModel) -> str:
    """Return the model as YAML text; `loads` gives the same model back."""
    text: str = yaml.safe_dump(
        {"format": FORMAT, **_plain(model)}, sort_keys=False, allow_unicode=True, width=110
    )
    return text


def dump(model: PlantModel, path: str | Path) -> None:
    """Write the model to a file."""
    Path(path).write_text(dumps(model), encoding="utf-8")


def _inside(part: Any) -> dict[str, Any]:
    """Return the children of a part by the words of a path."""
    if isinstance(part, EffectModel):
        return dict(part.parameters)
    if isinstance(part, tuple):
        return {str(k): child for k, child in enumerate(part)}
    fields = dataclasses.fields(part) if dataclasses.is_dataclass(part) else ()
    return {field.name: getattr(part, field.name) for field in fields}


def numbers(model: PlantModel) -> dict[str, Number]:
    """Return every number by path, such as `axes.ra.friction.coulomb` or `axes.ra.effects.0.amplitude`."""
    return dict(_walk(model, ""))


def _walk(part: Any, path: str) -> Iterator[tuple[str, Number]]:
    for word, child in _inside(part).items():
        here = f"{path}.{word}".lstrip(".")
        if isinstance(child, Number):
            yield here, child
        else:
            yield from _walk(child, here)


def get(model: PlantModel, path: str) -> Number:
    """Return the number at a path; ModelError names the nearest path."""
    found = numbers(model)
    if path not in found:
        raise ModelError(f"plant model: no number at '{path}'; " + nearest(path, list(found)))
    return found[path]


def with_value(model: PlantModel, path: str, value: float, source: str | None = None) -> PlantModel:
    """Return the model with another value (in the number's own unit) at a path.

    An effect's parameter that the model leaves at its default may be given too, as `axes.ra.effects.0.phase`,
    in the effect's own unit.
    """
    changed: PlantModel = _replaced(model, path.split("."), path, value, source)
    return changed


def _replaced(part: Any, words: list[str], path: str, value: float, source: str | None) -> Any:
    if not words and isinstance(part, Number):
        return Number(float(value), part.unit, part.source if source is None else source)
    word, inside = (words or [""])[0], _inside(part)
    if isinstance(part, EffectModel):
        specs = {p.name: Number(p.default, p.unit, p.source) for p in REGISTRY[part.name].parameters}
        inside = {**specs, **inside}
    if word not in inside or isinstance(part, Number):
        raise ModelError(f"plant model: no number at '{path}'")
    child = _replaced(inside[word], words[1:], path, value, source)
    if isinstance(part, EffectModel):
        return dataclasses.replace(part, parameters={**part.parameters, word: child})
    if isinstance(part, tuple):
        return tuple((inside | {word: child}).values())
    return dataclasses.replace(part, **{word: child})


def with_effects(model: PlantModel, axis: str, effects: Sequence[EffectModel]) -> PlantModel:
    """Return the model with this list of effects on `axis` (`ra` or `dec`)."""
    part = dataclasses.replace(getattr(model.axes, axis), effects=tuple(effects))
    return dataclasses.replace(model, axes=dataclasses.replace(model.axes, **{axis: part}))


def with_mount_errors(model: PlantModel, wanted: bool = True) -> PlantModel:
    """Return the model with errors of its mount, typical ones where its file declares none.

    wanted: False for a mount without errors, whatever the file declares.
    """
    if not wanted:
        return dataclasses.replace(model, mount=None)
    return model if model.mount is not None else dataclasses.replace(model, mount=MountErrors())
