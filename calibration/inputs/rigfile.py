"""Rig files: read, held against the schema, and against what a schema cannot say."""

import difflib
import json
import re
from functools import cache
from math import isfinite
from pathlib import Path
from typing import Any

import yaml

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig, made
from calibration.inputs.rigchecks import check
from calibration.inputs.thresholds import DEFAULT_HOLD_OUT
from calibration.inputs.train import stages_of
from plant.yamltext import TextError, beside, check_yaml, read_text

DELIMITERS = {"comma": ",", "tab": "\t", "space": " ", "semicolon": ";"}
RIGS = Path(__file__).parent.parent / "rigs"  # rig files that ship with the tool
SCHEMA = Path(__file__).with_name("rig.schema.json")


class _Loader(yaml.SafeLoader):
    """SafeLoader with YAML 1.2's floats: people write 2e-7."""


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$"),
    list("-+0123456789."),
)


def load_rig(path: Path) -> Rig:
    """Load and check a rig file; raises CalibrationInputError with the field and, where known, the line.

    Of several mistakes against the schema the others are its notes.
    """
    from jsonschema import Draft202012Validator
    from jsonschema.validators import extend

    data, text = _read(path)
    if not isinstance(data, dict):
        raise CalibrationInputError(path, "is no rig file: 'rig', 'columns' and 'response' are needed")
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    finite = Draft202012Validator.TYPE_CHECKER.redefine("number", _is_finite)
    checked = extend(Draft202012Validator, type_checker=finite)(schema)  # type: ignore[no-untyped-call]
    errors = [_innermost(e) for e in checked.iter_errors(data)]
    if errors:  # a rule that the schema says in its own words holds for fields that are sound
        errors = [error for error in errors if not _says(error)] or errors
        errors.sort(key=lambda e: [str(p) for p in e.absolute_path])
        first, *others = dict.fromkeys(_complaint(data, text, e, word) for e in errors for word in _words(e))
        more = [str(CalibrationInputError(path, *other)) for other in others]
        raise beside(CalibrationInputError(path, *first), more, str(path))
    return _build(path, data)


@cache
def telescope(axis: str) -> Rig:
    """The declared drive of the telescope's own axis "ra" or "dec"."""
    return load_rig(RIGS / f"schmidt_{axis}.yaml")


def _read(path: Path) -> tuple[Any, str]:
    """The file's content and text; raises CalibrationInputError with the line of a mistake."""
    try:
        text = read_text(path)
        check_yaml(text)
        return yaml.load(text, Loader=_Loader), text  # a SafeLoader: no objects but plain ones
    except OSError as error:
        raise CalibrationInputError(path, f"cannot be read ({error.strerror})") from None
    except TextError as error:
        raise CalibrationInputError(path, error.what, error.line) from None
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else None
        raise CalibrationInputError(path, f"is not YAML: {error.problem}", line) from None


def _is_finite(_: object, value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)


def _innermost(error: Any) -> Any:
    """The mistake in the branch of `oneOf` that fits the kind of value that was given."""
    if error.validator != "oneOf" or not error.context or _says(error):
        return error
    branch = 1 if isinstance(error.instance, list) else 0
    return next((e for e in error.context if e.schema_path[0] == branch), error)


def _says(error: Any) -> str:
    """The schema's own words for a rule, its key `says`."""
    inner = error.validator_value if error.validator == "not" else {}
    return str(inner.get("says") or error.schema.get("says") or "")


def _words(error: Any) -> list[str]:
    """What was written: each field that is not known, or the value."""
    if error.validator == "additionalProperties" and isinstance(error.instance, dict):
        return [key for key in map(str, error.instance) if key not in error.schema.get("properties", {})]
    return [str(error.instance) if not isinstance(error.instance, dict | list) else ""]


def _complaint(data: dict[str, Any], text: str, error: Any, word: str) -> tuple[str, int | None]:
    """One mistake: field, what is wrong, the nearest word that would be right; and its line."""
    names, at = [], data
    for step in error.absolute_path:
        at = at[step]
        name = at.get("name") if isinstance(step, int) and isinstance(at, dict) else None
        names.append(name if isinstance(name, str) else str(step))
    keys = [name for name in names if not name.isdecimal()]  # places of a list are no words of the file
    place = ".".join(names) or "top level"
    message, choices = str(error.message), []
    if error.validator == "additionalProperties" and isinstance(error.instance, dict):
        choices = list(error.schema.get("properties", {}))
        message = f"unknown field '{word}'"
    elif error.validator == "enum":
        choices = [str(v) for v in error.validator_value]
        message = f"'{word}' is not one of {', '.join(choices)}"
    near = difflib.get_close_matches(word, choices, n=1, cutoff=0.5)
    hint = f"; did you mean '{near[0]}'?" if near else ""
    what = f"{place}: {message}{hint}"
    if says := _says(error):
        quoted = [*str(error.message).split("'"), "", "", ""]  # 'a' is a dependency of 'b', 'a' is required
        what = says.format_map({**data, "place": place, "it": word, "missing": quoted[1], "of": quoted[3]})
    keys += [word] if choices and (not keys or error.validator == "additionalProperties") else []
    return what, _line(text, keys)


def _line(text: str, keys: list[str]) -> int | None:
    """The line of a field: that of its key, behind those of the keys it stands under."""
    rows, at = text.splitlines(), 0
    for key in keys:
        at = next((k for k in range(at, len(rows)) if key in rows[k]), at)
    return at + 1 if keys else None


def _build(path: Path, data: dict[str, Any]) -> Rig:
    given = data.get("response", [])
    rig = made(
        Rig,
        {"columns": {}, **data, "responses": given if isinstance(given, list) else [given]},
        name=data["rig"],
        path=path,
        stages=tuple(stages_of(path, data.get("stages", []))),
        constants={k: float(v["value"]) for k, v in data.get("constants", {}).items()},
        delimiter=DELIMITERS.get(data.get("delimiter", "")),
        hold_out=data.get("hold_out_fraction", DEFAULT_HOLD_OUT),
    )
    check(rig, data)
    return rig
