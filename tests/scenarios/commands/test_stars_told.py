"""What `schmidt calibrate STARS` tells and writes of an answer that is written down here."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from host.sky.pointfind import Answer, Lack
from host.sky.pointmodel import GEOMETRY, TEXTS, PointingModel, Term
from scenarios.commands import stars

MODEL = PointingModel(
    latitude_rad=0.8, stars=40, before_arcsec=90.0, after_arcsec=4.0, held_out_arcsec=5.0,
    terms=(
        Term(name="IH", arcsec=12.34, within_arcsec=1.25), Term(name="TF", arcsec=-8.0, within_arcsec=0.5)
    ),
)  # fmt: skip
TERM = Lack(name="TF", equivalent=("TX",), over=None, arcsec=-8.0, within_arcsec=0.5)
UNKNOWN = Lack(name="unknown", equivalent=(), over="hour angle", arcsec=7.25, within_arcsec=None)


def answer(*lacks: Lack, **more: Any) -> Answer:
    usual: dict[str, Any] = {"unseen_arcsec": {}, "confounded": ()}
    return Answer(
        verdict="found", lacks=lacks, model=MODEL, before_arcsec=20.0, after_arcsec=5.0, **usual | more
    )


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Any:
    """Lines of the command for an answer."""
    monkeypatch.setenv("COLUMNS", "40")  # a pipe has no width
    monkeypatch.setattr(stars, "read", lambda path: f"stars of {path}")
    monkeypatch.setattr(stars, "residuals", lambda found, model: Figure())

    def lines(found: Answer, terms: str | None = None) -> list[str]:
        def find(read: str, declared: tuple[str, ...]) -> Answer:
            assert (read, declared) == ("stars of s.dat", expected)
            return found

        expected = GEOMETRY if terms is None else ("IH", "ID")
        monkeypatch.setattr(stars, "find", find)
        assert stars.calibrate_stars(Path("s.dat"), terms, tmp_path) == 0
        return [line.rstrip() for line in capsys.readouterr().out.splitlines()]

    return lines


class Figure:
    def savefig(self, path: Path) -> None:
        path.write_text("figure")


ERRORS = "20.00″ before, 5.00″ after, on stars held out"


def test_files_are_written_beside_each_other(told: Any, tmp_path: Path) -> None:
    told(answer(TERM))
    assert (tmp_path / "pointing-run.png").read_text() == "figure"
    assert '"TF"' in (tmp_path / "pointing-model.json").read_text()
    text = (tmp_path / "report.json").read_text()
    assert text.startswith('{\n "verdict": "found",\n') and text.endswith("}\n")
    assert json.loads(text) == json.loads(json.dumps(stars.report(answer(TERM), GEOMETRY)))


def test_a_report_has_a_size_with_its_interval() -> None:
    """8 within half a second is -8.5 to -7.5. What no term explains has an rms alone."""
    found = stars.report(answer(TERM, UNKNOWN, confounded=("NP",), unseen_arcsec={"CH": 3.5}), GEOMETRY)
    term, unknown = found["effects"]
    size = {"value": -8.0, "unit": "arcsec", "low": -8.5, "high": -7.5}
    assert term == {"name": "TF", "equivalent": ["TX"], "domain": None, "parameters": {"coefficient": size}}
    rms = {"value": 7.25, "unit": "arcsec", "low": None, "high": None}
    assert unknown["parameters"] == {"rms": rms} and unknown["domain"] == "hour angle"
    assert list(found["calibrated"]) == ["IH"]
    size = {"value": 12.34, "unit": "arcsec", "low": 11.09, "high": 13.59}
    assert found["calibrated"]["IH"] == pytest.approx(size)
    assert found["error"]["pointing"] == {"unit": "arcsec", "before": 20.0, "after": 5.0, "floor": None}
    assert found["not_identifiable"] == ["NP"]
    assert found["unseen_below"] == {"CH": {"value": 3.5, "unit": "arcsec"}}


def test_terms_and_what_is_unknown_are_told(told: Any, tmp_path: Path) -> None:
    first, head, *rows, last = told(answer(TERM, UNKNOWN))
    assert first == f"found: TF or TX and something over the hour angle; {ERRORS}"
    assert head.split() == ["term", "what", "size", "(95", "%", "interval)"] and head.startswith("term")
    assert [row.split()[0] for row in rows] == ["IH", "TF", "unknown"]
    assert rows[0].endswith("+12.3″ ± 1.2″") and TEXTS["IH"] in rows[0] and "(missing)" not in rows[0]
    assert rows[1].startswith("TF (missing)") and rows[1].endswith("-8.0″ ± 0.5″")
    assert "over the hour angle" in rows[2] and rows[2].endswith("7.2″ rms")
    file = tmp_path / "pointing-model.json"
    assert last == f"Next: mount: {{pointing_model: {file}}} in a scenario"


def test_nothing_missing_is_told(told: Any) -> None:
    """Terms may be declared, blanks between them."""
    first, _, *rows, _ = told(answer(), "IH, ID")
    assert first == f"found: no term is missing; {ERRORS}"
    assert [row.split()[0] for row in rows] == ["IH", "TF"]


def test_what_cannot_be_seen_is_told_in_one_line(told: Any, tmp_path: Path) -> None:
    """However many there are, and with the names as they are."""
    names = [f"[b]:star:T{k:02}" for k in range(20)]
    lines = told(answer(unseen_arcsec=dict.fromkeys(names, 3.14), confounded=tuple(names)))
    assert lines[-3] == f"Not seen, and smaller than: {', '.join(f'{name} 3.1″' for name in names)}"
    assert lines[-2] == f"These stars cannot tell from the others: {', '.join(names)}"


def test_a_long_line_is_not_broken(told: Any) -> None:
    over = replace(UNKNOWN, over="h" * 120)
    assert told(answer(over))[0] == f"found: something over the {'h' * 120}; {ERRORS}"


def test_a_term_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^--terms: no term is called 'XX'; there are IH, ID, "):
        stars.calibrate_stars(Path("s.dat"), "IH,XX", Path("out"))
