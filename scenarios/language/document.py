"""YAML documents that remember where each value stood, so that an error can say file and line."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import yaml

from plant.yamltext import TextError, check_yaml, read_text

Path_ = tuple[str | int, ...]


class ScenarioError(ValueError):
    """Unusable input; the message names file, line, field and what would be right."""


@dataclass(frozen=True)
class Document:
    """A parsed YAML file: its plain data and the line of every value and key (1-based), by path."""

    file: Path
    data: Any
    lines: dict[Path_, int]

    def where(self, path: Path_) -> str:
        """`file:line` of the value at a path, or of the nearest one above it."""
        while path not in self.lines and path:
            path = path[:-1]
        return f"{self.file}:{self.lines.get(path, 1)}"


class _Loader(yaml.SafeLoader):
    """Values that JSON has, too, no others: dates stay text, which the language reads itself. One that cannot
    be made names its line, as `.inf` and `.nan` do, which pass every bound of a schema."""

    yaml_implicit_resolvers = {  # noqa: RUF012 - as PyYAML has it
        first: [each for each in rules if each[0] != "tag:yaml.org,2002:timestamp"]
        for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }
    yaml_constructors = {  # noqa: RUF012
        tag: make
        for tag, make in yaml.SafeLoader.yaml_constructors.items()
        if tag is None or tag.rpartition(":")[2] in ("null", "bool", "int", "float", "str", "seq", "map")
    }

    def __init__(self, text: str, file: Path) -> None:
        super().__init__(text)
        self._file = file

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """A value; raises ScenarioError."""
        line = node.start_mark.line + 1
        try:
            value = super().construct_object(node, deep)
        except ScenarioError:
            raise
        except (ValueError, ArithmeticError, AttributeError, TypeError, LookupError) as error:
            # yaml's constructors take what they find: a !!timestamp that is none has no groups
            raise ScenarioError(f"{self._file}:{line}: not YAML: {_reason(error)}") from None
        if isinstance(value, float) and not isfinite(value):
            raise ScenarioError(f"{self._file}:{line}: {value} is no number to work with")
        return value


def read(file: Path) -> Document:
    """Parse a YAML file; raise `ScenarioError` for a missing file, broken YAML, or a key given twice."""
    try:
        text = read_text(file)
    except FileNotFoundError:
        raise ScenarioError(f"{file}: no such file") from None
    except TextError as error:
        raise ScenarioError(_place(file, error)) from None
    return parse(text, file)


def parse(text: str, file: Path) -> Document:
    """Parse YAML text that came from `file`."""
    try:
        check_yaml(text)
    except TextError as error:
        raise ScenarioError(_place(file, error)) from None
    loader = _Loader(text, file)
    try:
        node = loader.get_single_node()
        if node is None:
            raise ScenarioError(f"{file}:1: the file is empty")
        lines: dict[Path_, int] = {}
        _walk(node, (), lines, file)
        data = loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise ScenarioError(f"{file}:{line}: not YAML: {error.problem}") from None
    except (yaml.YAMLError, ValueError, ArithmeticError, AttributeError, TypeError, LookupError) as error:
        if isinstance(error, ScenarioError):
            raise
        raise ScenarioError(f"{file}:1: not YAML: {_reason(error)}") from None
    finally:
        loader.dispose()
    return Document(file, data, lines)


def _place(file: Path, error: TextError) -> str:
    return f"{file}: {error.what}" if error.line is None else f"{file}:{error.line}: {error.what}"


def _walk(node: yaml.Node, path: Path_, lines: dict[Path_, int], file: Path) -> None:
    lines.setdefault(path, node.start_mark.line + 1)
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            line = key.start_mark.line + 1
            if not isinstance(key, yaml.ScalarNode):
                raise ScenarioError(f"{file}:{line}: a field name must be a word")
            lines[(*path, key.value)] = line
            _walk(value, (*path, key.value), lines, file)
    elif isinstance(node, yaml.SequenceNode):
        for index, value in enumerate(node.value):
            _walk(value, (*path, index), lines, file)


def _reason(error: Exception) -> str:
    return " ".join(str(error).split())
