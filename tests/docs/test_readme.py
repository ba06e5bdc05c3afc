"""README stays short, and its quick start shows what the night prints."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.doors.process import PROGRAM, ROOT

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
MOST_LINES, MOST_WORDS, MOST_NUMBERS = 120, 900, 4.0  # numbers: per 100 words


def test_it_is_read_in_five_minutes() -> None:
    words = len(TEXT.split())
    assert TEXT.count("\n") <= MOST_LINES
    assert words <= MOST_WORDS
    assert 100 * len(re.findall(r"\d[\d.,]*", TEXT)) <= MOST_NUMBERS * words


def test_a_picture_stands_before_the_first_heading() -> None:
    assert "![" in TEXT.partition("\n## ")[0]


def test_the_two_set_up_commands_come_first() -> None:
    commands = re.findall(r"^    (\w+ \w+)", TEXT, re.MULTILINE)
    assert commands[:2] == ["make run", "make test"]


def test_the_extras_of_a_user_are_named() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "optional-dependencies"
    ]
    workshop = {"all", "test", "kit", "bench", "compiled", "wheels", "docs", "coverage"}
    listed = re.search(r"Extras: (.*?)\.\n", TEXT, re.DOTALL)
    assert listed and set(re.findall(r"`(\w+)`", listed[1])) == set(extras) - workshop


def test_the_pictures_are_those_of_the_drive_and_of_the_console() -> None:
    shown = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", TEXT)
    assert {Path(name).name for name in shown} >= {"overview.svg", "main.png", "residual.png"}


@pytest.mark.slow
def test_the_night_prints_what_the_quick_start_shows(tmp_path: Path) -> None:
    shown = re.findall(r"^    (ok   .*)$", TEXT, re.MULTILINE)
    words = ["run", "scenarios/observing-night.yaml", "--no-report", "--out", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words], cwd=ROOT, capture_output=True, text=True, check=True
    )
    printed = done.stdout.splitlines()
    assert len(shown) == 2
    assert set(shown) <= set(printed)
    assert re.match(r"[\d.]+ s simulated at [\d.]+ times real time, digest \w+", printed[-1])
