"""Efforts that a loop commands or that hold few values, checks of records, gaps that are not crossed."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.agreement import Agreement
from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Controller, Response
from calibration.inputs.run import Run
from calibration.look import response as looking
from calibration.look.fewvalues import few_values
from calibration.look.gap import known
from calibration.look.loopslaw import follows, law_of_its_loop
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 3000
T: np.ndarray = PERIOD_S * np.arange(ROWS)
X: np.ndarray = 2.0 + np.sin(2 * np.pi * T / 5) + 0.4 * np.sin(2 * np.pi * T / 1.3)
RATE: np.ndarray = np.gradient(X, PERIOD_S)
OTHER = np.random.default_rng(1).standard_normal((ROWS, 1))


def effort(y: np.ndarray, channel: str = "effort", held: np.ndarray | None = None, **more: Any) -> Scene:
    """What forces explain is white; of a driven axis."""
    given = {"dynamic": True, "base": OTHER, "columns": {channel: y}, **more}
    return drive(X, response=Response(channel, "N"), y=y, held=held, **given)


def said(s: Scene, floor: float | None = 0.01) -> str:
    return law_of_its_loop(s.view, s.problem, floor)


def test_a_loop_at_one_set_point_is_a_law_and_no_force() -> None:
    law = 7.0 - 2.5 * X - 0.3 * RATE
    assert said(effort(law)) == (
        "effort is 7 N - 2.5 N/m x position. That is the law of a loop with one set point, beside which no "
        "force shows: move the set point"
    )
    assert said(effort(law, "force")) == "" == said(effort(law, dynamic=False))
    assert said(effort(law), None) == said(effort(law), 0.0) == ""
    assert said(effort(7.0 + 2.5 * X)) == ""  # a spring that pushes away
    noisy = law + 0.008 * OTHER[:, 0] ** 2
    assert said(effort(noisy)) and not said(effort(noisy), 0.001)
    assert not said(effort(law + 0.1 * OTHER[:, 0] ** 2), 9.0)  # a hundredth of its variation
    assert said(effort(law, base=np.column_stack([np.ones(ROWS), X, RATE]))) == ""  # as a mass along a sine


def following(gain: float = 4.0, damping: float = -0.5, noise: float = 0.0, **more: Any) -> Scene:
    error = np.sin(3 * T)
    rng = np.random.default_rng(2)
    y = 1.0 + gain * error + damping * RATE + noise * rng.standard_normal(ROWS)
    columns = {"effort": y, "reference": X + error}
    return effort(y, held=T > 20, **{"columns": columns, **more})


def test_a_command_that_follows_the_reference_is_told() -> None:
    s = following()
    (told,) = follows(s.view, s.problem, 2.0)
    start = "effort is what its loop commands: 4 N/m x (reference - position) - 0.5 N s/m x velocity leaves "
    assert told.startswith(start)
    assert told.endswith(" N where the forces leave 2. Declare the law as `controller`")
    s = following(damping=0.5)
    assert "+ 0.5 N s/m x velocity" in follows(s.view, s.problem, 2.0)[0]


def test_a_command_is_told_where_it_leaves_half_of_what_the_forces_do() -> None:
    s = following(noise=1.0)
    assert follows(s.view, s.problem, 2.1) and not follows(s.view, s.problem, 1.9)
    s = following(-4.0)
    assert follows(s.view, s.problem, 9.0) == []
    law = Controller("pid", {"p": 1.0})
    for other in (
        following(rig={"controller": law}), following(columns={"effort": T}), following(dynamic=False)
    ):  # fmt: skip
        assert follows(other.view, other.problem, 9.0) == []
    s = following()
    assert follows(s.view, replace(s.problem, held=T > 99), 9.0) == []


def few(values: int, follow: float = 1.0, **more: Any) -> tuple[tuple[str, str], Any]:
    """Two terms, and an effort of so many values; `applied` explains a part of the acceleration."""
    levels = np.arange(ROWS) // 100 % values
    rig = {"estimate": ("inertia", "viscous"), **more}
    s = drive(X, response=Response("effort", "A", gain=3.0), columns={"effort": levels * 1.0}, rig=rig)
    s.view.rig.columns["effort"] = Column("V")
    accelerated = np.sqrt(1 - follow) * OTHER[:, 0] + np.sqrt(follow) * (levels - 0.5) * 2

    def problem(_: float) -> Any:
        base = np.column_stack([levels - 0.5, T - 15])
        applied = s.view.response.channel == "acceleration"
        labels = [("applied" if applied else "inertia", "1"), ("viscous", "1")]
        return replace(s.problem, y=accelerated, base=base, base_labels=labels)

    return few_values(s.view, [Some(columns={"effort": levels * 1.0})], problem), s.view  # type: ignore[list-item]


def test_an_effort_of_few_values_is_taken_as_applied_where_the_motion_follows_it() -> None:
    texts, view = few(2)
    why = "effort holds 2 values, the model has 2 terms"
    assert texts == (
        "",
        f"{why}: the acceleration is explained, per unit of the inertia, by effort as `applied`",
    )
    assert view.response == Response("acceleration", "m/s2") and view.rig.estimate == ("applied", "viscous")
    assert np.array_equal(view.columns["applied"], 3 * view.columns["effort"])
    assert view.rig.columns["applied"].unit == "A"
    assert few(3)[0] == ("", "")


@pytest.mark.parametrize("more", [{"estimate": ("viscous",)}, {"constants": {"inertia": 2.0}}])
def test_without_an_inertia_to_find_it_tests_nothing(more: dict[str, Any]) -> None:
    texts, view = few(2, **more)
    assert texts == (
        "effort holds 2 values, the model has 2 terms: it tests no balance; as response take a measured "
        "force, or `acceleration` with it as `applied`",
        "",
    )
    assert view.response.channel == "effort" and "applied" not in view.columns


def test_a_motion_that_hardly_follows_is_not_explained() -> None:
    texts, view = few(2, follow=0.02)
    assert texts[0] and view.response.channel == "effort" and view.rig.estimate[0] == "inertia"


def test_before_a_gap_is_crossed_nothing_is_judged() -> None:
    x = np.concatenate([np.full(300, 0.0), 0.01 * back_and_forth(10, 100) + 0.0])
    s = drive(x, held=np.arange(1300) >= 1000)
    first = 300 + int(np.flatnonzero(x[300:] >= 0.005)[0])
    p = known(s.problem, s.view, 0.005)
    assert np.flatnonzero(p.valid)[0] == first and p.valid[first:].all()
    assert known(s.problem, s.view, 0.0) is s.problem
    assert known(s.problem, s.view, 0.02) is s.problem  # never crossed
    late = drive(np.concatenate([np.zeros(505), x[300:795]]), held=np.arange(1000) >= 990)
    assert known(late.problem, late.view, 0.005) is late.problem  # more than half would go


def record(rows: int, seconds: float = 100.0) -> Run:
    return Run("a.csv", Path("a.csv"), "a", {"t": np.linspace(0, seconds, rows)}, period_s=0.1)


def test_records_are_long_enough_to_say_something() -> None:
    rig = drive(X).view.rig
    looking._check([record(100), record(100)], rig)
    with pytest.raises(CalibrationInputError, match=r"199 rows are too few to say anything \(at least 200\)"):
        looking._check([record(99), record(100)], rig)
    looking._check([record(500)], replace(rig, smooth_s=2.0))
    with pytest.raises(CalibrationInputError, match=r"smooth_s: 2\.1 s is too long for a run of 100 s"):
        looking._check([record(500)], replace(rig, smooth_s=2.1))
    with pytest.raises(CalibrationInputError, match="analyse_period_s: 3 s is too long"):
        looking._check([record(500)], replace(rig, analyse_period_s=3.0))


def agreement(left: float, late: bool, **more: Any) -> Agreement:
    given: dict[str, Any] = {"before": 4.0, "after": left, "floor": 1.0, "late": late, **more}
    return Agreement("velocity", "m/s", 0.02, 1e-3, **given)


def test_a_velocity_has_a_row_where_it_says_something() -> None:
    assert looking._velocity(None) == {} == looking._velocity(agreement(9.0, False, before=1.0))
    late = looking._velocity(agreement(1.0, True))
    assert late == {"velocity": {"unit": "m/s", "before": 4.0, "after": 1.0, "floor": 1.0}}
    apart = looking._velocity(agreement(1.0, False, before=40.0))
    assert apart["velocity"]["after"] == 40.0
    assert looking._velocity(agreement(1.0, True, floor=float("nan")))["velocity"]["floor"] is None
    assert looking._velocity(agreement(1.0, True, before=float("nan"))) == {}


def test_gaps_are_told_with_the_time_that_is_lost() -> None:
    one, two = record(500), record(500)
    one.columns["t"] = np.delete(one.columns["t"], slice(100, 150))
    two.columns["t"] = np.delete(one.columns["t"], slice(300, 350))
    told = list(looking._gaps([record(500), one, two]))
    assert told == ["a.csv: 1 gap, 10.2 s without rows", "a.csv: 2 gaps, 20.4 s without rows"]


def names(s: Scene, records: int = 2) -> list[str]:
    logs: Any = [Some(name=f"{'ab'[k % 2]}.csv") for k in range(records)]
    return list(looking._held_names(s.view, s.problem, logs))


def test_what_is_held_out_is_told_by_file_and_time() -> None:
    files = np.repeat([0, 1], ROWS // 2)
    assert names(drive(X, files=files, held=files == 1)) == ["b.csv"]
    assert names(drive(X, files=files, held=T % 15 > 12)) == [
        "a.csv run 1 from 12.01 s",
        "b.csv run 2 from 12.01 s",
    ]
    middle = drive(X, held=(T > 12) & (T < 15))
    assert names(middle) == ["a.csv run 1 from 12.01 s to 14.99 s"]
    turned = drive(X, files=files)
    turned.problem.turned = turned.problem.valid
    assert names(turned) == ["each of 2 files in its turn"]


def balance(before: float, after: float, *found: str) -> Any:
    findings = [Some(name=name, of_column=name == "channel_delay") for name in found]
    return Some(error={"before": before, "after": after}, findings=findings)


def test_a_response_explains_where_its_error_falls() -> None:
    assert looking._explains(balance(2.0, 1.9)) and not looking._explains(balance(2.0, 2.0))
    assert looking._names(balance(1, 1, "unknown", "play")) and not looking._names(balance(1, 1, "unknown"))
    assert not looking._names(balance(1, 1, "channel_delay")) and not looking._names(balance(1, 1))
