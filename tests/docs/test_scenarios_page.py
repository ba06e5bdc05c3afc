"""The scenario language's pages against the published schema, the unit table and the loader."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.plants import plant_model
from scenarios.language.units import QUANTITIES
from scenarios.language.validate import schema

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "reference" / "scenarios.md").read_text(encoding="utf-8")
FAULTS = (ROOT / "docs" / "reference" / "faults.md").read_text(encoding="utf-8")
FIELDS = (ROOT / "docs" / "reference" / "scenario-fields.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


def words(rule: Any) -> set[str]:
    """Every field name and every allowed word below a rule of the schema."""
    found: set[str] = set()
    if isinstance(rule, dict):
        for key, value in rule.items():
            if key == "properties":
                found |= set(value)
            if key == "enum":
                found |= {str(word) for word in value}
            if key != "examples":
                found |= words(value)
    elif isinstance(rule, list):
        for each in rule:
            found |= words(each)
    return found


def code() -> set[str]:
    """What stands in back quotes or in an example on the page, cut into words."""
    spans = re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", PAGE + FIELDS + FAULTS, flags=re.DOTALL))
    found = {word for span in spans for word in re.findall(r"[\w.+-]+", span)}
    found |= {part for word in found for part in word.split(".")}  # `focus.to` has a row of its own
    return found | {word for example in EXAMPLES for word in re.findall(r"[\w.+-]+", example)}


def test_every_word_of_the_schema_is_on_the_page() -> None:
    known = code()
    sensors = {f"{part}.{name}" for part in ("ra", "dec") for name in known} | known  # "ra. or dec. with …"
    missing = sorted(word for word in words(schema()) if word not in sensors)
    assert not missing, f"no page of the language mentions {', '.join(missing)}"


@pytest.mark.parametrize(
    ("part", "page"),
    [
        ("step", FIELDS.split("\n## step\n")[1].split("\n## ")[0]),
        ("fault", FAULTS),
        ("expectation", PAGE.split("\n## Expectations\n")[1].split("\n## ")[0]),
    ],
    ids=["step", "fault", "expectation"],
)
def test_every_action_fault_and_expectation_has_a_row(part: str, page: str) -> None:
    rows = set(re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE))
    names = set(schema()["$defs"][part]["properties"]) - {"name"}
    assert names - rows <= {"at", "until", "may_not_act"} if part == "fault" else names <= rows, names - rows


def test_every_field_has_a_meaning() -> None:
    """In its own row, or in the section that its kind links to."""
    rows = re.findall(r"^\| (`[^|]+`) \| ([^|]+) \|(.*)\|$", FIELDS, re.MULTILINE)
    silent = [name for name, kind, text in rows if text.strip() in ("", "required") and "](#" not in kind]
    assert len(rows) > 80
    assert not silent, f"no description in scenario.schema.json: {', '.join(silent)}"


def test_every_unit_is_on_the_page() -> None:
    section = PAGE.split("\n## Values and units\n")[1].split("\n## ")[0]
    missing = [unit for each in QUANTITIES.values() for unit in each.units if f"`{unit}`" not in section]
    assert not missing


def test_every_example_loads() -> None:
    assert len(EXAMPLES) >= 3
    whole = yaml.safe_load(EXAMPLES[0])
    for example in EXAMPLES:
        text = yaml.safe_dump(whole | yaml.safe_load(example), allow_unicode=True, sort_keys=False)
        scenario = convert(parse(text, Path("docs/reference/scenarios.md")))
        assert scenario.steps
        plant_model(scenario.plant, ROOT)


def test_the_schema_line_of_the_examples_names_the_schema() -> None:
    named = {path.read_text(encoding="utf-8").splitlines()[0] for path in (ROOT / "scenarios").glob("*.yaml")}
    assert named == {EXAMPLES[0].splitlines()[0]}
    assert (ROOT / "scenarios" / EXAMPLES[0].splitlines()[0].partition("$schema=")[2]).exists()
