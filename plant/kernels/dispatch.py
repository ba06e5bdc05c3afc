"""Static dispatch over the effects: a kind is a number in a row, its formula is called directly.

Compiled code cannot call through a table without losing inlining and caching, so the two functions are chains
of calls. The chains are written here, from the registry, and with them which number of the row each argument
of a formula is. A new effect is its own file and nothing else.
"""

from collections.abc import Callable
from inspect import signature
from typing import Any

from plant.compiled import Floats, inner
from plant.effects import REGISTRY
from plant.effects.base import Effect, Formula, Term, Update
from plant.effects.signals import MOTOR, Hook

#: every formula, in the order of the registry; a kind is a place in this list
TERMS: list[tuple[Effect, Term]] = [
    (effect, term) for effect in REGISTRY.values() for term in effect.terms if term.formula is not None
]
#: formula -> the number that stands for it in a row of the kernel
KINDS: dict[Formula | None, int] = {term.formula: kind for kind, (_, term) in enumerate(TERMS)}


def call(function: Formula | Update, kind: int) -> str:
    """Return the call of a function of that kind, its arguments taken out of signals and row."""
    effect, term = TERMS[kind]
    places = {"x": "x", "dt": "dt", **effect.places(term)}
    return f"{function.__name__}_{kind}({', '.join(places[word] for word in signature(function).parameters)})"


def source() -> str:
    """Return the two chains as text; a kind that is none has the value 0."""
    value = ["def value(kind, x, p):"]
    update = ["def update(kind, x, p, dt):"]
    for kind, (effect, term) in enumerate(TERMS):
        places = effect.places(term)
        value.append(f"    if kind == {kind}:")
        if "motor" in places:
            value.append(f"        if {places['motor']} != 0.0 and {places['motor']} != x[{MOTOR}] + 1.0:")
            value.append("            return 0.0")
        assert term.formula is not None
        made = call(term.formula, kind)
        value.append(
            f"        {made}\n        return 0.0" if term.hook == Hook.FRICTION else f"        return {made}"
        )
        if term.update is not None:
            memory = ", ".join(places[word] for word in term.memory)
            update.append(f"    if kind == {kind}:")
            update.append("        " + (f"{memory} = " if memory else "") + call(term.update, kind))
    return "\n".join([*value, "    return 0.0", *update, "    return", ""])


chains: dict[str, Any] = {
    f"{function.__name__}_{kind}": inner(function)
    for kind, (_, term) in enumerate(TERMS)
    for function in (term.formula, term.update)
    if function is not None
}
exec(compile(source(), __file__, "exec"), chains)

#: (kind, x, p) -> value of a term in its hook's unit; friction terms change x in place
value: Callable[[int, Floats, Floats], float] = inner(chains["value"])
#: (kind, x, p, dt in s): advances the memory of a term
update: Callable[[int, Floats, Floats, float], None] = inner(chains["update"])
