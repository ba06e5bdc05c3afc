"""The worked example: the seal is the one the page names, and the finder's answer is what was sealed."""

import hashlib
import inspect
import json
import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.report import pictures
from plant.gears import ORDERS as STAGES
from plant.loop import Excitation, simulate
from plant.model import load

HERE = Path(__file__).resolve().parents[2] / "docs" / "example"
TRUTH: dict[str, Any] = json.loads((HERE / "truth.json").read_text(encoding="utf-8"))


def test_seal_is_the_one_the_page_names() -> None:
    digest = hashlib.sha256((HERE / "truth.json").read_bytes()).hexdigest()
    assert digest in (HERE / "README.md").read_text(encoding="utf-8")


def test_logs_are_those_that_were_sealed() -> None:
    found = {f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in HERE.glob("*.csv")}
    assert found == TRUTH["logs_sha256"]


def test_example_is_small() -> None:
    assert sum(f.stat().st_size for f in HERE.glob("*.csv")) <= 1_500_000
    assert all(f.stat().st_size <= 150_000 for f in HERE.glob("*.png"))


def test_the_pages_pictures_are_found_by_captions_that_a_report_has() -> None:
    page = runpy.run_path(str(HERE / "page.py"))
    drawn = inspect.getsource(pictures)
    assert all(f'"{caption}' in drawn for caption in page["PICTURES"])


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    out = tmp_path_factory.mktemp("example")
    calibrate(sorted(HERE.glob("*.csv")), out=out, plots=False)
    return json.loads((out / "report.json").read_text(encoding="utf-8")), out / "plant.yaml"


@pytest.mark.slow
def test_finder_names_what_was_sealed_and_nothing_else(answer: tuple[dict[str, Any], Path]) -> None:
    report, _ = answer
    assert report["verdict"] == "found"
    names = [(e["name"], e["stage"], e["harmonic"]) for e in report["effects"]]
    assert names == [(TRUTH["effect"], TRUTH["stage"], TRUTH["harmonic"])]
    found = report["effects"][0]["parameters"]["amplitude"]["value"]
    assert found == pytest.approx(TRUTH["parameters"]["amplitude"]["value"], rel=0.05)


@pytest.mark.slow
def test_the_page_of_formats_lists_the_fields_of_a_report(answer: tuple[dict[str, Any], Path]) -> None:
    table = (
        (HERE.parent / "sources" / "log-format.md").read_text(encoding="utf-8").partition("## report.json")[2]
    )
    cells = re.findall(r"^\| (`.+?`) \|", table, re.MULTILINE)
    of_effects = [c.replace("effects[].", "") for c in cells if "effects[]." in c]
    top = {name for c in cells if "effects[]." not in c for name in re.findall(r"`(\w+)`", c)}
    report = answer[0]
    assert top >= set(report) and top - set(report) <= {"closed_loop"}
    inner = {name for c in of_effects for name in re.findall(r"`(\w+)`", c)}
    assert inner >= set(report["effects"][0]) and inner - set(report["effects"][0]) <= {"curve"}


@pytest.mark.slow
def test_held_out_error_falls_towards_the_floor(answer: tuple[dict[str, Any], Path]) -> None:
    torque = answer[0]["error"]["torque"]
    assert torque["after"] <= 0.5 * torque["before"]  # what is asked for
    # beyond two floors the report itself says that something is still missing; the floor is measured apart
    # from the fit (it was the fit's own residual when this was 1.5)
    assert torque["floor"] <= torque["after"] <= 2.0 * torque["floor"]


@pytest.mark.slow
def test_page_tells_the_figures_of_the_report(answer: tuple[dict[str, Any], Path]) -> None:
    text = (HERE / "README.md").read_text(encoding="utf-8")
    row = re.search(r"\| ([\d.]+) N m before, \*\*([\d.]+) N m\*\* after, floor ([\d.]+) N m", text)
    assert row is not None
    torque = answer[0]["error"]["torque"]
    for told, key in zip(row.groups(), ("before", "after", "floor"), strict=True):
        assert float(told) == pytest.approx(torque[key], rel=0.05, abs=0.01), key


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "pattern"),
    [
        ("README.md", r"amplitude of (?P<found>[\d.]+) N m.*?falls\s+to (?P<after>[\d.]+) N m"),
        (
            "docs/guides/calibrate-a-log.md",
            r"torque error, N m \| (?P<before>[\d.]+) \| (?P<after>[\d.]+) \|",
        ),
    ],
)
def test_other_pages_tell_the_same_figures(
    answer: tuple[dict[str, Any], Path], page: str, pattern: str
) -> None:
    text = (HERE.parents[1] / page).read_text(encoding="utf-8")
    told = re.search(pattern, text, re.DOTALL)
    assert told is not None
    report = answer[0]
    torque = report["error"]["torque"]
    found = report["effects"][0]["parameters"]["amplitude"]["value"]
    values = {"found": found, "before": torque["before"], "after": torque["after"]}
    for name, figure in told.groupdict().items():
        assert float(figure) == pytest.approx(values[name], rel=0.05), name


@pytest.mark.slow
def test_corrected_plant_carries_the_sealed_torque_and_runs(answer: tuple[dict[str, Any], Path]) -> None:
    model = load(answer[1])
    (made,) = [e for e in model.axes.ra.effects if e.name == TRUTH["effect"] and e.stage == TRUTH["stage"]]
    angle = np.linspace(0.0, 2 * np.pi / STAGES[TRUTH["stage"]], 200)

    def torque(amplitude: float, phase: float) -> np.ndarray:
        return amplitude * np.sin(STAGES[TRUTH["stage"]] * TRUTH["harmonic"] * angle + phase)

    sealed = torque(*(TRUTH["parameters"][k]["value"] for k in ("amplitude", "phase")))
    fitted = torque(*(made.parameters[k].si for k in ("amplitude", "phase")))
    assert np.abs(fitted - sealed).max() < 0.1 * np.abs(sealed).max()
    log = simulate(model, "ra", 2.0, Excitation(setpoint=600.0))
    assert np.mean(log.velocity[-50:]) == pytest.approx(600.0 * 0.005 / 0.0114796, rel=0.05)
