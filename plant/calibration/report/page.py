"""report.html from the report's data and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def summary(data: dict[str, Any]) -> str:
    """One sentence for the top of the page."""
    effects = data["effects"]
    if data["verdict"] == "nothing":
        return "Nothing is missing from the declared model that this log could show."
    if not effects:
        return ""
    top = effects[0]
    place = f" on {top['stage']}" if top["stage"] else ""
    if data["verdict"] == "unknown":
        return (
            f"Something real is left that the catalogue does not name: a function of "
            f"{top['domain'].replace('_', ' ')}"
            f" in channel {top['channel']}."
        )
    if data["verdict"] == "ambiguous":
        return f"{top['name']}{place}, which this log cannot tell from {', '.join(top['equivalent'])}."
    more = f", and {len(effects) - 1} more" if len(effects) > 1 else ""
    return f"The declared model lacks {top['name']}{place}{more}."


def page(data: dict[str, Any], pictures: list[dict[str, str]], title: str, subtitle: str) -> str:
    """The HTML page with pictures embedded."""
    from jinja2 import Environment, FileSystemLoader

    here = Path(__file__).parent
    env = Environment(loader=FileSystemLoader(here), autoescape=True)
    return env.get_template("report.html.j2").render(
        r=data, plots=pictures, title=title, subtitle=subtitle, summary=summary(data)
    )
