"""Pictures of a balance: the effects that were accepted, over what each is a function of."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.look.looked import Balance, Looked, Spectrum
from calibration.replay.held import Replay
from calibration.report import plots
from calibration.report.pictures import pictures
from tests.calibration.decide import made

ROWS = 2400
TURNS = np.linspace(0.0, 60.0, ROWS)


@pytest.fixture(scope="module")
def found() -> Selection:
    """One line a turn, of 3 N m in noise of 1."""
    y = np.random.default_rng(3).standard_normal(ROWS) + 3.0 * np.cos(2 * np.pi * TURNS)
    line = made.line("gear_eccentricity", TURNS, 1.0, stage="wheel")
    s = select(made.problem(y), [line], np.random.default_rng(0))
    assert len(s.chosen) == 1
    return s


def drive(s: Selection) -> Looked:
    spectrum = Spectrum(turns=TURNS, stages={"wheel": 1.0, "motor": 7.0}, label="cycles per turn")
    b = Balance(key="T", row="torque", selection=s, over=lambda c: (TURNS % 1.0, "turns"), spectrum=spectrum)
    quiet = Balance(key="U", row="command", selection=replace(s, chosen=[], after=s.before))
    return Looked(title="a drive", balances=[b, quiet])


@pytest.mark.slow
def test_what_shows_an_effect_is_drawn_and_what_shows_none_is_not(found: Selection) -> None:
    drawn = pictures(drive(found), Replay())
    assert [p["image"][:22] for p in drawn] == ["data:image/png;base64,"] * 4
    assert drawn[0]["alt"].startswith("Fitted rows") and drawn[-1]["alt"] == plots.GATE
    nothing = replace(drive(found), balances=[drive(found).balances[1]])
    assert len(pictures(nothing, Replay())) == 2  # the trace and the gate say that nothing is there
    assert pictures(Looked(title="too short"), Replay()) == []


@pytest.mark.slow
def test_a_line_with_a_phase_of_every_sections_own_is_drawn_for_one(
    found: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows: list[int] = []
    draw = plots.domain_plot

    def count(s: Selection, *more: object) -> str:
        rows.append(int(s.problem.train.sum()))
        return draw(s, *more)  # type: ignore[arg-type]

    monkeypatch.setattr(plots, "domain_plot", count)
    c, run = found.chosen[0].candidate, found.problem.run
    apart = np.hstack([c.columns * (run == k)[:, None] for k in np.unique(run)])
    chosen = [replace(found.chosen[0], candidate=replace(c, columns=apart, per_run=True))]
    fit = found.problem.fit(found.problem.design([chosen[0].candidate]))
    pictures(drive(found), Replay())
    pictures(drive(replace(found, chosen=chosen, after=fit)), Replay())
    assert rows == [ROWS * 3 // 4, ROWS // 4]


def test_periods_and_orders_are_drawn_by_one_function(found: Selection) -> None:
    for periods in (False, True):
        spectrum = Spectrum(turns=found.problem.t, stages={"worm": 0.5}, label="", periods=periods)
        x, y = (plots._over_periods if periods else plots._over_orders)(
            found, spectrum, found.before.residual
        )
        top = float(x[np.argmax(y)])  # a turn lasts 2 s
        assert top == pytest.approx(2.0 if periods else 0.5, rel=0.02) and y.max() == pytest.approx(
            3.0, rel=0.1
        )
