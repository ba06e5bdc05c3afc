"""The harness: seals before the finder runs, resumes, refuses a broken seal; a small deterministic run for
CI."""

import json
import os
import sys
from pathlib import Path

import pytest

from tests.blind import finder, harness
from tests.blind.sealer import cells
from tests.blind.sealer.case import Order

CALLS: list[list[str]] = []
ORDERS = [Order("a", "nothing", "pure"), Order("b", "single", "mixed", ("sample_loss",), 5.0)]


def says_nothing() -> None:
    """A finder that always answers "nothing"."""
    CALLS.append(sys.argv[1:])
    out = Path(sys.argv[sys.argv.index("--out") + 1])
    (out / "report.json").write_text(
        json.dumps({"verdict": "nothing", "effects": [], "error": {}, "calibrated": {}})
    )


def breaks() -> None:
    """A finder with a bug."""
    raise RuntimeError("no idea")


@pytest.mark.slow
def test_seal_find_open_score_and_resume(tmp_path: Path) -> None:
    CALLS.clear()
    command = f"{__name__}:says_nothing"
    results = harness.run(ORDERS, 1004, tmp_path, 1, command)
    assert [row["right"] for row in results["cases"]] == [True, False]
    assert len(CALLS) == 2
    assert not any("truth" in word for call in CALLS for word in call)
    assert set(json.loads((tmp_path / "seals.json").read_text())) == {"a", "b"}
    again = harness.run(ORDERS, 1004, tmp_path, 1, command)
    assert len(CALLS) == 2
    assert again["cases"] == results["cases"]
    assert "| figure | must | aim |" in (tmp_path / "blind.md").read_text()

    truth = tmp_path / "truth" / "b.json"
    truth.write_text(truth.read_text().replace('"seed": 1004', '"seed": 1005'))
    with pytest.raises(harness.SealBroken, match=r"b\.json"):
        harness.run(ORDERS, 1004, tmp_path, 1, command)


def test_a_finder_that_breaks_is_a_case_without_an_answer(tmp_path: Path) -> None:
    answer = finder.find(tmp_path, tmp_path / "out", f"{__name__}:breaks")
    assert "no idea" in answer["failure"]


def dies() -> None:
    """A finder that takes its process with it."""
    os._exit(3)


@pytest.mark.slow
def test_a_finder_whose_process_dies_is_a_case_without_an_answer(tmp_path: Path) -> None:
    results = harness.run(ORDERS, 1004, tmp_path, 2, f"{__name__}:dies")
    assert [row["answered"] for row in results["cases"]] == [False, False]


@pytest.mark.long
def test_small_deterministic_subset(tmp_path: Path) -> None:
    """The real finder on ten logs of a development seed: an answer to each, no name where there is
    nothing."""
    pytest.importorskip("calibration.command", reason="the finder is not built yet")
    results = harness.run(cells.quick(), 1900, tmp_path, 1)
    rows = {row["key"]: row for row in results["cases"]}
    failures = {key: row["failure"] for key, row in rows.items() if not row["answered"]}
    assert not failures
    assert [row["named"] for row in rows.values() if row["cell"] == "nothing"] == [0, 0]
    single = [row for row in rows.values() if row["cell"] == "single"]
    assert sum(row["right"] for row in single) >= 0.9 * len(single) - 1
    assert not [key for key, row in rows.items() if row["worse"]]
