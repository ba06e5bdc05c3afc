"""model.h: the numbers of one axis and where in its row of the world they go, for plant/fmu/wrapper.c."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from plant.effects import REGISTRY
from plant.effects.signals import MEMORY, MOTOR_HOOKS
from plant.fmu.variables import COUNTERS, NUMBER_OF, REALS, Exported
from plant.kernels import layout as at
from plant.plant import COLUMNS, LATE
from plant.rows import rows_of
from plant.world import constants

_PLACES = {
    **{f"AT_{name}": place for name, place in vars(at).items() if isinstance(place, int)},
    "GRID": NUMBER_OF["grid"], "CURRENTS": COLUMNS.index("currents"), "N_COLUMNS": len(COLUMNS),
    "N_NUMBERS": len(NUMBER_OF),
}  # fmt: skip
_CONSTANTS = {
    "torque_constant": at.TORQUE_CONSTANT, "resistance": at.RESISTANCE, "winding": at.WINDING,
    "ratio": at.RATIO,
}  # fmt: skip
"""Where prepare leaves what formulas of effects may know of the axis."""


def header(axis: Exported, token: str) -> str:
    """Return the text of model.h."""
    rows, fills = _rows(axis)
    starts = [row for *_, row in _row_numbers(axis)]
    changes, delays = _changes(axis), _delays(axis)
    sizes = {
        **_PLACES, "N_PARAMETERS": len(axis.parameters), "N_EFFECTS": len(axis.enabled), "N_ROWS": len(rows),
        "N_CHANGES": len(changes), "N_DELAYS": len(delays), "N_REALS": len(REALS),
        "N_COUNTERS": len(COUNTERS),
    }  # fmt: skip
    counters = [
        (reading, COLUMNS.index(column), NUMBER_OF[bits] if bits else -1)
        for _, reading, column, bits in COUNTERS
    ]
    each = axis.parameters
    return "\n".join(
        [
            f'#define TOKEN "{token}"',
            f"enum {{ {', '.join(f'{name} = {size}' for name, size in sizes.items())} }};",
            _numbers("START", [p.start for p in each]),
            _numbers("LOW", [p.low for p in each]),
            _numbers("HIGH", [p.high for p in each]),
            "static const char *const NAMES[] = {" + ", ".join(f'"{p.name}"' for p in each) + "};",
            "static const _Bool ENABLED[] = {"
            + ", ".join(str(int(on)) for on in (*axis.enabled, False))
            + "};",
            _table("CHANGES", "effect, parameter, number", changes),
            _table("DELAYS", "effect, column, delay", delays),
            _table("ROWS", "effect, of_motors, first, end", rows),
            _table("FILLS", "place, constant, from", fills),
            _table("COUNTER", "reading, column, bits", counters),
            "static const double ROW_START[][AT_ROW] = {"
            + ",\n".join("{" + ", ".join(map(repr, row)) + "}" for row in [*starts, [0.0]])
            + "};\n",
        ]
    )


def _row_numbers(axis: Exported) -> list[tuple[Any, int, list[float]]]:
    """Rows of all effects, as if each were switched on."""
    part = axis.part
    everything = tuple(replace(effect, enabled=True) for effect in part.effects)
    return rows_of(everything, constants(part), axis.seed, axis.axis)


def _rows(axis: Exported) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    rows: list[tuple[int, ...]] = []
    fills: list[tuple[int, ...]] = []
    for hook, k, _ in _row_numbers(axis):
        first = len(fills)
        for j, name in enumerate(REGISTRY[axis.part.effects[k].name].numbers):
            place = at.ROW_MEMORY + MEMORY + j
            if name in axis.of_effects[k]:
                fills.append((place, 0, axis.of_effects[k][name]))
            elif name in _CONSTANTS:
                fills.append((place, 1, _CONSTANTS[name]))
        rows.append((k, int(hook < MOTOR_HOOKS), first, len(fills)))
    return rows, fills


def _changes(axis: Exported) -> list[tuple[int, ...]]:
    """What effects change once."""
    return [
        (k, axis.of_effects[k][parameter], NUMBER_OF[switch])
        for k, effect in enumerate(axis.part.effects)
        for parameter, switch in REGISTRY[effect.name].switches.items()
    ]


def _delays(axis: Exported) -> list[tuple[int, ...]]:
    return [
        (k, axis.of_effects[k]["column"], axis.of_effects[k]["delay"])
        for k, effect in enumerate(axis.part.effects)
        if effect.name == LATE
    ]


def _numbers(name: str, values: Iterable[float]) -> str:
    return f"static const double {name}[] = {{{', '.join(map(repr, map(float, values)))}}};"


def _table(name: str, members: str, rows: Iterable[tuple[int, ...]]) -> str:
    """A table of whole numbers; a last row of zeros, as C knows no empty one."""
    text = ", ".join("{" + ", ".join(map(str, row)) + "}" for row in (*rows, (0,)))
    return f"static const struct {{ int {members}; }} {name}[] = {{{text}}};"
