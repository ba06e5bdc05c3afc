"""The page of a run by itself: its figures, its numbers for people, and what stands beside it."""

import base64
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.run.evaluate import Verdict
from scenarios.run.outcome import Outcome
from scenarios.run.report import html, style

SCENARIO = convert(
    parse(
        """\
name: a <page>
start_utc: 2026-02-10T14:00:00Z
steps:
  - {name: first, wait: {for: 1 s}}
""",
        Path("hand.yaml"),
    )
)
SUMMARY: dict[str, Any] = {
    "passed": True, "plant": "bare", "seed": 7, "simulated_s": 12.34, "real_time_factor": 5.0,
    "frames": 12345, "bus_load": 0.125, "frame_errors": 0, "overruns": 0, "error_log_entries": 0,
    "steps": [], "faults": [], "trace_digest": "abc",
}  # fmt: skip
VERDICTS = [Verdict("near", 2.0, 3.0, "arcsec", upper=True), Verdict("far", None, 4.0, "arcsec")]
PNG = b"\x89PNG\r\n\x1a\n"


def drawn(_outcome: Outcome) -> style.Figure:
    figure = style.new_figure(1.0, 2.0)
    style.axes(figure, 1, 1, 1)
    return figure


@pytest.fixture
def outcome(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Outcome:
    """With one figure that has something to show, and one that has not."""
    figures = {"some": ("Some figure", drawn), "none": ("No figure", lambda _: None)}
    monkeypatch.setattr(html, "FIGURES", figures)
    (tmp_path / "can.log").write_text("")
    (tmp_path / "folder").mkdir()
    return Outcome(tmp_path, SCENARIO, [], {})


def page(outcome: Outcome) -> str:
    return (outcome.folder / "report.html").read_text(encoding="utf-8")


def test_a_page_has_its_figures_inside_and_beside_it(outcome: Outcome) -> None:
    html.write(outcome, VERDICTS, SUMMARY)
    names = {each.name for each in outcome.folder.iterdir()}
    assert names == {"can.log", "folder", "report.html", "some.png"}
    picture = (outcome.folder / "some.png").read_bytes()
    assert picture.startswith(PNG)
    text = page(outcome)
    assert f'<img alt="Some figure" src="data:image/png;base64,{base64.b64encode(picture).decode()}">' in text
    assert text.count("<img") == 1
    assert 'Files: <span class="mono">can.log, some.png</span>' in text
    assert "a &lt;page&gt;" in text and "<page>" not in text
    assert "with and without the compensation" not in text
    for name, number in (("schmidt", version("schmidt")), ("Python", platform.python_version()),
                         ("numpy", version("numpy"))):  # fmt: skip
        assert f"{name} {number}" in text
    assert f"starts {SCENARIO.clock.iso(0.0)} " in text
    assert '<td class="n">–</td>' in text and "≤ 3" in text and "≥ 4" in text


def test_a_comparison_stands_first_with_its_rows(outcome: Outcome) -> None:
    row = {"step": "held", "run": "with it", "peak": 0.123456, "rms": 1e-12, "angle": 7.0}
    html.write(outcome, VERDICTS, SUMMARY, ([row], drawn(outcome)))
    text = page(outcome)
    assert "with and without the compensation" in text
    assert text.index('alt="Compensation"') < text.index('alt="Some figure"')
    numbers = "".join(f'<td class="n">{each}</td>' for each in ("0.1235", "0", "7"))
    assert f"<tr><td>held</td><td>with it</td>{numbers}</tr>" in text
    assert (outcome.folder / "compensation.png").read_bytes().startswith(PNG)


@pytest.mark.parametrize(("value", "text"), [
    (None, "–"), (0.0, "0"), (9e-10, "0"), (-9e-10, "0"), (1e-9, "1e-09"), (1.1e-9, "1.1e-09"), (-2.0, "-2"),
    (123.456, "123.5"),
])  # fmt: skip
def test_a_number_for_people_has_four_figures(value: float | None, text: str) -> None:
    assert html._figure(value) == text


def test_figures_have_one_width_unless_told_and_quiet_axes() -> None:
    figure = style.new_figure(3.0)
    assert tuple(figure.get_size_inches()) == (9.6, 3.0)
    assert tuple(style.new_figure(3.0, 5.0).get_size_inches()) == (5.0, 3.0)
    view: Any = style.axes(figure, 2, 3, 4, "time, s", "error")
    assert view.get_subplotspec().get_geometry() == (2, 3, 3, 3)
    wide: Any = style.axes(figure, 2, 3, (1, 2))
    assert wide.get_subplotspec().get_geometry() == (2, 3, 0, 1)
    assert (view.get_xlabel(), view.get_ylabel(), wide.get_xlabel(), wide.get_ylabel()) == (
        "time, s", "error", "", "",
    )  # fmt: skip
    shown = {name: spine.get_visible() for name, spine in view.spines.items()}
    assert shown == {"left": True, "bottom": True, "top": False, "right": False}
    assert view.get_axisbelow() is True
    assert all(line.get_visible() for line in view.get_xgridlines())
    assert [label.get_fontsize() for label in (view.xaxis.label, view.yaxis.label)] == [9, 9]
    assert {tick.get_fontsize() for tick in view.get_xticklabels()} == {8}
    style.title(view, "what it is")
    assert (view.get_title(loc="left"), view.get_title()) == ("what it is", "")


@pytest.mark.parametrize(("rows", "points", "most"), [(100, 4000, 100), (100_000, 4000, 4000), (100, 10, 10)])
def test_no_peak_is_lost_among_few_points(rows: int, points: int, most: int) -> None:
    t = np.arange(float(rows))
    values = np.zeros(rows)
    values[rows // 3], values[rows // 2] = 5.0, -7.0
    thin_t, thin_values = style.thin(t, values, points)
    assert most / 2 < len(thin_t) == len(thin_values) <= most
    assert (thin_values.max(), thin_values.min()) == (5.0, -7.0)
    assert thin_t[thin_values.argmax()] == rows // 3
    assert np.diff(thin_t).min() >= 0.0


def test_four_thousand_points_are_usual_and_half_of_two_thousand_rows_are_not_thinned() -> None:
    for rows, count in ((4000, 4000), (12_000, 4000), (2, 2)):
        assert len(style.thin(np.arange(float(rows)), np.arange(float(rows)))[0]) == count
