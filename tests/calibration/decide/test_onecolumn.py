"""One function of a load instead of several of the motion, where it takes as much."""

from types import SimpleNamespace

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide import onecolumn
from calibration.decide.onecolumn import by_one_column
from calibration.decide.scan import fit_with
from calibration.decide.selection import Refusal, Selection
from calibration.finding import UNKNOWN, Finding
from tests.calibration.decide.made import problem, term

ROWS = 2400
RNG = np.random.default_rng(5)
PLACE, WAY, LOAD, HEAT = (RNG.standard_normal((ROWS, 1)) for _ in range(4))
NOISE = 0.3 * RNG.standard_normal(ROWS)
TOLD = [Finding(UNKNOWN, "T", "axis_angle"), Finding("coulomb_change", "T", "velocity")]


def over(domain: str, columns: np.ndarray) -> Candidate:
    found = term(UNKNOWN, columns)
    return Candidate(UNKNOWN, domain, columns, found.labels)


def asked(
    monkeypatch: pytest.MonkeyPatch, y: np.ndarray, chosen: list[Candidate], functions: list[Candidate]
) -> tuple[Selection, Selection, Selection, list[Finding]]:
    """What was chosen together, and the answer; the model is back in its place."""
    p: Problem = problem(y)
    contenders = [found for c in chosen if (found := fit_with(p, p.base, c)) is not None]
    bare, together = Selection.of(p), Selection.of(p, contenders)
    bare.refused = [Refusal("gear_mesh", "no such line")]
    scene = SimpleNamespace(model="declared")

    def smooth(given: SimpleNamespace) -> list[Candidate]:
        assert given.model is None  # of the columns alone
        return functions

    monkeypatch.setattr(onecolumn, "smooth_functions", smooth)
    answer = by_one_column(bare, together, TOLD, scene)  # type: ignore[arg-type]
    assert scene.model == "declared"
    return together, *answer


TWO = [over("axis_angle", PLACE), term("coulomb_change", WAY)]
LOADED = 2.0 * (PLACE + WAY)[:, 0] + NOISE


@pytest.mark.parametrize("noise", [1.0, 20.0])  # of which the loud one leaves nine tenths of the square
def test_a_function_of_the_load_that_takes_as_much_stands_alone(
    noise: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    functions = [over("time", PLACE), over("current", PLACE + WAY), over("temperature", HEAT)]
    together, s, alone, findings = asked(monkeypatch, LOADED + (noise - 1.0) * NOISE, TWO, functions)
    assert s.chosen == [] and len(together.chosen) == 2
    assert [c.domain for c in alone.candidates] == ["current"]
    assert [f.domain for f in findings] == ["current"]
    refused = [(each.what, each.why) for each in alone.refused]
    assert refused[0] == ("gear_mesh", "no such line")
    for told, candidate in zip(refused[1:3], TWO, strict=True):
        assert told[0] == candidate.say() and told[1].endswith("over current alone takes as much")


def test_it_is_one_function_and_not_two(monkeypatch: pytest.MonkeyPatch) -> None:
    y = LOADED + HEAT[:, 0] * 0.5
    functions = [over("current", PLACE + WAY), over("temperature", HEAT)]
    _, _, alone, findings = asked(monkeypatch, y, TWO, functions)
    assert len(alone.chosen) == len(findings) == 1


@pytest.mark.parametrize("functions", [
    [over("current", LOAD)],  # takes nothing
    [over("current", PLACE)],  # takes half
    [over("time", PLACE + WAY)],  # no column of the log
    [],
])  # fmt: skip
def test_a_function_that_takes_less_or_is_of_something_else_changes_nothing(
    functions: list[Candidate], monkeypatch: pytest.MonkeyPatch
) -> None:
    together, s, left, findings = asked(monkeypatch, LOADED, TWO, functions)
    assert left is together and s.chosen == [] and findings is TOLD


@pytest.mark.parametrize("chosen", [
    [over("axis_angle", PLACE + WAY)],  # one alone is as simple
    [term("cable_wrap", PLACE), term("coulomb_change", WAY)],  # each has a name
    [],
])  # fmt: skip
def test_what_is_one_or_has_names_stays(chosen: list[Candidate], monkeypatch: pytest.MonkeyPatch) -> None:
    together, _, left, findings = asked(monkeypatch, LOADED, chosen, [over("current", PLACE + WAY)])
    assert left is together and findings is TOLD
