"""What the fields of a rig file need of each other: every rule of the schema speaks in its own words."""

import copy
import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Friction, Motors, Rig, made
from calibration.inputs.rigfile import SCHEMA, load_rig

ONE: dict[str, Any] = {
    "rig": "bench",
    "columns": {
        "time": {"column": "t", "unit": "s"},
        "position": {"column": "x", "unit": "rad"},
        "effort": {"column": "u", "unit": "V"},
        "reference": {"column": "r", "unit": "rad"},
        "current": {"column": "i", "unit": "A"},
        "duty": {"column": "d", "unit": "1"},
    },
    "supply_V": 24,
    "response": {"channel": "effort", "unit": "V"},
    "stages": [{"name": "motor", "period": 1.0}, {"name": "wheel", "of": "motor", "teeth": [10, 30]}],
}
TWO: dict[str, Any] = yaml.safe_load((Path(__file__).parents[1] / "azimuth.yaml").read_text(encoding="utf-8"))
GUIDE: dict[str, Any] = {"rig": "mount", "format": "phd2", "stages": [{"name": "worm", "period_s": 480}]}
GONE = object()
VOLTS = {"column": "v", "unit": "V"}
LAW = {"law": "pid", "gains": {"p": 1.0}, "source": "x"}
CASCADE = {"position": 1.0, "velocity": 2.0}
#: a sound file, what is changed in it, by its path, and what is said
CASES: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    (ONE, {"columns": GONE}, "'columns' is missing"),
    (ONE, {"response": GONE}, "'response' is missing"),
    (ONE, {"columns.position": GONE}, "columns: 'position' is missing"),
    (ONE, {"columns.time": GONE}, "columns: 'time' is missing; without a time column give sample_period_s"),
    (ONE, {"sample_period_s": 0.01}, "sample_period_s: there is a time column; give one of the two"),
    (
        ONE,
        {"columns.time.unit": "ms"},
        "columns.time.unit: 'ms', must be s; give the file's unit as a factor",
    ),
    (ONE, {"columns.effort.format": "iso"}, "columns.effort.format: is for time; leave it out"),
    (ONE, {"columns.effort.clock": "c"}, "columns.effort.clock: is for time; leave it out"),
    (ONE, {"columns.time.clock": "c"}, "columns.time: clock needs format, such as iso"),
    (
        ONE,
        {"columns.joint": {"column": "q", "unit": "deg"}, "estimate": ["gravity"]},
        "columns.joint.unit: must be the position's",
    ),
    (ONE, {"columns.effort.column": GONE}, "columns.effort: 'column' is missing; without one give files"),
    (
        ONE,
        {"columns.time": GONE, "sample_period_s": 1, "long": {"name": "n", "value": "v"}},
        "long: needs columns.time, the column of the stamps",
    ),
    (ONE, {"columns.effort.scale": 0}, "columns.effort.scale: 0 erases the column"),
    (ONE, {"columns.effort.window_s": 1}, "columns.effort.window_s: is for velocity, motor_a, motor_b"),
    (ONE, {"response.gain": 0}, "response.gain: 0 erases the response"),
    (ONE, {"response": [{"channel": "effort", "unit": "V", "gain": 0}]}, "0 erases the response"),
    (ONE, {"response.ratio": 2}, "response.ratio: is for a second sensor (channel: position2)"),
    (ONE, {"columns.voltage": VOLTS}, "columns.duty: the voltage is given; leave one of the two out"),
    (ONE, {"columns.current": GONE}, "columns.duty: a balance of volts needs the current; give"),
    (ONE, {"supply_V": GONE}, "columns.duty: needs what a duty of 1 gives, a column of the supply"),
    (ONE, {"columns.supply": VOLTS}, "columns.duty: needs what a duty of 1 gives, a column of the supply"),
    (ONE, {"columns.duty": GONE}, "supply_V: is for a column of the duty; leave it out"),
    (ONE, {"columns.duty.unit": "%"}, "columns.duty.unit: '%', must be 1 for a balance of volts"),
    (ONE, {"columns.current.unit": "mA"}, "columns.current.unit: 'mA', must be A for a balance of volts"),
    (
        ONE,
        {"columns.duty": GONE, "supply_V": GONE, "columns.voltage": VOLTS | {"unit": "mV"}},
        "columns.voltage.unit: 'mV', must be V for a balance of volts",
    ),
    (ONE, {"encoder_periods": 9}, "encoder_periods: is for a drive with motors; leave it out"),
    (
        ONE,
        {"stages.0.kind": "roller"},
        "stages.motor.kind: 'roller' is for a drive with motors; leave it out",
    ),
    (
        ONE,
        {"controller": LAW, "columns.reference": GONE},
        "controller: needs the columns reference and effort",
    ),
    (ONE, {"controller": LAW | {"gains": {"i": 1}}}, "controller.gains: 'p' is missing; a pid has it"),
    (
        ONE,
        {"controller": LAW | {"gains": {"p": 1, "velocity": 2}}},
        "gains.velocity: a pid has none; it has acceleration_feedforward",
    ),
    (
        ONE,
        {"controller": LAW | {"law": "cascade", "gains": {"position": 1}}},
        "'velocity' is missing; a cascade",
    ),
    (
        ONE,
        {"controller": LAW | {"law": "cascade", "gains": CASCADE | {"i": 1}}},
        "gains.i: a cascade has none",
    ),
    (ONE, {"stages.1.teeth": GONE}, "stages.wheel: 'of' needs 'teeth'"),
    (ONE, {"stages.1.of": GONE}, "stages.wheel: 'teeth' needs 'of'"),
    (
        ONE,
        {"stages.1.teeth": [10**7, 30]},
        "stages.wheel.teeth.0: 10000000 is greater than the maximum of 1000000",
    ),
    (ONE, {"stages.1.period": 1.0}, "stages.wheel: give a period or teeth, not both"),
    (ONE, {"stages.1.period_s": 1.0}, "stages.wheel: give a period or teeth, not both"),
    (ONE, {"stages.0.period": GONE}, "stages.motor: give 'period', 'period_s', or 'teeth' with 'of'"),
    (ONE, {"friction_law": {"source": "x"}}, "friction_law: says nothing; give stiction_ratio"),
    (
        ONE,
        {"friction_law": {"source": "x", "stiction_ratio": 2}},
        "'stribeck_speed' is missing; a dip from rest",
    ),
    (ONE, {"runs": {"by": "column"}}, "runs.by: 'column' needs runs.column, the column's name"),
    (ONE, {"runs": {"by": "none", "column": "k"}}, "runs.column: is used with by: column, or alone"),
    (ONE, {"runs": {"minimum_travel": 1}}, "runs.minimum_travel: is used with by: turning_points only"),
    (
        ONE,
        {"wall_time": {"from": "name"}},
        "wall_time.from: 'name' needs wall_time.format, such as '%Hh%Mm%S'",
    ),
    (ONE, {"wall_time": {"from": "time", "format": "%H"}}, "wall_time.format: is used with from: name only"),
    (ONE, {"wall_time": {"from": "time", "gap_s": 1}}, "wall_time.gap_s: is used with from: order only"),
    (
        ONE,
        {"columns.time": GONE, "sample_period_s": 0.01, "wall_time": {"from": "time"}},
        "wall_time.from: 'time' needs a time column",
    ),
    (TWO, {"friction": GONE}, "motors: needs friction, the declared LuGre model"),
    (TWO, {"stages": GONE}, "motors: needs stages, from the axis to the motors"),
    (TWO, {"stages.0.kind": GONE}, "stages: a drive with motors has one stage of kind axis"),
    (TWO, {"stages.0.kind": "motor"}, "stages: a drive with motors has one stage of kind"),
    (TWO, {"smooth_s": 0.1}, "smooth_s: a drive with motors has its own balances; leave it out"),
    (TWO, {"supply_V": GONE}, "motors: an effort of 1 gives what? a column of the supply or supply_V"),
    (TWO, {"columns.supply": VOLTS}, "motors: an effort of 1 gives what? a column of the supply or supply_V"),
    (TWO, {"columns.effort": GONE}, "columns: 'effort' is missing; a drive with motors needs it"),
    (TWO, {"columns.motor_b": GONE}, "columns: 'motor_b' is missing; one motor's says nothing without it"),
    (TWO, {"columns.force": VOLTS}, "columns.force: nothing uses it beside motors; leave it out"),
    (TWO, {"columns.effort.unit": "%"}, "columns.effort.unit: '%', must be 1 beside motors; give a scale"),
    (TWO, {"columns.current_a.unit": "mA"}, "columns.current_a.unit: 'mA', must be A beside motors"),
    (
        TWO,
        {"supply_V": GONE, "columns.supply": VOLTS | {"unit": "mV"}},
        "columns.supply.unit: 'mV', must be V beside motors; give a scale",
    ),
    (TWO, {"columns.temperature": VOLTS}, "columns.temperature.unit: 'V', must be degC beside motors"),
    (TWO, {"stages.1.kind": "roller"}, "stages: the velocity's encoder has one roller"),
    (TWO, {"stages.1.kind": "bearing_pass"}, "stages.pinion.kind: 'bearing_pass', beside motors one of axis"),
    (TWO, {"stages.0.period_s": 3}, "stages.azimuth.period_s: an axis with motors turns at any rate"),
    (TWO, {"format": "axis-log"}, "columns: a log of format axis-log says it itself; leave it out"),
    (GUIDE, {"format": "axis-log"}, "format: axis-log: needs motors, friction and stages"),
    (GUIDE, {k: TWO[k] for k in ("motors", "friction")}, "motors: a guide log shows none; leave it out"),
]


def written(folder: Path, base: dict[str, Any], change: dict[str, Any]) -> Path:
    """A rig file that is `base` with some of its fields changed, given or GONE."""
    data = copy.deepcopy(base)
    for where, value in change.items():
        *path, last = (int(x) if x.isdigit() else x for x in where.split("."))
        at: Any = data
        for step in path:
            at = at[step]
        if value is GONE:
            del at[last]
        else:
            at[last] = value
    file = folder / "rig.yaml"
    file.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    return file


@pytest.mark.parametrize("base", [ONE, TWO, GUIDE], ids=lambda d: d["rig"])
def test_the_files_that_are_changed_here_are_sound(tmp_path: Path, base: dict[str, Any]) -> None:
    assert load_rig(written(tmp_path, base, {})).name == base["rig"]


@pytest.mark.parametrize(("base", "change", "says"), CASES, ids=[says[:40] for _, _, says in CASES])
def test_a_rule_that_is_broken_says_so_in_one_line(
    tmp_path: Path, base: dict[str, Any], change: dict[str, Any], says: str
) -> None:
    path = written(tmp_path, base, change)
    with pytest.raises(CalibrationInputError, match=re.escape(says)) as caught:
        load_rig(path)
    assert "\n" not in str(caught.value)


def test_every_rule_of_the_schema_is_broken_here() -> None:
    rules = set(re.findall(r'"says": "((?:[^"\\]|\\.)*)"', json.dumps(json.loads(SCHEMA.read_text()))))
    silent = []
    for rule in rules:
        words = max(re.split(r"\{[^}]*\}", json.loads(f'"{rule}"')), key=len)
        if not any(words[:20] in says or says[-20:] in words for _, _, says in CASES):
            silent.append(rule)
    assert not silent


def test_other_mistakes_are_told_beside_the_first(tmp_path: Path) -> None:
    rig = tmp_path / "rig.yaml"
    rig.write_text(yaml.safe_dump({**ONE, "supply_V": "much", "foo": 1, "stagez": []}, sort_keys=True))
    with pytest.raises(CalibrationInputError) as caught:
        load_rig(rig)
    told = [str(caught.value), *caught.value.__notes__]
    assert len(told) == 3 and all(line.startswith(f"{rig}:") for line in told)
    for words in ("unknown field 'foo'", "unknown field 'stagez'; did you mean 'stages'?", "supply_V"):
        assert any(words in line for line in told), told


def test_the_line_is_that_of_the_field(tmp_path: Path) -> None:
    path = written(tmp_path, ONE, {"columns.effort.scale": 0})
    line = path.read_text().splitlines().index("    scale: 0") + 1
    with pytest.raises(CalibrationInputError) as caught:
        load_rig(path)
    assert caught.value.line == line


def test_fields_are_made_from_keys_with_their_units_and_whole_numbers_are_floats() -> None:
    motors = made(Motors, TWO["motors"])
    assert (motors.torque_constant, motors.resistance) == (0.12, 1.4)
    assert motors.rotor_inertia == (5e-5, 1e-3) and motors.stiffness_readings == (1.0,)
    friction = made(Friction, TWO["friction"][0])
    assert friction.stribeck_rate == 6e-4 and friction.state == ""
    column = made(Column, {"column": 3, "unit": "deg", "scale": 2})
    assert column.column == 3 and isinstance(column.scale, float)
    rig = made(
        Rig,
        {"rig": "x", "estimate": ["viscous"]},
        name="x",
        path=Path("x"),
        columns={},
        responses=(),
        stages=(),
    )
    assert rig.estimate == ("viscous",)
