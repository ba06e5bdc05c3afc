"""Options of `schmidt paper` and `schmidt objective`: what they are by themselves, and their bounds."""

from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner

from scenarios.options import filled
from scenarios.studies.options import ObjectiveOptions, PaperOptions


def asked(record: Any, *words: str) -> Any:
    """The record of these words; a text that says what is wrong."""
    found: list[Any] = []
    done = CliRunner().invoke(click.command()(filled(record)(found.append)), list(words))
    return found[0] if done.exit_code == 0 else done.output


def test_the_paper_is_repeated_from_its_own_starts() -> None:
    found = asked(PaperOptions)
    assert found == PaperOptions()
    assert (found.json_file, found.out, found.rows) == (None, Path("out/paper"), None)
    assert (found.quick, found.others, found.vary) == (False, 0, 0.0)
    assert (found.plant, found.plant_high) == ("low_preload_bridge", "high_preload_bridge")
    assert asked(PaperOptions, "--quick", "--json", "x.json").quick is True


def test_the_objective_is_held_from_eight_starts_for_ten_minutes() -> None:
    found = asked(ObjectiveOptions)
    assert found == ObjectiveOptions()
    assert (found.starts, found.seeds, found.shift, found.seconds) == (8, 3, 0.0, 600.0)
    assert (found.compensation, found.only, found.steps) == (None, None, False)
    assert asked(ObjectiveOptions, "--steps").steps is True


@pytest.mark.parametrize(("record", "option", "low", "high", "beyond"), [
    (PaperOptions, "others", "0", "1000", ("-1", "1001")),
    (PaperOptions, "vary", "0", "50", ("-0.1", "50.1")),
    (PaperOptions, "jobs", "1", "1024", ("0", "1025")), (ObjectiveOptions, "starts", "1", "64", ("0", "65")),
    (ObjectiveOptions, "seeds", "1", "16", ("0", "17")),
    (ObjectiveOptions, "shift", "-360", "360", ("-360.5", "360.5")),
    (ObjectiveOptions, "seconds", "1", "1000000", ("0.9", "1000000.1")),
])  # fmt: skip
def test_numbers_have_bounds(record: Any, option: str, low: str, high: str, beyond: tuple[str, str]) -> None:
    for good in (low, high):
        assert getattr(asked(record, f"--{option}", good), option) == float(good)
    for bad in beyond:
        assert "is not in the range" in asked(record, f"--{option}", bad)
