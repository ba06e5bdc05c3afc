"""What works with the base installation alone, and how a missing extra is answered."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from scenarios.options import advice, need
from tests.scenarios.commands.base import closure

ROOT = Path(__file__).parents[3]
WORKSHOP = {"all", "test", "kit", "bench", "compiled", "wheels", "docs", "coverage", "cluster"}
"""Extras that `all` leaves out: for those who change schmidt, and for clusters."""
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def schmidt(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "tests.scenarios.commands.base", *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_the_base_is_small() -> None:
    assert len(PROJECT["dependencies"]) <= 12


def test_the_base_brings_no_web_server_no_plots_and_no_tables() -> None:
    brought = closure("schmidt")
    assert {"numpy", "python-can", "llvmlite"} <= brought
    assert not brought & {"scipy", "pyarrow", "matplotlib", "nicegui", "starlette", "canopen", "pandas"}


def test_all_brings_every_extra_of_a_user() -> None:
    extras = PROJECT["optional-dependencies"]
    users = set(extras) - WORKSHOP
    assert users >= {"parquet", "plots", "firmware", "fmu", "recordings"}
    names = {
        re.split("[>=<]", line)[0]
        for each in users
        for line in extras[each]
        if not line.startswith("schmidt")
    }
    assert names <= closure("schmidt", frozenset({"all"}))


@pytest.mark.parametrize(
    ("words", "extra", "package"),
    [
        (("run", "quick-look"), "parquet", "pyarrow>=15"),
        (("calibrate", "log.csv", "--out", "out"), "calibrate", "scipy>=1.12"),
        (("serve", "--alpaca", "0"), "alpaca", "uvicorn>=0.30"),
        (("serve", "--console", "0"), "consoles", "nicegui>=3.0"),
        (("eds", "out"), "canopen", "canopen>=2.3"),
        (("campaign", "file.yaml", "--out", "out"), "calibrate", "scipy>=1.12"),
        (("export", "run", "--mcap", "out.mcap"), "recordings", "mcap>=1.2"),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_a_missing_extra_is_one_line_with_the_command(
    tmp_path: Path, words: tuple[str, ...], extra: str, package: str
) -> None:
    done = schmidt(tmp_path, *words)
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.splitlines()
    assert f"(extra {extra}); {sys.executable} -m pip install " in line
    assert f'"{package}"' in line
    assert not list(tmp_path.iterdir())  # nothing was begun


@pytest.mark.slow
def test_boards_are_checked_and_served_with_the_base_alone(tmp_path: Path) -> None:
    done = schmidt(tmp_path, "conformance", "--board", "axis:0x11")
    assert done.returncode == 0, done.stdout + done.stderr
    doors = ["--serial", "pty:ports", "--hid", "unix:usb.sock", "--lx200", "pty:lx200"]
    done = schmidt(tmp_path, "serve", *doors, "--duration", "1")
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_part_of_a_user_is_answered_with_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.options.find_spec", lambda name: None)
    for extra in (set(PROJECT["optional-dependencies"]) - WORKSHOP) | {"cluster"}:
        with pytest.raises(ValueError, match=rf"\(extra {extra}\); .* -m pip install "):
            need(extra)
    assert "(extra firmware)" in advice("cffi")  # what needs a C compiler is asked for when it is imported


def test_what_is_installed_needs_nothing() -> None:
    need("parquet", "plots", "calibrate", "all")
    assert advice("numpy") == ""


def test_an_extra_that_is_missing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.options.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"^not installed: matplotlib, jinja2 \(extra plots\)"):
        need("plots")
