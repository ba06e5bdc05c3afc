"""Rate errors out of an axis log made by hand: which rows count, and over what they are averaged."""

from pathlib import Path

import numpy as np
import pytest

from host.rates import rate_arcsec_s
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.programme import Record
from scenarios.run import errors
from scenarios.run.outcome import Outcome

RATE = 15.0
SCENARIO = convert(
    parse(
        f"""\
name: by hand
start_utc: 2026-02-10T14:00:00Z
steps:
  - set_rate: {{axis: ra, rate: {RATE} arcsec/s, for: 10 s}}
""",
        Path("hand.yaml"),
    )
)


@pytest.fixture(scope="module")
def counted(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """An axis that is k counts too quick during its second k; rows come every 10 ms."""
    folder = tmp_path_factory.mktemp("counted")
    t = np.arange(1000) * 0.01
    counts = RATE / rate_arcsec_s(1.0) + np.arange(1000) // 100
    rows = "".join(f"{a:.2f},{b:.9f}\n" for a, b in zip(t, counts, strict=True))
    (folder / "axis-ra.csv").write_text(f"# format: axis-log 1\nt,velocity\n{rows}")
    return Outcome(folder, SCENARIO, [Record(SCENARIO.steps[0], 0.0, 10.0)], {})


def test_what_was_stamped_in_the_first_second_may_have_been_before_it(counted: Outcome) -> None:
    t, error = errors.rate_errors(counted, counted.records[0], "ra", "counts_5ms", 2.0, 6.0)
    assert (t[0], t[-1], len(t)) == (3.0, 6.0, 301)
    assert error == pytest.approx(rate_arcsec_s(1.0) * (t // 1.0), abs=1e-6)


def test_a_mean_is_of_a_whole_second(counted: Outcome) -> None:
    t, error = errors.rate_errors(counted, counted.records[0], "ra", "mean_1s", 2.0, 6.5)
    assert t == pytest.approx([3.495, 4.495, 5.495])  # half a second is left, which is none
    assert error == pytest.approx(rate_arcsec_s(1.0) * np.array([3.0, 4.0, 5.0]), abs=1e-6)


def test_a_piece_lasts_half_an_hour_at_most() -> None:
    assert [len(errors._pieces(0.0, end_s)) for end_s in (1.0, 1800.0, 1800.5, 3600.0)] == [1, 1, 2, 2]
    assert errors._pieces(1800.0, 3600.0) == [(1800.0, 3600.0)]
