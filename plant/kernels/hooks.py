"""Where effects enter the step: rows of numbers, sorted by hook; a hook without rows costs one comparison."""

from plant.compiled import inner
from plant.effects.dispatch import update, value
from plant.effects.signals import HOOK_COUNT, Hook
from plant.kernels.layout import EFFECTS, HOOKS, ROW, ROW_MEMORY, SIGNALS, SIGNALS_END

RESISTANCE = int(Hook.RESISTANCE)
SWITCH = int(Hook.SWITCH)
LOG = int(Hook.LOG)


@inner
def used(w, hook):  # type: ignore[no-untyped-def]
    """Return whether any effect acts at the hook."""
    return w[HOOKS + hook + 1] > w[HOOKS + hook]


@inner
def total(w, hook):  # type: ignore[no-untyped-def]
    """Return the sum of the values at a hook; the signals of `w` must be filled."""
    first = int(w[HOOKS + hook])
    last = int(w[HOOKS + hook + 1])
    result = 0.0
    for r in range(first, last):
        place = EFFECTS + r * ROW
        result += value(int(w[place]), w[SIGNALS:SIGNALS_END], w[place + ROW_MEMORY : place + ROW])
    return result


@inner
def remember(w, first_hook, last_hook, dt):  # type: ignore[no-untyped-def]
    """Advance the memories of the effects at hooks first_hook <= hook < last_hook."""
    first = int(w[HOOKS + first_hook])
    last = int(w[HOOKS + last_hook])
    for r in range(first, last):
        place = EFFECTS + r * ROW
        update(int(w[place]), w[SIGNALS:SIGNALS_END], w[place + ROW_MEMORY : place + ROW], dt)


@inner
def any_effect(w):  # type: ignore[no-untyped-def]
    """Return whether any effect acts in the step or in a reading."""
    return w[HOOKS + HOOK_COUNT] > 0.0
