"""The row of an axis: every place has one meaning, and none is left over."""

from itertools import pairwise

from plant.effects.signals import HOOK_COUNT, MOTOR_HOOKS, SIGMA0, STRIBECK_EXPONENT, VECTOR, Hook
from plant.kernels import layout as at

BLOCKS = {
    "MOTORS": 2 * at.MOTOR_SIZE, "DUTY": 2, "MEAN_DUTY": 2, "VALLEY": 2, "TACH_ZERO": 2, "OUT": at.OUT_SIZE,
    "DECLARED_FRICTION": at.FRICTION_SIZE, "SIGNALS": SIGMA0, "FRICTION_NOW": at.FRICTION_SIZE,
    "SUMS": HOOK_COUNT, "SUMS_OF_B": MOTOR_HOOKS, "EFFECTS": at.ROW * at.MAX_EFFECTS,
    "TRUTH": at.TRUTH_ROWS * at.TRUTH_SIZE, "DELAYS": at.DELAY_ROWS * at.OUT_SIZE,
}  # fmt: skip
"""Places that take more than one number."""
WITHIN = ("M_", "F_", "OUT_", "ROW_")
"""Beginnings of words that are places within a block."""
SIZES = {"MOTOR_SIZE", "FRICTION_SIZE", "SIGNALS_SIZE", "SIGNALS_END", "ROW", "MAX_EFFECTS", "TRUTH_COLUMNS",
         "TRUTH_SIZE", "TRUTH_ROWS", "DELAY_ROWS", "WIDTH"}  # fmt: skip


def test_places_of_a_row_follow_each_other() -> None:
    words = vars(at).items()
    places = {
        name: place
        for name, place in words
        if name.isupper() and name not in SIZES and (not name.startswith(WITHIN) or name == "ROWS_ALL")
    }
    order = sorted(places, key=lambda name: (places[name], name))
    assert places[order[0]] == 0
    for name, following in pairwise(order):
        assert places[following] == places[name] + BLOCKS.get(name, 1), following
    assert places[order[-1]] + BLOCKS[order[-1]] == at.WIDTH


def test_readings_of_a_block_follow_each_other() -> None:
    """Pairs of value and slope, then two currents; a row of an effect begins with its hook."""
    assert (at.OUT_INCREMENTAL, at.OUT_ABSOLUTE, at.OUT_AUXILIARY) == (0, 2, 4)
    assert (at.OUT_TACH_A, at.OUT_TACH_B, at.OUT_ANGLE) == (6, 8, 10)
    assert (at.OUT_CURRENT_A, at.OUT_CURRENT_B, at.OUT_SIZE) == (12, 13, 14)
    assert (at.ROW_KIND, at.ROW_MEMORY) == (1, 2)


def test_signals_of_the_row_are_those_of_the_effects() -> None:
    assert at.FRICTION_NOW - at.SIGNALS == SIGMA0
    assert at.FRICTION_NOW + at.F_EXPONENT - at.SIGNALS == STRIBECK_EXPONENT
    assert at.SIGNALS_END - at.SIGNALS == VECTOR
    assert sum(hook < MOTOR_HOOKS for hook in Hook) == MOTOR_HOOKS == at.EFFECTS - at.SUMS_OF_B
