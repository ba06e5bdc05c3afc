"""The emulator's own logs, as a run leaves them: nothing beyond the plant's file, or the effect that
was added."""

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from calibration.command import calibrate
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.plants import plant_model
from scenarios.run import run as runner

#: arcsec/s, s: both directions, speeds on both sides of the Stribeck speed, tens of degrees, small reversals
RATES = [
    (15, 16),
    (-15, 14),
    (60, 10),
    (-60, 10),
    (200, 10),
    (-200, 10),
    (600, 10),
    (-600, 10),
    (3600, 8),
    (-3600, 8),
    (7200, 12),
    (-7200, 12),
    (30, 4),
    (-30, 4),
    (30, 4),
    (-30, 4),
    (1500, 6),
    (-1500, 6),
    (5400, 10),
    (-5400, 10),
]


def manoeuvre(folder: Path, plant: str, effects: list[dict[str, Any]]) -> Path:
    """Run both axes through RATES on a plant with added effects; returns the run's folder."""
    steps: list[dict[str, Any]] = [{"power_on": {}}, {"name": "start", "wait": {"for": "0.1 s"}}]
    before = "start"
    for k, (rate, time) in enumerate(RATES):
        arguments = {"rate": f"{rate} arcsec/s", "for": f"{time} s"}
        steps.append({"name": f"ra{k}", "set_rate": {"axis": "ra", **arguments}})
        steps.append({"name": f"dec{k}", "set_rate": {"axis": "dec", **arguments}, "after": before})
        before = f"dec{k}"
    steps += [{"wait": {"for": "1 s"}}, {"stop": {"axis": "both"}}]
    text = yaml.safe_dump(
        {
            "name": "Calibration",
            "plant": {"file": plant, "effects": effects},
            "start_utc": "2026-02-10T14:00:00Z",
            "steps": steps,
        }
    )
    scenario = convert(parse(text, folder / "test.yaml"))
    runner.run(scenario, plant_model(scenario.plant, folder), folder, lambda *_: None)
    return folder


def verdict(folder: Path, axis: str) -> dict[str, Any]:
    """Calibrate one axis' log; returns report.json."""
    out = folder / f"calibrated-{axis}"
    assert calibrate([folder / f"axis-{axis}.csv"], out=out, plots=False) == 0
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    return report


@pytest.fixture(scope="module")
def low(tmp_path_factory: pytest.TempPathFactory) -> Path:
    added = [{"name": "gravity_imbalance", "axis": "dec"}]
    return manoeuvre(tmp_path_factory.mktemp("low"), "low-preload", added)


@pytest.fixture(scope="module")
def high(tmp_path_factory: pytest.TempPathFactory) -> Path:
    added = [{"name": "supply_sag", "axis": "ra", "parameters": {"resistance": 0.4}}]
    return manoeuvre(tmp_path_factory.mktemp("high"), "high-preload", added)


@pytest.mark.long
def test_nothing_is_found_on_the_declared_plant_low_preload(low: Path) -> None:
    report = verdict(low, "ra")
    assert report["verdict"] == "nothing", report["effects"]
    assert report["error"]["torque"]["after"] == report["error"]["torque"]["before"]


@pytest.mark.long
def test_nothing_is_found_on_the_declared_plant_high_preload_declination(high: Path) -> None:
    report = verdict(high, "dec")
    assert report["verdict"] == "nothing", report["effects"]


@pytest.mark.long
def test_an_added_imbalance_is_named_with_its_size(low: Path) -> None:
    report = verdict(low, "dec")
    first = report["effects"][0]
    assert (first["name"], first["stage"], first["channel"]) == ("gravity_imbalance", "axis", "T")
    assert first["parameters"]["amplitude"]["value"] == pytest.approx(
        40.0, rel=0.1
    )  # N m, the effect's default
    assert report["error"]["torque"]["after"] < 0.2 * report["error"]["torque"]["before"]
    assert not {e["name"] for e in report["effects"][1:]} - {"unknown"}


@pytest.mark.long
def test_an_added_supply_sag_is_named_beside_the_ripple_of_the_current(high: Path) -> None:
    report = verdict(high, "ra")
    # A wind of less than a newton metre may be named beside it, too (docs/reference/calibration.md).
    assert report["effects"][0]["name"] == "supply_sag"
    assert {e["name"] for e in report["effects"][1:]} <= {"wind_torque"}
    assert report["effects"][0]["parameters"]["resistance"]["value"] == pytest.approx(0.4, rel=0.25)
