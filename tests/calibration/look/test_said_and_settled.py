"""Notes on a response, its doubts and its sign; which lines and shapes a search knows."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.filters import Filter
from calibration.decide.selection import Refusal, Selection
from calibration.finding import UNKNOWN
from calibration.inputs.declaration import Response
from calibration.look import said, search, settled
from tests.calibration.names.made import PERIOD_S, drive

ROWS = 3000
T: np.ndarray = PERIOD_S * np.arange(ROWS)
X: np.ndarray = 2.0 + np.sin(2 * np.pi * T / 5)
WAY: np.ndarray = np.sign(np.gradient(X))
RNG = np.random.default_rng(1)


def scene(**more: Any) -> Any:
    given = {"response": Response("force", "N"), "direction": WAY, **more}
    return drive(more.get("x", X), **{k: v for k, v in given.items() if k != "x"})


def test_the_share_that_a_filter_takes_is_told() -> None:
    quick = np.sin(2 * np.pi * 0.1 * np.arange(ROWS))
    v = scene(columns={"force": np.sin(T) + quick}, filter=Filter(4.0)).view
    text, most = said.filtered(v)
    gain = np.exp(-((2 * np.pi * 0.1 * 4) ** 2))
    part = 100 * (0.5 * (1 - gain)) / np.var(np.sin(T) + quick)
    words = "the filter of 0.2 s (`smooth_s` in the rig file sets another) takes "
    assert text.startswith(words) and text.endswith(" % of the mean square of force away")
    assert float(text.removeprefix(words).split()[0]) == pytest.approx(part, rel=0.02)
    assert most == (part > 50)
    louder = scene(columns={"force": np.sin(T) + 1.3 * quick}, filter=Filter(4.0)).view
    assert (
        said.filtered(louder)[1]
        and not said.filtered(scene(columns={"force": np.sin(T) + 0.7 * quick}, filter=Filter(4.0)).view)[1]
    )
    assert said.filtered(scene(columns={"force": quick}).view) == ("", False)
    assert said.filtered(scene(columns={"force": 0 * T}, filter=Filter(4.0)).view) == ("", False)


def refused(*each: tuple[str, str]) -> Any:
    return Some(refused=[Refusal(what, why) for what, why in each])


def test_names_that_were_close_have_an_experiment() -> None:
    luck = "cross-validated gain is within luck (z = 1)"
    (text,) = said.close(
        refused(("torque_ripple on motor, harmonic 2", luck), ("play", "another reason"), (UNKNOWN, luck))
    )
    assert text == (
        f"torque_ripple on motor, harmonic 2 was close ({luck}): hold the speed and vary the torque: ripple "
        "grows, cogging stays"
    )
    assert said.close(refused(("strange", "makes the held-out error larger"))) == [
        "strange was close (makes the held-out error larger): repeat the run"
    ]
    assert len(said.close(refused(("play", "no held-out rows")))) == 1


def selection(base: np.ndarray, names: list[str], y: np.ndarray | None = None) -> Selection:
    s = drive(X, base=base, y=np.zeros(ROWS) if y is None else y, held=T > 20)
    s.problem.base_labels = [(name, "N") for name in names]
    return Selection.of(s.problem)


def test_parameters_that_a_motion_does_not_move_apart_are_told() -> None:
    one, other = np.sin(T), np.cos(3 * T)
    base = np.column_stack([one, one + 0.1 * other, other, 0 * T, 0 * T, 0 * T])
    s = selection(base, ["a", "b", "c", "d", "slow_offset", "e"])
    assert said.moves_with(s, ["e: why"]) == ["d", "a (moves with b)", "b (moves with a)", "c (moves with b)"]
    apart = np.column_stack([one, one + 0.3 * other])  # 1 / (1 - r2) = 12
    assert said.moves_with(selection(apart, ["a", "b"]), []) == []


def place(
    more: dict[str, Any], columns: dict[str, np.ndarray] | None = None, **view: Any
) -> tuple[np.ndarray, str]:
    fields: dict[str, Any] = {"domain": "time", **more}
    c = Candidate("brake_drag", fields.pop("domain"), np.ones((ROWS, 1)), (), **fields)
    return said.place_of(scene(columns=columns or {}, **view).view, c)


def test_an_effect_is_drawn_over_its_domain() -> None:
    x, label = place({"order": 4.0, "kind": "line"}, turn=8.0)
    assert label == "phase of order 4, turns" and x == pytest.approx(X / 8 * 4)  # a turn in one piece
    x, label = place({"order": 12.0, "kind": "line"}, turn=8.0)
    assert x == pytest.approx(X / 8 * 12 % 1)
    x, label = place({"frequency": 2.0})
    assert label == "phase of 2 Hz, turns" and x == pytest.approx(T * 2 % 1)
    assert place({"frequency": 2.0, "fixed": {"frequency": (2.5, "Hz")}})[1] == "phase of 2.5 Hz, turns"
    assert place({"frequency": 2.0, "fixed": {"damping": (0.1, "1")}})[1] == "time, s"
    heat, effort = 20 + T, np.cos(T)
    assert place({"domain": "temperature"}, {"temperature": heat})[1] == "temperature, degC"
    assert place({"domain": "temperature"})[1] == "time, s"
    x, label = place({"domain": "current"}, {"effort": effort})
    assert label == "effort" and np.array_equal(x, effort)
    for domain, expected, words in (
        ("axis_angle", X, "position, m"), ("motor_angle", X, "position, m"),
        ("velocity", np.gradient(X, PERIOD_S), "speed, m/s"),
    ):  # fmt: skip
        x, label = place({"domain": domain})
        assert label == words and x == pytest.approx(expected)
    assert place({"domain": "reversal"})[1] == "travel since reversal, m"
    x, label = place({"domain": "axis_angle"}, unit="rad")
    assert label == "position, degrees" and x == pytest.approx(np.degrees(X))


def wobble(channel: str, y: np.ndarray, **more: Any) -> list[str]:
    """Doubts about a response whose floor, findings and friction are given."""
    floor, after, found = more.pop("floor", None), more.pop("after", 1.0), more.pop("findings", [])
    coulomb, labels = more.pop("coulomb", 0.0), more.pop("labels", ["coulomb"])
    v = scene(columns={channel: y}, response=Response(channel, "N"), **more).view
    p = Some(base_labels=[(n, "N") for n in labels], y=y, named=lambda _: {"coulomb": Some(value=coulomb)})
    told: Any = Some(
        floor=floor, findings=found, selection=Some(held=Some(after=after), problem=p, after=None)
    )
    return settled.doubts(v, told)


def test_a_floor_far_above_what_is_left_is_a_doubt() -> None:
    y = np.sin(T)
    assert wobble("force", y, floor=2.1) == [
        "force: its floor is 2.1 N, 2.1 times what is left: what is smaller than that does not show"
    ]
    assert wobble("force", y, floor=2.0) == [] == wobble("force", y, floor=None)
    assert wobble("force", y, floor=9.0, findings=["x"]) == [] == wobble("force", y, floor=9.0, after=0.0)


def test_an_effort_that_never_changes_its_sign_is_a_doubt() -> None:
    size, sign = (
        np.abs(np.sin(T)) + 0.01,
        "force never changes its sign, though the drive goes both ways: is it a size?",
    )
    assert wobble("force", size) == [sign] == wobble("force", -size)
    assert wobble("force", np.sin(T)) == [] == wobble("force", size + 9.0)
    assert wobble("force", size, coulomb=0.04 * np.std(size)) == [sign]
    assert wobble("force", size, coulomb=0.06 * np.std(size)) == []
    assert wobble("force", size, labels=["coulomb", "gravity_cos"]) == []
    assert wobble("force", size, labels=["applied", "coulomb"]) == []
    for back, doubted in ((0.16, False), (1 / 6, False), (0.17, True)):  # a fifth of the rows one way
        way = np.where(np.arange(ROWS) < back * ROWS, -1.0, 1.0)
        assert bool(wobble("force", size, direction=way)) == doubted


def sensors(slope: float, noise: float = 0.0, **more: Any) -> Any:
    y = slope * X + noise * RNG.standard_normal(ROWS)
    s = drive(X, response=Response("position2", "m", **more), base=np.column_stack([np.ones(ROWS), X]), y=y)
    s.problem.base_labels = [("offset", "m"), ("scale", "m/m")]
    return s


def test_two_sensors_of_one_motion_follow_each_other() -> None:
    assert settled._together(sensors(2.0).problem) == pytest.approx(1.0)
    assert settled._together(sensors(-2.0).problem) == pytest.approx(-1.0)
    assert settled._together(sensors(0.01, 1.0).problem) == 0.0
    p = sensors(-2.0).problem
    p.base_labels = [("offset", "m"), ("drift", "m/s")]
    assert settled._together(p) == 0.0


def test_a_sensor_that_falls_is_turned() -> None:
    s = sensors(-2.0)
    (note,) = settled.turned(s.view, s.problem, lambda _: s.problem)
    assert (
        note == "position2: falls as the position rises. Its sign, and that of what is found, is turned here"
    )
    assert s.view.response.gain == -1.0 and s.view.response.ratio is None
    declared = sensors(2.0, ratio=-0.5)
    assert settled.turned(declared.view, declared.problem, lambda _: declared.problem)
    assert declared.view.response.ratio == 0.5
    good = sensors(2.0)
    assert (
        settled.turned(good.view, good.problem, lambda _: good.problem) == []
        and good.view.response.gain == 1.0
    )


@pytest.mark.parametrize(
    ("mass", "friction", "against"),
    [(-2.0, -1.0, True), (2.0, 1.0, False), (-2.0, 0.5, False), (-2.0, 0.3, True)],
)
def test_masses_and_friction_that_come_out_negative_are_against_the_motion(
    mass: float, friction: float, against: bool
) -> None:
    bend = RNG.standard_normal(ROWS)
    base = np.column_stack([bend, WAY, np.ones(ROWS)])
    s = drive(X, base=base, y=mass * bend + friction * WAY, turn=9.0)
    s.problem.base_labels = [("inertia", ""), ("coulomb", ""), ("offset", "")]
    assert settled._against(s.view, s.problem) == against
    s.problem.base_labels = [("offset", ""), ("drift", ""), ("other", "")]
    assert not settled._against(s.view, s.problem)


def line(**more: Any) -> Candidate:
    return Candidate("bearing_pass", "axis_angle", np.ones((ROWS, 2)), (), **more)


def test_a_line_is_known_within_its_cell() -> None:
    s = scene(ok=np.ones(ROWS, dtype=bool))
    found = [line(order=5.0), line(frequency=3.0)]
    assert search._known(line(order=5.4), found, s) and not search._known(line(order=5.6), found, s)
    assert search._known(line(frequency=3.03), found, s) and not search._known(line(frequency=3.04), found, s)
    assert not search._known(replace(line(order=5.0), columns=np.ones((ROWS, 4))), found, s)
    assert not search._known(line(), found, s) and not search._known(line(order=5.0), [], s)


def test_terms_that_come_out_negative_are_kept_at_zero() -> None:
    base = np.column_stack([np.sin(T), WAY, np.ones(ROWS)])
    s = selection(
        base,
        ["inertia", "coulomb", "offset"],
        -2 * np.sin(T) - 1 + 0.5 * WAY + 0.01 * RNG.standard_normal(ROWS),
    )
    (text,) = search._bound(s)
    assert text.startswith("inertia: the fit gives -2")
    assert text.endswith("; a negative one feeds energy: kept at zero") and "within its error" not in text
    assert not s.problem.base[:, 0].any() and s.problem.base[:, 1].any() and base[:, 0].any()
    weak = selection(base, ["inertia", "coulomb", "offset"], 0.5 * WAY + 5 * RNG.standard_normal(ROWS))
    for text in search._bound(weak):
        assert ", within its error; a negative one" in text
