"""Samples of mutants: every mutant is as likely, a seed repeats them, and no floor changes by them."""

from collections import Counter

import pytest

from tests.mutation.operators import mutants
from tests.mutation.sample import drawn, interval

SOURCE = "def over(value, least=0):\n    return value > 3 and value + 1 > least\n"


def test_a_sample_is_drawn_from_all_modules_alike_and_again_by_its_seed() -> None:
    cases = {"one.py": list(mutants("a = 1")), "none.py": [], "many.py": list(mutants(SOURCE))}
    assert {path: len(some) for path, some in drawn(cases, 100, 1).items()} == {"one.py": 1, "many.py": 7}
    samples = [drawn(cases, 3, seed) for seed in range(300)]
    assert samples[7] == drawn(cases, 3, 7)
    assert all(sum(map(len, each.values())) == 3 for each in samples)
    often = Counter((path, each.label) for one in samples for path, some in one.items() for each in some)
    assert len(often) == 8 and all(77 <= times <= 148 for times in often.values())  # 112.5, and 4.2 sigma


def test_an_interval_is_wilsons() -> None:
    """E. B. Wilson, JASA 22 (1927) 209: with z = 1.96, the middle is (k + z^2 / 2) / (n + z^2)."""
    low, high = interval(130, 150)
    z = 1.959964
    middle = 100 * (130 + z**2 / 2) / (150 + z**2)
    half = 100 * z * (130 * 20 / 150 + z**2 / 4) ** 0.5 / (150 + z**2)
    assert (low, high) == pytest.approx((middle - half, middle + half), abs=1e-4)


@pytest.mark.parametrize("more", [["--ratchet"], ["--tighten"]])
def test_a_sample_touches_no_floor(more: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("coverage")
    from tests.mutation.__main__ import options

    monkeypatch.setattr("sys.argv", ["mutation", "bus", "--sample", "5", *more])
    with pytest.raises(SystemExit):
        options()
    monkeypatch.setattr("sys.argv", ["mutation", "bus", "--sample", "5"])
    assert (options().sample, options().seed) == (5, 1)
