"""Which rows an effect is drawn for, and what its title tells of names that it cannot be told from."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.look.looked import Balance
from calibration.report import pictures as module
from calibration.report import plots
from calibration.report.pictures import of_balance, replay_picture
from tests.calibration.report.drawn import effect, problem, scores, selection
from tests.calibration.report.test_replay_picture import N, again, trace

HALF = np.where(np.arange(40) < 20, 1.0, 0.0)


def line(*columns: np.ndarray, **more: Any) -> Candidate:
    labels = (("amplitude", "N m"),)
    return Candidate("gear_mesh", "axis_angle", np.column_stack(columns), labels, **({"kind": "line"} | more))


def drawn(monkeypatch: pytest.MonkeyPatch, c: Candidate, *tied: str) -> tuple[list[int], str, str]:
    """Rows that are fitted, the title, and the alternative text."""
    given: list[Any] = []

    def noted(*all_of_it: Any) -> str:
        given.append(all_of_it)
        return "image"

    monkeypatch.setattr(plots, "domain_plot", noted)
    others = [selection(problem(np.zeros(40)), effect(HALF, name)).chosen[0] for name in tied]
    monkeypatch.setattr(module, "tied_at_last", lambda s, k: others)
    s = selection(problem(np.zeros(40), held=4), c, scores=scores([], 0.0, []))
    b = Balance(key="T", row="torque", selection=s, over=lambda _: (np.zeros(40), "x"))
    alt = of_balance(b)[0]["alt"]
    return np.flatnonzero(given[0][0].problem.train).tolist(), given[0][3], alt


ALT = "Fitted rows, the declared model and the other effects removed"


def test_a_line_of_two_sections_is_drawn_for_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    cosine = np.where(np.arange(40) % 2, 1.0, 0.0)
    both = line(HALF * 0.6, HALF * cosine, (1 - HALF) * 0.6, (1 - HALF) * cosine)
    rows, title, alt = drawn(monkeypatch, both)
    assert rows == list(range(20)) and title == "gear_mesh, torque"
    assert alt == ALT + "; of the first section: the phase of every further one is its own"
    for one in (line(cosine, 1 - cosine), line(HALF * cosine, 1 - HALF, cosine, cosine, kind="linear")):
        rows, _, alt = drawn(monkeypatch, one)
        assert rows == list(range(36)) and alt == ALT


def test_two_names_that_tie_are_told_each_once(monkeypatch: pytest.MonkeyPatch) -> None:
    cosine = np.where(np.arange(40) % 2, 1.0, 0.0)
    c = line(cosine, 1 - cosine)
    told = drawn(monkeypatch, c, "gear_mesh", "play", "drag", "wind")[1]
    assert told == "gear_mesh (or play, drag), torque"
    assert drawn(monkeypatch, c, "play", "play", "drag")[1] == "gear_mesh (or play), torque"
    assert drawn(monkeypatch, c, "gear_mesh")[1] == "gear_mesh, torque"


def test_a_torque_that_is_off_by_a_constant_is_off_nowhere_more(figures: list[Any]) -> None:
    """What varies is looked for: the measured torque itself does, the error does not but at the end."""
    wave = 9.0 * np.sin(np.arange(N) / 5.0)
    end = np.where(np.arange(N) >= 700, np.resize([1.0, -1.0], N), 0.0)
    replay_picture(again(log=trace(np.ones(N), wave), before=trace(np.ones(N), wave + 3.0 + end)))
    assert figures[-1].axes[0].lines[0].get_xdata()[0] >= 6.99
