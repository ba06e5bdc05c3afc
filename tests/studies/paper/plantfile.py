"""Plant files as people keep them: one number a line."""

from pathlib import Path
from typing import Any

import yaml

from plant.model import dumps, loads
from plant.parts import PlantModel


class _Line(dict[str, Any]):
    """A mapping that is written on one line."""


class _Dumper(yaml.SafeDumper):
    """Writes `_Line` in flow style."""


_Dumper.add_representer(
    _Line, lambda dumper, data: dumper.represent_mapping("tag:yaml.org,2002:map", data, flow_style=True)
)


def _lines(part: Any) -> Any:
    if isinstance(part, dict):
        if set(part) == {"value", "unit", "source"}:
            return _Line(part)
        return {key: _lines(value) for key, value in part.items()}
    if isinstance(part, list):
        return [_lines(value) for value in part]
    return part


def write(model: PlantModel, path: Path) -> None:
    """Write a plant file; raises ValueError when it would not read back as the same model."""
    plain = yaml.safe_load(dumps(model))
    text: str = yaml.dump(_lines(plain), Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=1000)
    if loads(text, str(path)) != model:
        raise ValueError(f"{path}: does not read back as the model it was written from")
    path.write_text(f"# {model.description}\n# Every number: value, unit, source.\n{text}", encoding="utf-8")
