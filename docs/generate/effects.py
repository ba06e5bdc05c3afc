"""docs/reference/effects.md: the catalogue of physical effects, from plant/effects."""

from docs.generate.tex import tex
from docs.generate.text import MADE, cell, table
from plant.effects import REGISTRY, Effect

_HEAD = """# Effects

{made}
A plant file or a scenario adds an effect by its name; `schmidt calibrate` names the same effects from a log.
`schmidt effects NAME` prints one. What is known of each, with its sources, is in
[the catalogue](../sources/effects.md).

| Channel | In which signal the effect is seen |
|---|---|
| T | torque at the axis |
| E | volts and currents of the motors |
| K | encoders against each other |
| S | one column or its time stamps |

In the formulas ω is the rate and φ a phase. An arrow says what takes the place of a quantity of the model.
"""


def _effect(effect: Effect) -> str:
    facts = [f"channel {effect.channel}", f"seen over {effect.domain.replace('_', ' ')}"]
    if effect.stages:
        facts.append("stages " + ", ".join(f"`{each}`" for each in effect.stages))
    rows = [
        [f"`{p.name}`", cell(p.unit), f"{p.default:g}", f"{p.low:g} to {p.high:g}", cell(p.source)]
        for p in effect.parameters
    ]
    parameters = table(["parameter", "unit", "default", "range", "source"], rows) if rows else ""
    return (
        f"\n## {effect.name}\n\n$$\n{tex(effect.equation)}\n$$\n\nIt is in {', '.join(facts)}.\n{parameters}"
    )


def page() -> str:
    """The whole page, Markdown."""
    made = MADE.format(source="`plant/effects/`")
    return _HEAD.format(made=made) + "".join(_effect(each) for each in REGISTRY.values())
