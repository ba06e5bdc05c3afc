"""The scenario language: every mistake gets one line with file, line, field and the nearest valid word."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
import yaml
from hypothesis import assume, given
from hypothesis import strategies as st

from scenarios.language.document import ScenarioError, parse
from scenarios.language.load import convert
from scenarios.language.model import Scenario
from scenarios.language.units import QUANTITIES, UnitError
from scenarios.language.units import parse as parse_value
from scenarios.language.validate import SCHEMA_FILE, schema
from tests.scenarios.conftest import Command

FOLDER = Path(__file__).parents[3] / "scenarios"
GOOD = """\
name: test
start_utc: 2026-02-10T14:00:00Z
steps:
  - name: up
    power_on: {}
  - goto: {target: Pollux}
  - name: hold
    track: {for: 10 s}
faults:
  - node_off: {node: DISPLAY}
    at: 5 s
expect:
  - pointing_error: {during: hold, at_most: 10 arcsec}
"""


def load_text(text: str) -> Scenario:
    return convert(parse(text, Path("night.yaml")))


def message(text: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        load_text(text)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_good_scenario_arrives_in_base_units() -> None:
    scenario = load_text(GOOD)
    assert [step.action for step in scenario.steps] == ["power_on", "goto", "track"]
    assert scenario.steps[2].arguments == {"for": 10.0}
    assert scenario.faults[0].at_s == 5.0
    assert (scenario.expectations[0].limit, scenario.expectations[0].upper) == (10.0, True)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("track:", "trak:", 7, ["'trak'", "'track'"]),
        ("{target: Pollux}", "{targt: Pollux}", 6, ["'targt'", "'target'"]),
        ("node_off", "node_of", 10, ["'node_of'", "'node_off'"]),
        ("DISPLAY", "DISPLY", 10, ["'DISPLY'", "'DISPLAY'"]),
        ("10 s}", "10 sec}", 8, ["'10 sec'", "ms, s, min, h"]),
        ("10 s}", "10}", 8, ["no unit", "'10 s'"]),
        ("10 arcsec", "10 arcsec/s", 13, ["arcsec/s", "does not fit"]),
        ("at_most: 10 arcsec", "at_most: -1 arcsec", 13, ["no figure is below zero", "0 or more"]),
        ("during: hold", "during: hald", 13, ["'hald'", "'hold'"]),
        ("start_utc: 2026-02-10T14:00:00Z", "start_utc: yesterday", 2, ["start_utc", "'yesterday'"]),
        ("start_utc: 2026-02-10T14:00:00Z", "start_utc: 2026-02-10T14:00:00", 2, ["time zone"]),
        ("name: test\n", "name: test\nseed: one\n", 2, ["seed", "whole number", "'one'"]),
        ("name: test\n", "name: test\nseed: -1\n", 2, ["seed", "at least 0"]),
        ("name: test\n", "name: test\nname: again\n", 2, ["'name'", "twice"]),
        ("at: 5 s", "at: 5 s\n    until: 4 s", 10, ["ends", "before it starts"]),
        ("    power_on: {}", "    power_on: {}\n    park: {}", 4, ["power_on and park"]),
        ("    power_on: {}", "    at: 3 s", 4, ["nothing to do", "power_on"]),
        ("name: test\n", "", 1, ["'name'", "missing"]),
        ("10 s}", "-10 s}", 8, ["track.for: -10 s is out of range; 0..1e+07 s"]),
        ("at: 5 s", "at: -5 min", 10, ["at: -5 min is out of range; 0..166667 min"]),
        ("name: test\n", "name: test\nsite: {temperature: -500 degC}\n", 2, ["-90..60 degC"]),
        ("name: test\n", "name: test\nsite: {pressure: -5 hPa}\n", 2, ["0..1100 hPa"]),
        ("name: test\n", "name: test\nsite: {horizon: 95 deg}\n", 2, ["0..89 deg"]),
        ("start_utc: 2026-02-10", "start_utc: 2026-13-10", 2, ["start_utc", "'2026-13-10T14:00:00Z'"]),
        ("start_utc: 2026-02-10T14:00:00Z", "start_utc: !!timestamp 2026-13-10", 2, ["timestamp"]),
        ("name: test\n", "name: test\nplant: {file: x, overrides: {a: {value: 3}}}\n", 2,
         ["plant.overrides.a: expected a number or text, found a block of fields"]),
        ("name: test\n", "name: test\nplant: {file: x, effects: [" + "play, " * 3000 + "]}\n", 2,
         ["plant.effects: 3000 entries; at most 100"]),
        ("steps:", "steps: [", 3, ["not YAML"]),
    ],
)  # fmt: skip
def test_mistakes_name_line_field_and_nearest_word(old: str, new: str, line: int, words: list[str]) -> None:
    assert old in GOOD
    text = message(GOOD.replace(old, new, 1))
    found = re.match(r"night\.yaml:(\d+): ", text)
    assert found is not None, text
    assert abs(int(found.group(1)) - line) <= 1, text
    for word in words:
        assert word in text


def test_a_whole_number_with_a_point_is_one(short: Path) -> None:
    """To a schema 5.0 is an integer; as text in a generator's name it would be another seed."""
    text = GOOD.replace("name: test\n", "name: test\nseed: 1000.0\n")
    text = text.replace("  - name: hold", "  - display: {brightness: 50.0}\n  - name: hold")
    scenario = load_text(text)
    assert type(scenario.seed) is int and scenario.seed == 1000
    assert type(scenario.steps[2].arguments["brightness"]) is int


def test_every_mistake_of_a_file_is_told_a_line_each(short: Path, schmidt: Command) -> None:
    """Two unknown fields in one block are two, and what a quantity says about its type is told once."""
    text = GOOD.replace("name: test\n", "name: test\nseed: -1\nsed: 1\nsid: 2\n").replace("10 s}", "[3]}")
    short.write_text(text)
    done = schmidt("run", short)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.splitlines() == [
        f"schmidt: {short}:2: seed: -1 is out of range; it must be at least 0",
        f"schmidt: {short}:3: unknown field 'sed'; did you mean 'seed'?",
        f"schmidt: {short}:4: unknown field 'sid'; did you mean 'site'?",
        f"schmidt: {short}:11: steps.2.track.for: [3] is not a value with a unit such as '10 s'",
    ]


def test_of_a_hundred_mistakes_a_screen_is_told() -> None:
    text = GOOD.replace("name: test\n", "name: test\n" + "".join(f"x{k}: 1\n" for k in range(100)))
    with pytest.raises(ScenarioError) as caught:
        load_text(text)
    assert len(caught.value.__notes__) == 20
    assert caught.value.__notes__[-1] == "night.yaml: and 80 mistakes more"


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
        lambda inner: st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["steps", "name", "goto", "target", "at", "x"]), inner, max_size=3),
        max_leaves=12,
    )
)  # fmt: skip
def test_whatever_the_yaml_holds_the_answer_is_one_line(data: object) -> None:
    """Arbitrary data in place of a scenario: a ScenarioError of one line, never another exception."""
    text = message(
        yaml.safe_dump({"name": "n", "start_utc": "2026-02-10T14:00:00Z", "steps": data, "plant": data})
    )
    assert text.startswith("night.yaml:")


@given(
    st.sampled_from(sorted(schema()["$defs"]["step"]["properties"])),
    st.integers(0, 20),
    st.characters(codec="ascii"),
)
def test_every_misspelt_step_field_is_refused(word: str, position: int, letter: str) -> None:
    wrong = word[:position] + letter + word[position:]
    if wrong in schema()["$defs"]["step"]["properties"]:
        return
    text = message(yaml.safe_dump({"name": "n", "start_utc": "2026-02-10T14:00:00Z", "steps": [{wrong: {}}]}))
    assert "night.yaml" in text


def test_the_published_schema_is_a_schema_and_ours_comply() -> None:
    jsonschema.Draft202012Validator.check_schema(json.loads(SCHEMA_FILE.read_text()))
    files = sorted(FOLDER.glob("*.yaml"))
    assert files
    for file in files:
        assert file.read_text().startswith("# yaml-language-server: $schema=scenario.schema.json"), file
        convert(parse(file.read_text(), file))


@given(
    st.floats(-1e6, 1e6),
    st.sampled_from([(kind, word) for kind in QUANTITIES for word in QUANTITIES[kind].units]),
)
def test_values_scale_with_their_unit(number: float, unit: tuple[str, str]) -> None:
    kind, word = unit
    factor = QUANTITIES[kind].units[word]
    assume(abs(number * factor) <= QUANTITIES[kind].limit)
    assert parse_value(f"{number!r} {word}", kind) == pytest.approx(number * factor)


@given(st.text(max_size=12), st.sampled_from(["time", "angle", "rate"]))
def test_any_other_text_is_a_unit_error(text: str, quantity: str) -> None:
    try:
        assert isinstance(parse_value(text, quantity), float)
    except UnitError as error:
        assert any(word in str(error) for word in QUANTITIES[quantity].units) or "large" in str(error)


def test_a_missing_file_and_a_file_of_bytes_are_named(tmp_path: Path) -> None:
    from scenarios.lab.prepare import load

    with pytest.raises(ScenarioError, match="no such file"):
        load(tmp_path / "none.yaml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ScenarioError, match="cannot be read"):
        load(tmp_path / "bytes.yaml")
    with pytest.raises(ScenarioError, match="cannot be read"):
        load(tmp_path)


def test_parameters_of_a_board_go_by_number() -> None:
    network = "network:\n  nodes:\n    AXIS_RA: {parameters: {2: 300}}\n"
    assert load_text(network + GOOD).network["nodes"]["AXIS_RA"]["parameters"]
    assert "'kp' is not a parameter's number" in message(network.replace("2: 300", "kp: 3") + GOOD)
    assert "did you mean 'AXIS_RA'" in message(network.replace("AXIS_RA", "AXIS_RR") + GOOD)
