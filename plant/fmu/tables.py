"""model.h: the numbers of one axis and where in its row of the world they go, for plant/fmu/wrapper.c."""

from collections.abc import Iterable, Sequence
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
    part, of, each = axis.part, axis.of_effects, axis.parameters
    everything = tuple(replace(effect, enabled=True) for effect in part.effects)
    made = rows_of(everything, constants(part), axis.seed, axis.axis)
    rows, fills = _rows(axis, made)
    changes = [  # what effects change once
        (k, of[k][parameter], NUMBER_OF[switch])
        for k, effect in enumerate(part.effects)
        for parameter, switch in REGISTRY[effect.name].switches.items()
    ]
    late = [k for k, effect in enumerate(part.effects) if effect.name == LATE]
    counters = [
        (reading, COLUMNS.index(column), NUMBER_OF[bits] if bits else -1)
        for _, reading, column, bits in COUNTERS
    ]
    sizes = _PLACES | {
        "N_PARAMETERS": len(each), "N_EFFECTS": len(axis.enabled), "N_ROWS": len(rows),
        "N_CHANGES": len(changes), "N_DELAYS": len(late), "N_REALS": len(REALS), "N_COUNTERS": len(COUNTERS),
    }  # fmt: skip
    return "\n".join(
        [
            f'#define TOKEN "{token}"',
            f"enum {{ {_list(f'{name} = {size}' for name, size in sizes.items())} }};",
            *(
                f"static const double {name.upper()}[] = {{{_list(float(getattr(p, name)) for p in each)}}};"
                for name in ("start", "low", "high")
            ),
            'static const char *const NAMES[] = {"' + '", "'.join(p.name for p in each) + '"};',
            f"static const _Bool ENABLED[] = {{{_list(map(int, (*axis.enabled, False)))}}};",
            _table("CHANGES", "effect, parameter, number", changes),
            _table("DELAYS", "effect, column, delay", [(k, of[k]["column"], of[k]["delay"]) for k in late]),
            _table("ROWS", "effect, of_motors, first, end", rows),
            _table("FILLS", "place, constant, from", fills),
            _table("COUNTER", "reading, column, bits", counters),
            f"static const double ROW_START[][AT_ROW] = {_braced([*(row for *_, row in made), [0.0]])};\n",
        ]
    )


_Table = Sequence[tuple[int, ...]]


def _rows(axis: Exported, made: list[tuple[Any, int, list[float]]]) -> tuple[_Table, _Table]:
    """Rows of all effects, as if each were switched on, and what the importer's numbers fill in."""
    rows: list[tuple[int, ...]] = []
    fills: list[tuple[int, ...]] = []
    for hook, k, _ in made:
        first = len(fills)
        for place, name in enumerate(REGISTRY[axis.part.effects[k].name].numbers, at.ROW_MEMORY + MEMORY):
            if name in axis.of_effects[k]:
                fills.append((place, 0, axis.of_effects[k][name]))
            elif name in _CONSTANTS:
                fills.append((place, 1, _CONSTANTS[name]))
        rows.append((k, int(hook < MOTOR_HOOKS), first, len(fills)))
    return rows, fills


def _list(values: Iterable[object]) -> str:
    return ", ".join(map(str, values))


def _braced(rows: Iterable[Iterable[float]]) -> str:
    return "{" + ",\n".join("{" + _list(row) + "}" for row in rows) + "}"


def _table(name: str, members: str, rows: _Table) -> str:
    """A table of whole numbers; a last row of zeros, as C knows no empty one."""
    return f"static const struct {{ int {members}; }} {name}[] = {_braced([*rows, (0,)])};"
