"""`report.html`: one page with everything inside, and the figures as files beside it."""

import base64
import io
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

from host.logs.files import write_file
from scenarios.run.evaluate import Verdict
from scenarios.run.outcome import Outcome
from scenarios.run.report.figures import FIGURES
from scenarios.run.report.style import Figure

_LIBRARIES = ("numpy", "numba", "pyerfa", "python-can", "cantools", "pyarrow", "matplotlib")


def write(
    outcome: Outcome,
    verdicts: list[Verdict],
    summary: dict[str, Any],
    compared: tuple[list[dict[str, Any]], Figure] | None = None,
) -> None:
    """Draw the figures and write the page into the outcome's folder.

    compared: rows and figure of the same scenario without compensation (scenarios/run/compared.py).
    """
    pictures = []
    if compared is not None:
        data = picture(compared[1], outcome.folder / "compensation.png")
        pictures.append({"title": "Compensation", "data": data})
    for name, (title, draw) in FIGURES.items():
        figure = draw(outcome)
        if figure is not None:
            pictures.append({"title": title, "data": picture(figure, outcome.folder / f"{name}.png")})
    text = rendered(
        Path(__file__).with_name("report.html.j2"),
        scenario=outcome.scenario,
        verdicts=verdicts,
        summary=summary,
        pictures=pictures,
        compared=compared[0] if compared is not None else [],
        versions={"schmidt": version("schmidt"), "Python": platform.python_version()}
        | {name: version(name) for name in _LIBRARIES},
        start=outcome.scenario.clock.iso(0.0),
        files=sorted(path.name for path in outcome.folder.iterdir() if path.is_file()),
    )
    write_file(outcome.folder / "report.html", text)


def _figure(value: float | None) -> str:
    """A number for people: four figures, and nothing where rounding errors are all there is."""
    if value is None:
        return "–"
    return "0" if abs(value) < 1e-9 else f"{value:.4g}"


def rendered(template: Path, **what: Any) -> str:
    """The page that a template makes of what it is given."""
    import jinja2

    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(template.parent), autoescape=True)
    environment.filters["figure"] = _figure
    return environment.get_template(template.name).render(what)


def picture(figure: Figure, path: Path) -> str:
    """Save a figure, and give its PNG in base 64 for the page."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    write_file(path, buffer.getvalue())
    return base64.b64encode(buffer.getvalue()).decode()
