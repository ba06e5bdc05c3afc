"""Journal, table and sensitivity: nothing is lost, nothing counted twice, intervals hold what they should."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex

from scenarios.campaign import figures, table
from scenarios.campaign.figures import influence, share
from scenarios.language.document import ScenarioError
from scenarios.run.report.style import COLOURS


def row(key: str, index: int = 0, **more: object) -> dict[str, object]:
    return {"key": key, "index": index, "failure": "", **more}


def test_a_torn_line_and_a_lost_run_are_made_again(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path, resume=False)
    journal.add(row("a", value=1.0))
    journal.add(row("b", lost=True))
    journal.close()
    with (tmp_path / table.JOURNAL).open("a") as file:
        file.write('{"key": "c", "ind')
    again = table.Journal(tmp_path, resume=True)
    assert again.done == {"a"}
    again.add(row("b", 1, value=2.0))
    again.add(row("c", 2, value=3.0))
    again.close()
    found = table.read(table.write(tmp_path))
    assert dict(zip(found["key"], found["value"], strict=True)) == {"a": 1.0, "b": 2.0, "c": 3.0}


def test_a_torn_line_swallows_no_run_of_a_new_campaign(tmp_path: Path) -> None:
    (tmp_path / table.JOURNAL).write_text('{"key": "c", "ind')
    journal = table.Journal(tmp_path, resume=False)
    journal.add(row("a", value=1.0))
    journal.close()
    assert [each["key"] for each in table.rows(tmp_path / table.JOURNAL)] == ["a"]


@pytest.mark.parametrize(
    "line",
    [
        b"{}",
        b"[" * 100_000,
        b'{"key": 3}',
        b'{"key": "d", "index": "e"}',
        b'{"key": "d", "index": true, "failure": ""}',
        b"[]",
        b"\xff",
        b'{"key": "d", "index": 1, "failure": "", "x": [1]}',
        b'{"key": "d", "index": 1, "failure": "", "x": 1e999}'.replace(b"1e999", b"9" * 40),
    ],
)
def test_a_line_that_is_no_run_is_left_out(line: bytes, tmp_path: Path) -> None:
    (tmp_path / table.JOURNAL).write_bytes(line + b"\n")
    journal = table.Journal(tmp_path, resume=True)
    assert journal.done == set()
    journal.add(row("a", value=1.0))
    journal.close()
    assert table.read(table.write(tmp_path))["key"] == ["a"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_a_full_disk_names_the_journal(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path, resume=False)
    journal.close()
    journal._file = Path("/dev/full").open("a")  # noqa: SIM115 - closed below
    with pytest.raises(ValueError, match=r"runs\.jsonl: No space left on device; --resume"):
        journal.add(row("a"))
    journal.close()


def test_a_folder_with_runs_is_not_gone_on_with_by_accident(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path, resume=False)
    journal.add(row("a"))
    journal.close()
    with pytest.raises(ScenarioError, match="--resume"):
        table.Journal(tmp_path, resume=False)


def test_columns_take_what_all_rows_need(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path, resume=False)
    journal.add(row("a", one=1, two=None, three=True))
    journal.add(row("b", one=2.5, two="text", three=False))
    journal.close()
    found = table.read(table.write(tmp_path))
    assert found["one"] == [1.0, 2.5]
    assert found["two"] == [None, "text"]
    assert found["three"] == [True, False]


@pytest.mark.parametrize("runs", [8, 20, 100])
@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_the_interval_of_a_rank_correlation_holds_the_truth_as_often_as_it_says(
    runs: int, rho: float
) -> None:
    """Bivariate normal numbers: Spearman's is 6/pi asin(rho/2) there (Pearson 1907)."""
    held, cases = 0, 200
    truth = 6.0 / np.pi * np.arcsin(rho / 2.0)
    random = np.random.default_rng(5)
    for _ in range(cases):
        x = random.normal(size=runs)
        y = rho * x + np.sqrt(1 - rho**2) * random.normal(size=runs)
        found = influence("x", x, "y", np.exp(y))
        assert found is not None
        held += found.low <= truth <= found.high
    assert held / cases > 0.88  # 95 % +- four standard deviations of 200 cases


def test_runs_in_the_very_same_order_have_a_correlation_of_one() -> None:
    x = np.arange(20.0)
    for sign in (1.0, -1.0):
        found = influence("x", x, "y", sign * x**3)
        assert found is not None
        assert (found.value, found.low, found.high) == pytest.approx((sign, sign, sign))


def test_too_little_to_say_is_nothing_said() -> None:
    x = np.arange(20.0)
    assert influence("x", x, "y", np.ones(20)) is None
    assert influence("x", x[:5], "y", x[:5]) is None
    assert influence("x", x, "y", np.full(20, np.nan)) is None


def test_shares_have_wilsons_interval() -> None:
    """Wilson (1927) for 8 of 10, as in every textbook: 0.4902 to 0.9433."""
    value, low, high = share(8, 10)
    assert value == 0.8
    assert (low, high) == pytest.approx((0.4902, 0.9433), abs=5e-4)


def test_a_bar_of_runs_beyond_the_limit_is_red_also_the_last_one() -> None:
    """The axis ends at the 99.5 % quantile; runs beyond it are in the last bar."""
    figure = figures.distributions(
        {"metric: a": [0.1] * 300 + [5.0, 50.0]}, ["metric: a"], {"a": (1.0, True)}, {"a": "arcsec"}
    )
    assert figure is not None and figure.axes[0].get_xlabel() == "arcsec"
    bars: Any = [bar for bar in figure.axes[0].patches if bar.get_height() > 0]
    assert [bar.get_height() for bar in bars] == [300, 2]
    assert [to_hex(bar.get_facecolor()) == COLOURS["bad"] for bar in bars] == [False, True]
