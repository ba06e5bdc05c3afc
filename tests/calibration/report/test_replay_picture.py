"""Which pictures a report has, and the closed loop run again: where it is looked at, and what is told."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.look.looked import Balance, Looked, Spectrum
from calibration.names.position_friction import NAME
from calibration.replay.held import Replay
from calibration.replay.trace import Trace
from calibration.report import plots
from calibration.report.pictures import SPECTRUM, TRACE, _worth_drawing, of_balance, pictures, replay_picture
from tests.calibration.report.drawn import effect, legend, problem, scores, selection

N = 1000
FRICTION = NAME.name


def trace(velocity: np.ndarray, torque: np.ndarray | None = None) -> Trace:
    return Trace(
        torque=np.full(N, np.nan) if torque is None else torque, velocity=velocity, position=np.zeros(N)
    )


def again(**more: Any) -> Replay:
    """At 10 ms; the declared model is off from row 600 on."""
    off = np.where((np.arange(N) >= 600) & (np.arange(N) < 800), np.resize([3.0, -3.0], N), 0.0)
    given: dict[str, Any] = {
        "run": "run4", "time": 0.01 * np.arange(N), "log": trace(np.ones(N), np.full(N, 5.0)),
        "before": trace(np.full(N, 3.0), 5.0 + off), "after": trace(np.full(N, 1.5), np.full(N, 5.5)),
        "use": np.ones(N, dtype=bool),
    }  # fmt: skip
    return Replay(**(given | more))


def drawn(figures: list[Any], replayed: Replay) -> tuple[Any, Any]:
    assert replay_picture(replayed)["alt"] == "Closed loop replayed on run4: measured, declared and corrected"
    top, low = figures[-1].axes
    return top, low


def test_torque_is_drawn_where_the_declared_model_is_furthest_off(figures: list[Any]) -> None:
    top, low = drawn(figures, again())
    measured, before, after = top.lines
    assert measured.get_xdata() == pytest.approx(0.01 * np.arange(600, 800))  # two seconds
    assert measured.get_ydata().tolist() == [5.0] * 200 and after.get_ydata().tolist() == [5.5] * 200
    assert before.get_ydata().tolist() == [8.0, 2.0] * 100
    assert legend(top) == [
        "measured", "declared model, closed loop replayed", "corrected plant, closed loop replayed"
    ]  # fmt: skip
    said = top.get_xlabel(), top.get_ylabel(), top.get_title()
    assert said == ("time in the run, s", "motor torque, N m", "Held-out run run4")
    assert [line.get_ydata().tolist() for line in low.lines] == [[2.0] * N, [0.5] * N]
    assert low.lines[0].get_xdata().tolist() == (0.01 * np.arange(N)).tolist()
    assert legend(low) == ["declared, rms 2", "corrected, rms 0.5"]
    assert (low.get_xlabel(), low.get_ylabel()) == ("time in the run, s", "velocity error, arcsec/s")


def test_without_currents_the_velocity_is_drawn(figures: list[Any]) -> None:
    off = np.where(np.arange(N) >= 300, np.resize([0.0, 9.0], N), 0.0)
    top, _ = drawn(figures, again(log=trace(np.ones(N)), before=trace(1.0 + off)))
    assert top.get_ylabel() == "motor velocity, arcsec/s" and top.lines[0].get_xdata()[0] >= 2.99


def test_rows_that_may_not_be_compared_are_passed_over(figures: list[Any]) -> None:
    use = np.ones(N, dtype=bool)
    use[[650, 700, 750]] = False  # more than one of a hundred in every window that is off
    _, low = drawn(figures, again(use=use))
    assert len(low.lines[0].get_xdata()) == N - 3
    top, _ = drawn(figures, again(use=use))
    first = round(float(top.lines[0].get_xdata()[0]) / 0.01)
    assert use[first : first + 200].mean() > 0.99 and first in (551, 500)


def test_a_run_without_any_row_to_compare_says_so(figures: list[Any]) -> None:
    top, low = drawn(figures, again(use=np.zeros(N, dtype=bool)))
    assert legend(low) == ["declared, no row usable", "corrected, no row usable"]
    assert top.lines[0].get_xdata()[0] == 0.0


def seven(x: Trace) -> Any:
    return Trace(torque=x.torque[:7], velocity=x.velocity[:7], position=x.position[:7])


def test_a_short_run_is_drawn_whole(figures: list[Any]) -> None:
    short = again(time=0.1 * np.arange(N))
    assert len(drawn(figures, short)[0].lines[0].get_xdata()) == 20
    for name in ("time", "use"):
        short = replace(short, **{name: getattr(short, name)[:7]})
    cut = {name: seven(getattr(short, name)) for name in ("log", "before", "after")}
    assert len(drawn(figures, replace(short, **cut))[0].lines[0].get_xdata()) == 7


def names(*given: str) -> list[int]:
    return _worth_drawing(selection(problem(np.zeros(8)), *(effect(np.ones(8), name) for name in given)))


def test_every_name_is_drawn_and_four_effects_at_most_of_few_names() -> None:
    assert names("a", "b", "a", "c", "b", "a") == [0, 1, 2, 3]
    assert names("a", "a", "a", "a", "a") == [0, 1, 2, 3]
    assert names("a", "b", "c", "d", "e", "a") == [0, 1, 2, 3, 4]
    assert names() == []


def balance(*chosen: Candidate, **more: Any) -> Balance:
    s = selection(
        problem(np.arange(40.0), held=10), *chosen, scores=more.pop("scores", scores([1.0], 2.0, [0.5]))
    )
    given: dict[str, Any] = {"key": "K", "row": "position", "selection": s}
    return Balance(**(given | more))


def test_a_balance_has_its_spectrum_its_trace_and_its_gate(
    figures: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    titles: list[str] = []

    def noted(at: int, *given: Any) -> str:
        titles.append(given[at])
        return "image"

    for name, at in (("spectrum_plot", 2), ("trace_plot", 2), ("gate_plot", 1), ("domain_plot", 3)):
        monkeypatch.setattr(plots, name, partial(noted, at))
    spectrum = Spectrum(turns=np.zeros(40), stages={}, label="")
    drag = effect(np.ones(40), stage="wheel", harmonic=2)
    told = of_balance(balance(drag, over=lambda c: (np.zeros(40), "x"), spectrum=spectrum))
    assert titles == [
        "drag on wheel, harmonic 2, position", "Amplitude over order, position",
        "Held-out residual before and after, position", "Is anything there at all? position",
    ]  # fmt: skip
    effects = "Fitted rows, the declared model and the other effects removed"
    assert [p["alt"] for p in told] == [effects, SPECTRUM, TRACE, plots.GATE]
    titles.clear()
    bare = balance(drag, row=None, spectrum=replace(spectrum, periods=True), scores=scores([], 0.0, []))
    assert [p["alt"] for p in of_balance(bare)] == [SPECTRUM, TRACE]
    assert titles == ["Amplitude over period, channel K", "Held-out residual before and after, channel K"]


def test_only_friction_that_changes_sign_is_drawn_with_the_direction(
    figures: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[Any] = []

    def noted(*all_of_it: Any) -> str:
        given.append(all_of_it)
        return "image"

    monkeypatch.setattr(plots, "domain_plot", noted)
    way = np.ones(40)
    for name in (FRICTION, "drag"):
        of_balance(balance(effect(np.ones(40), name), over=lambda c: (np.zeros(40), "x"), direction=way))
    assert given[0][-1] is way and given[1][-1] is None and given[0][2:5:2] == ("x", 0)


def test_a_drive_in_which_nothing_was_found_has_the_first_balances_pictures(figures: list[Any]) -> None:
    quiet, loud = balance(), balance(effect(np.ones(40)), row="torque")
    assert len(pictures(Looked(title="", balances=[quiet, loud]), Replay())) == 2
    assert figures[-1].axes[0].get_title(loc="left") == "Is anything there at all? torque"
    pictures(Looked(title="", balances=[quiet, quiet]), Replay())
    assert len(figures) == 4
    assert len(pictures(Looked(title=""), again())) == 1
