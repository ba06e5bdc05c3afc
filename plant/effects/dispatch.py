"""Static dispatch over the effects: a kind is a number in a row, its formula is called directly.

Compiled code cannot call through a table without losing inlining and caching, so the two functions are chains
of calls. The chains are written here, from the registry: a new effect is its own file and nothing else.
"""

from collections.abc import Callable
from importlib import import_module

from plant.compiled import Floats, inner
from plant.effects import REGISTRY
from plant.effects.base import Formula, Term


def terms() -> list[tuple[str, Term]]:
    """Return (module of the effect, term) of every formula, in the order of the registry."""
    found: dict[Formula, tuple[str, Term]] = {}
    for name, effect in REGISTRY.items():
        for term in effect.terms:
            found.setdefault(term.formula, (name, term))
    return list(found.values())


TERMS = terms()
#: formula -> the number that stands for it in a row of the kernel
KINDS: dict[Formula, int] = {term.formula: kind for kind, (_, term) in enumerate(TERMS)}


def source() -> str:
    """Return the two chains as text; a kind that is none has the value 0."""
    value = ["def value(kind, x, p):"]
    update = ["def update(kind, x, p, dt):"]
    for kind, (name, term) in enumerate(TERMS):
        value += [f"    if kind == {kind}:", f"        return {name}.{term.formula.__name__}(x, p)"]
        if term.update is not None:
            update += [f"    if kind == {kind}:", f"        {name}.{term.update.__name__}(x, p, dt)"]
    return "\n".join([*value, "    return 0.0", *update, "    return", ""])


globals().update({name: import_module(f"{__package__}.{name}") for name, _ in TERMS})
exec(compile(source(), __file__, "exec"), globals())

#: (kind, x, p) -> value of a term in its hook's unit; friction terms change x in place
value: Callable[[int, Floats, Floats], float] = inner(globals()["value"])
#: (kind, x, p, dt in s): advances the memory of a term
update: Callable[[int, Floats, Floats, float], None] = inner(globals()["update"])
