"""YAML as people write it: 2e-7 is a number, and a key that stands twice is a mistake."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from calibration.errors import CalibrationInputError
from plant.yamltext import TextError, check_yaml, read_text


class _Loader(yaml.SafeLoader):
    """SafeLoader with YAML 1.2's floats."""


# SafeLoader keeps its resolvers by first letter in a table of the class: a copy, so that others stay as they
# are
_Loader.yaml_implicit_resolvers = {k: list(v) for k, v in yaml.SafeLoader.yaml_implicit_resolvers.items()}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$"),
    list("-+0123456789."),
)


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    seen: dict[Any, int] = {}
    for key, _ in node.value:
        word = loader.construct_object(key)
        if not isinstance(word, str | int | float):
            continue
        if word in seen:
            raise yaml.constructor.ConstructorError(
                None, None, f"'{word}' is given twice (first in line {seen[word]})", key.start_mark
            )
        seen[word] = key.start_mark.line + 1
    return dict(loader.construct_mapping(node, deep=True))


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)


def load_yaml(path: Path) -> tuple[Any, str]:
    """The file's content and text; raises CalibrationInputError with the line of a mistake."""
    try:
        text = read_text(path)
        check_yaml(text)
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    except TextError as error:
        raise CalibrationInputError(path, error.what, error.line) from None
    try:
        return yaml.load(text, Loader=_Loader), text  # a SafeLoader: no objects but plain ones
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        raise CalibrationInputError(
            path, f"is not YAML: {error.problem}", mark.line + 1 if mark else None
        ) from None
    except yaml.YAMLError as error:
        raise CalibrationInputError(path, f"is not YAML: {' '.join(str(error).split())}") from None
