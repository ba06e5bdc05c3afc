"""report.html from the report's data and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

#: channel of an effect -> the row of the error table it is judged by
ROWS = {"T": "torque", "K": "position", "E": "electrical", "S": "velocity"}
CHANNELS = {
    "T": "torque or effort",
    "K": "position (difference of two encoders, or of the star and the drive)",
    "E": "electrical",
    "S": "sensor, clock or log",
}


def summary(data: dict[str, Any]) -> str:
    """What was found and what it is worth, for the top of the page."""
    effects = data["effects"]
    if data["verdict"] == "nothing":
        if any("still missing" in x for x in data["reasons"]):
            return (
                "No effect shows in this log, with a name or without, though more is left than sensors leave."
            )
        return "Nothing is missing from the declared model that this log could show."
    if data["verdict"] == "cannot tell":
        return "This log cannot tell whether something is missing. It lacks: " + (
            f"{data['separating_experiment']}."
        )
    if not effects:
        return ""
    top = effects[0]
    if data["verdict"] == "unknown":
        period = f" with a period of {1 / top['frequency_Hz']:.4g} s" if top["frequency_Hz"] else ""
        first = (
            f"Something real is left that the catalogue does not name: a function of "
            f"{top['domain'].replace('_', ' ')}{period} in {CHANNELS.get(top['channel'], top['channel'])}."
        )
    elif data["verdict"] == "ambiguous":
        first = f"{_say(top)}, which this log cannot tell from {', '.join(top['equivalent'])}."
    else:
        more = len(effects) - 1
        first = f"The declared model lacks {_say(top)}" + (f", and {more} more." if more else ".")
    return f"{first} {_worth(data['error'], top['channel'])}".strip()


def _say(effect: dict[str, Any]) -> str:
    place = f" on {effect['stage']}" if effect["stage"] else ""
    sizes = {n: x for n, x in parameters(effect) if effect["name"] != "unknown" and "phase" not in n}
    key = "amplitude" if "amplitude" in sizes else next(iter(sizes), "")
    size = sizes.get(key)
    period = f"period {1 / effect['frequency_Hz']:.5g} s" if effect["frequency_Hz"] else ""
    told = (
        f"{key.replace('_', ' ')} {size['value']:.3g} {'' if size['unit'] == '1' else size['unit']}"
        if size
        else ""
    )
    detail = ", ".join(x.strip() for x in (period, told) if x)
    return f"{effect['name']}{place}" + (f" ({detail})" if detail else "")


def _worth(error: dict[str, Any], channel: str) -> str:
    row = error.get(ROWS.get(channel, ""))
    if not row:
        return ""
    return (
        f"On data nothing was fitted to, the error goes from {row['before']:.3g} to {row['after']:.3g}"
        f" {row['unit']} (floor {'not known' if row['floor'] is None else format(row['floor'], '.2g')})."
    )


def parameters(effect: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Parameters worth a line on the page: the knots of an unnamed function are drawn, not listed."""
    return [(n, p) for n, p in effect["parameters"].items() if not n.startswith("knot_")]


def page(data: dict[str, Any], pictures: list[dict[str, str]], title: str, subtitle: str) -> str:
    """The HTML page with pictures embedded."""
    from jinja2 import Environment, FileSystemLoader

    here = Path(__file__).parent
    env = Environment(loader=FileSystemLoader(here), autoescape=True)
    return env.get_template("report.html.j2").render(
        r=data,
        plots=pictures,
        title=title,
        subtitle=subtitle,
        summary=summary(data),
        parameters=parameters,
        channels=CHANNELS,
    )
