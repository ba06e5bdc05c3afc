"""report.html from the report's data and pictures, and the sentence that says the verdict."""

from pathlib import Path
from typing import Any

from calibration.decide.verdict import ROWS
from calibration.finding import UNKNOWN

CHANNELS = {
    "T": "torque or effort",
    "K": "position (difference of two encoders, or of the star and the drive)",
    "E": "electrical",
    "S": "sensor, clock or log",
}

PLACES = ("begin", "place")  # parameters that say where a shape without a name lies


def summary(data: dict[str, Any]) -> str:
    """What was found, in one sentence."""
    effects, verdict = data["effects"], data["verdict"]
    if verdict == "nothing" and any("still missing" in x for x in data["reasons"]):
        return "No effect shows in this log, with a name or without, though more is left than sensors leave."
    if verdict == "nothing":
        return "Nothing is missing from the declared model that this log could show."
    if verdict == "cannot tell":
        lacks = data["separating_experiment"]
        return f"This log cannot tell whether something is missing. It lacks: {lacks}."
    top = effects[0]
    if verdict == UNKNOWN:
        period = f" with a period of {1 / top['frequency_Hz']:.4g} s" if top["frequency_Hz"] else ""
        of = f"{top['domain'].replace('_', ' ')}{period} in {CHANNELS.get(top['channel'], top['channel'])}"
        note = f"; {top['note']}" if top["note"] else ""
        return f"Something real is left that the catalogue does not name: a function of {of}{note}."
    if verdict == "ambiguous":
        others = [f"another {n}" if n == top["name"] else n for n in top["equivalent"]]
        return f"{_say(top)}, which this log cannot tell from {', '.join(others)}."
    more = f", and {len(effects) - 1} more" if len(effects) > 1 else ""
    return f"The declared model lacks {_say(top)}{more}."


def _say(effect: dict[str, Any]) -> str:
    detail = [f"period {1 / effect['frequency_Hz']:.5g} s"] if effect["frequency_Hz"] else []
    detail += [f"{name} {p['value']:.3g} {unit}".strip() for name, unit, p in size(effect)]
    place = f" on {effect['stage']}" if effect["stage"] else ""
    return f"{effect['name']}{place}" + (f" ({', '.join(detail)})" if detail else "")


def size(effect: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    """Name, unit and numbers of the parameter that says how large it is: the amplitude, else the first that
    is no phase. Of a function without a name, its place. Empty where there is none."""
    wanted = PLACES if effect["name"] == UNKNOWN else effect["parameters"]
    named = [x for x in parameters(effect) if x[0] in wanted and "phase" not in x[0]]
    named.sort(key=lambda x: x[0] != "amplitude")
    return [(n.replace("_", " "), p["unit"] if p["unit"] != "1" else "", p) for n, p in named[:1]]


def _worth(data: dict[str, Any]) -> str:
    """What the first effect takes away on held-out rows."""
    row = data["error"].get(ROWS.get(data["effects"][0]["channel"], "")) if data["effects"] else None
    if not row:
        return ""
    floor = "not known" if row["floor"] is None else f"{row['floor']:.2g}"
    change = f"from {row['before']:.3g} to {row['after']:.3g} {row['unit']} (floor {floor})"
    return f" On data nothing was fitted to, the error goes {change}."


def parameters(effect: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Parameters worth a line on the page: the knots of an unnamed function are drawn, not listed."""
    return [(n, p) for n, p in effect["parameters"].items() if not n.startswith("knot_")]


def page(data: dict[str, Any], pictures: list[dict[str, str]], title: str, subtitle: str) -> str:
    """The HTML page with pictures embedded."""
    from jinja2 import Environment, FileSystemLoader

    env = Environment(loader=FileSystemLoader(Path(__file__).parent), autoescape=True)
    more = {"summary": summary(data) + _worth(data), "parameters": parameters, "channels": CHANNELS}
    template = env.get_template("report.html.j2")
    return template.render(r=data, plots=pictures, title=title, subtitle=subtitle, **more)
