"""model.h, read as a C compiler does: what goes where in the row of an axis."""

import re
from typing import Any

import pytest

from plant.effects import REGISTRY
from plant.fmu.tables import header
from plant.fmu.variables import exported
from plant.kernels import layout as at
from plant.model import load, with_effects
from plant.parts import EffectModel
from plant.rows import KINDS, number_from
from plant.world import Numbers
from tests.plant.fmu.sample import DECLARED, axis

MADE = axis()
TEXT = header(MADE, "{token}")


def table(name: str, text: str = TEXT) -> list[Any]:
    """An initialiser as nested lists; numbers as they stand."""
    (body,) = re.findall(rf" {name}\[\](?:\[AT_ROW\])? = (\{{.*?\}});\n", text, re.DOTALL)
    found: list[Any] = eval(body.replace("{", "[").replace("}", "]"), {})
    return found


def sizes() -> dict[str, int]:
    (body,) = re.findall(r"enum \{ (.*) \};", TEXT)
    return {name: int(size) for name, size in (each.split(" = ") for each in body.split(", "))}


def test_sizes_and_places_are_those_of_the_layout() -> None:
    found = sizes()
    assert found["AT_WIDTH"] == at.WIDTH and found["AT_ROW"] == at.ROW and found["AT_GRID"] == at.GRID
    assert (found["GRID"], found["CURRENTS"], found["N_COLUMNS"]) == (0, 3, 5)
    assert (found["N_NUMBERS"], found["N_PARAMETERS"]) == (DECLARED, len(MADE.parameters))
    assert (found["N_EFFECTS"], found["N_ROWS"], found["N_CHANGES"], found["N_DELAYS"]) == (8, 5, 1, 1)
    assert (found["N_REALS"], found["N_COUNTERS"]) == (6, 5)
    assert TEXT.startswith('#define TOKEN "{token}"\n') and TEXT.endswith("};\n")


def test_numbers_of_the_importer() -> None:
    for name in ("start", "low", "high"):
        assert table(name.upper()) == [getattr(each, name) for each in MADE.parameters]
    assert table("NAMES") == [each.name for each in MADE.parameters]
    assert table("ENABLED") == [1, 1, 0, 1, 1, 1, 1, 1, 0]  # a last one, as C knows no empty table


def test_what_effects_change_once_and_what_comes_late() -> None:
    compliance, delay = MADE.of_effects[5]["compliance"], MADE.of_effects[4]
    assert table("CHANGES") == [[5, compliance, Numbers._fields.index("compliance")], [0]]
    assert table("DELAYS") == [[4, delay["column"], delay["delay"]], [0]]


def test_counters_have_their_delay_and_their_bits() -> None:
    """Delays: effort 0, position 1, velocity 2, currents 3, tachometers 4."""
    bits = [Numbers._fields.index(name) for name in ("absolute", "auxiliary")]
    assert table("COUNTER") == [[0, 2, -1], [2, 1, bits[0]], [4, 1, bits[1]], [6, 4, -1], [8, 4, -1], [0]]


def test_rows_stand_by_their_hooks_and_switched_off_ones_among_them() -> None:
    """Effect, whether it acts on motors; its fills: as many as its formula has numbers."""
    rows = table("ROWS")
    assert rows.pop() == [0]
    assert [row[:2] for row in rows] == [[3, 1], [0, 0], [7, 0], [2, 0], [6, 0]]
    ends = [row[3] for row in rows]
    assert [row[2] for row in rows] == [0, *ends[:-1]]
    counts = [end - row[2] for row, end in zip(rows, ends, strict=True)]
    assert counts == [3, 2, 4, 4, 2]  # heating has two and the winding; a stage's order is no number


def test_fills_say_where_a_number_goes_and_where_from() -> None:
    """A row: hook, kind, three of memory and the seed, then numbers; a stage's order first."""
    fills, heating, mesh = table("FILLS"), MADE.of_effects[3], MADE.of_effects[0]
    first = 2 + 4
    assert fills[:5] == [
        [first, 0, heating["thermal_resistance"]],
        [first + 1, 0, heating["time_constant"]],
        [first + 2, 1, at.WINDING],
        [first + 1, 0, mesh["amplitude"]],
        [first + 2, 0, mesh["phase"]],
    ]
    assert fills[-1] == [0]


def test_rows_begin_as_the_plant_s_own() -> None:
    rows = table("ROW_START")
    assert len(rows) == 6 and rows[-1] == [0.0]
    mesh = rows[1]
    assert mesh[1] == KINDS[REGISTRY["gear_mesh"].terms[0].formula]
    assert mesh[2:6] == [0.0, 0.0, 0.0, number_from(3, "ra.gear_mesh.0")]
    assert mesh[6:] == pytest.approx([2 * 27 * 360.488748, 180.244374, 0.0], rel=1e-5)


def test_a_supply_belongs_to_no_motor() -> None:
    sagging = with_effects(load("low_preload"), "dec", (EffectModel("supply_sag"), EffectModel("adc_gain")))
    rows = table("ROWS", header(exported(sagging, "dec", 1), ""))
    assert rows == [[1, 1, 0, 2], [0, 0, 2, 3], [0]]
