"""`schmidt calibrate` on a run over the stars: what it writes, what it says, what it does not take."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from host.sky.pointmodel import parsed
from scenarios.cli import cli
from tests.host.sky.test_pointing_find import run
from tests.host.sky.test_pointing_read import STAR, tpoint


def test_a_missing_term_is_told_and_written(tmp_path: Path) -> None:
    stars = tmp_path / "stars.dat"
    stars.write_text(tpoint(run(7200, "TF")))
    done = CliRunner().invoke(cli, ["calibrate", str(stars), "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("found: TF; ")
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["verdict"] == "found"
    (effect,) = report["effects"]
    size = effect["parameters"]["coefficient"]
    assert effect["name"] == "TF" and size["low"] < size["value"] < size["high"]
    error = report["error"]["pointing"]
    assert error["after"] < error["before"] and error["floor"] is None
    file = tmp_path / "out" / "pointing-model.json"
    terms = {each.name: each.arcsec for each in parsed(file.read_text(), file).terms}
    assert terms["TF"] == size["value"]
    assert (tmp_path / "out" / "pointing-run.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("words", [["--hold-out", "a"], ["--plant", "p.yaml"], ["two.dat"]])
def test_what_is_of_drives_is_refused(tmp_path: Path, words: list[str]) -> None:
    stars = tmp_path / "stars.dat"
    stars.write_text("x\n")
    done = CliRunner().invoke(cli, ["calibrate", str(stars), *words, "--out", str(tmp_path)])
    assert done.exit_code == 2 and "a pointing run is calibrated alone" in done.output


def test_a_table_of_a_drive_may_be_called_dat(tmp_path: Path) -> None:
    log = tmp_path / "log.dat"
    log.write_text("t x\n0 1\n")
    words = ["calibrate", str(log), "--rig", str(tmp_path / "none.yaml"), "--out", str(tmp_path)]
    assert "none.yaml" in str(CliRunner().invoke(cli, words).exception)


def test_a_term_of_geometry_is_missing_where_it_is_not_declared(tmp_path: Path) -> None:
    stars = tmp_path / "stars.dat"
    stars.write_text(tpoint(run(7201, ratio=0.0)))
    words = ["calibrate", str(stars), "--terms", "IH,ID,CH,MA,ME", "--out", str(tmp_path)]
    done = CliRunner().invoke(cli, words)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("found: NP; ")
    done = CliRunner().invoke(cli, [*words[:3], "IH,XX", *words[4:]])
    assert str(done.exception).startswith("--terms: no term is called 'XX'; there are IH, ID, ")
    done = CliRunner().invoke(cli, ["calibrate", "log.csv", "--terms", "IH", "--out", str(tmp_path)])
    assert done.exit_code == 2 and "--terms is for a pointing run" in done.output


def test_too_few_stars_are_one_line(tmp_path: Path) -> None:
    stars = tmp_path / "stars.dat"
    stars.write_text(f"x\n29 22 00 2026 03 03\n{STAR}\n")
    done = CliRunner().invoke(cli, ["calibrate", str(stars), "--out", str(tmp_path)])
    assert str(done.exception) == "a pointing model needs 6 stars, there are 1"
