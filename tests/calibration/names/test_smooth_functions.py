"""What an effect without a name may be a function of, and columns of a fit that follows anything smooth."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN
from calibration.inputs.declaration import Response
from calibration.names import unknown
from tests.calibration.names.made import PERIOD_S, drive

smooth: Any = unknown
ROWS = 2000
T = PERIOD_S * np.arange(0.0, ROWS)
X = 3.0 * np.sin(2 * np.pi * T / 4.0) + np.sin(2 * np.pi * T / 1.7)
WAY = np.sign(np.gradient(X))
FORCE, SENSORS = Response("force", "N"), Response("position2", "m")


def scene(
    response: Response = FORCE, columns: Any = None, dynamic: bool | None = None, x: Any = X, **more: Any
) -> Any:
    given = {"response": response, "columns": columns or {}, "direction": np.sign(np.gradient(x)), **more}
    return drive(x, dynamic=response.is_force if dynamic is None else dynamic, **given)


def names(s: Any) -> list[str]:
    return [name for name, _ in smooth.domains(s)]


PLACES = ["axis_angle", "velocity", "time", "reversal"]


@pytest.mark.parametrize(
    ("s", "domains"),
    [
        (scene(), PLACES),  # the force is the response: a function of itself says nothing
        (scene(Response("current", "A")), PLACES),
        (scene(Response("effort", "A")), [*PLACES, "current"]),
        (scene(Response("effort", "A"), dynamic=False), PLACES),
        (scene(Response("velocity", "m/s"), dynamic=False), [p for p in PLACES if p != "velocity"]),
        (scene(columns={"effort": T}), PLACES),
        (scene(SENSORS, {"effort": T, "force": T, "supply": T}), [*PLACES, "current", "current"]),
        (scene(columns={"temperature": 20 + 0.1 * T}), [*PLACES, "temperature"]),
        (scene(columns={"temperature": 20 + 0.02 * T}), PLACES),  # 0.4 K are none
        (scene(x=1.0 + T**2), PLACES[:3]),
    ],
)  # fmt: skip
def test_domains_are_what_the_log_holds_beside_the_response(s: Any, domains: list[str]) -> None:
    assert names(s) == domains


def test_values_of_the_domains_are_the_log_s() -> None:
    model = np.cos(T)
    s = scene(Response("effort", "A"), {"temperature": 20 + T}, y=7.0 * model, base=model[:, None])
    found = dict(smooth.domains(s))
    v = s.view
    assert found["axis_angle"] is not None and np.array_equal(found["axis_angle"], X)
    assert np.array_equal(found["velocity"], v.speed) and np.array_equal(found["time"], v.clock)
    assert np.array_equal(found["temperature"], 20 + T)
    unit = 0.05 * np.median(np.abs(v.since))
    assert found["reversal"] == pytest.approx(np.sign(v.since) * np.log(1 + np.abs(v.since) / unit))
    assert found["current"] == pytest.approx(7.0 * model)  # what declared terms make, without noise
    known = replace(s, model=2.0 * model)
    assert dict(smooth.domains(known))["current"] == pytest.approx(2.0 * model)


def forms(s: Any) -> list[tuple[str, int, str]]:
    return [(c.domain, c.width, c.note) for c in smooth.smooth_functions(s)]


def test_functions_of_place_and_time_come_also_odd_in_direction() -> None:
    found = forms(scene(Response("effort", "A"), y=np.cos(T), base=np.cos(T)[:, None]))
    assert [d for d, _, _ in found] == ["axis_angle"] * 3 + ["velocity"] + ["time"] * 2 + [
        "reversal",
        "current",
    ]
    assert {note for d, _, note in found if d != "current"} == {""}
    assert [note for d, _, note in found if d == "current"] == [smooth.OWN_FORCE]
    even, odd, load = smooth.smooth_functions(scene(y=np.cos(T), base=np.cos(T)[:, None]))[:3]
    assert odd.columns == pytest.approx(even.columns * WAY[:, None])
    assert load.columns == pytest.approx(even.columns * np.cos(T)[:, None], abs=1e-9)
    assert even.name == UNKNOWN and len(even.labels) == even.width and even.labels[0][1] == "N"
    static = forms(scene(dynamic=False))
    assert [d for d, _, _ in static].count("axis_angle") == 2
    sensors = smooth.smooth_functions(scene(SENSORS, {"effort": np.sin(T)}))
    assert {c.note for c in sensors} == {""}


@pytest.mark.parametrize(
    ("spans", "low", "high"),
    [
        (((0.0, 1.0), (0.2, 1.5), (0.4, 1.4)), 0.2, 1.4),  # as far as two files go
        (((0.0, 1.0), (2.0, 3.0)), 2.0, 2.0),  # which never meet
    ],
)
def test_a_function_ends_where_two_files_meet(spans: Any, low: float, high: float) -> None:
    x = np.concatenate([np.linspace(a, b, 50) for a, b in spans])
    files = np.repeat(np.arange(len(spans)), 50)
    s = drive(x, files=files)
    assert smooth._where_files_meet(s, x) is x
    s.problem.turned = np.ones(len(x), dtype=bool)
    assert smooth._where_files_meet(s, x) == pytest.approx(np.clip(x, low, high))
    s.problem.valid[:] = True
    s.problem.valid[-1] = s.problem.valid[0] = False
    told = smooth._where_files_meet(s, x)
    assert told.min() == pytest.approx(low) and told.max() == pytest.approx(high, abs=0.03)


def test_a_flexible_fit_has_all_but_the_time_with_loops_and_a_weight() -> None:
    """Asymmetry of two kinds, loops of four radii, a weight's sine and cosine."""
    few, n = X[:600], 600
    s = scene(x=few, turn=8.0, y=np.cos(T[:n]), base=np.ones((n, 1)))
    plain = smooth.plain(s)
    assert plain.shape == (n, 2 + 4 + 2)
    assert plain[:, 0] == pytest.approx(np.abs(s.view.direction))
    assert plain[:, 1] == pytest.approx(np.abs(s.view.speed))
    assert smooth.plain(scene(x=few)).shape == (n, 6)
    assert smooth.plain(scene(x=1.0 + T[:n] ** 2, turn=8.0)).shape == (n, 2)
    assert smooth.plain(scene(SENSORS, x=few, turn=8.0)).shape == (n, 0)
    wide = sum(c.width for c in smooth.smooth_functions(s) if c.domain != "time")
    assert smooth.flexible(s).shape == (n, wide + 8)


def test_an_axis_torque_may_be_any_function_of_speed_and_travel() -> None:
    n = 400
    x = 0.02 * np.sin(2 * np.pi * T[:n] / 3.0)
    s = drive(x, speed=np.linspace(-2.0, 2.0, n))
    session = np.repeat([0, 1], n // 2)
    pair: Any = Some(motion=Some(frame=Some(session=session)))
    powers, knots, held, *each = smooth._torques(replace(s, pair=pair))
    w = s.view.speed / np.quantile(np.abs(s.view.speed), 0.95)
    assert powers.columns == pytest.approx(np.column_stack([np.sign(w) * w**2, w**3]))
    assert [name for name, _ in powers.labels] == ["square", "cube"] and powers.domain == "velocity"
    assert knots.domain == "velocity" and knots.width == len(knots.labels) > 5
    assert held.width == 5 == len(each) and {c.domain for c in (held, *each)} == {"reversal"}
    assert [c.fixed["travel"] for c in each] == [(r, "rad") for r in smooth.LOOPS]
    for k, c in enumerate(each):
        assert np.array_equal(c.columns[:, 0], held.columns[:, k]) and np.abs(c.columns).max() <= 1.0 + 1e-9
        assert c.columns[0, 0] == c.columns[n // 2, 0] == 0.0  # at rest where a session begins
    still = smooth._torques(replace(drive(x, speed=np.zeros(n)), pair=pair))
    assert not still[0].columns.any()


def test_any_friction_curve_is_powers_of_the_speed() -> None:
    s = scene(speed=np.linspace(-2.0, 2.0, ROWS))
    z = s.view.speed / np.quantile(np.abs(s.view.speed), 0.98)
    assert smooth.any_friction_curve(s) == pytest.approx(np.column_stack([z**k for k in (2, 3, 4, 5)]))
    assert not smooth.any_friction_curve(scene(speed=np.zeros(ROWS))).any()


def test_which_shapes_stand_beside_the_names(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("of_volts", "moving_scale", "spring", "lost_motion", "bend"):
        monkeypatch.setattr(smooth.shapes, name, lambda s, name=name: [name])
    for name in ("coupling", "_swings", "_torques", "_fixed_lines"):
        monkeypatch.setattr(smooth, name, lambda s, name=name: [name])
    s = Some(windings=None, pair=None, force=True)
    drive_ = ["moving_scale", "spring", "lost_motion", "bend", "coupling", "_swings"]
    assert smooth.columns(s) == drive_ and smooth.columns(Some(**{**vars(s), "windings": 1})) == ["of_volts"]
    assert smooth.columns(Some(**{**vars(s), "pair": 1})) == ["_torques", "_fixed_lines"]
    assert smooth.columns(Some(windings=None, pair=1, force=False)) == []


def test_a_bracket_swings_with_a_pair_of_sines_in_every_file(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = [Some(width=4, name="a"), Some(width=2, name="b")]
    monkeypatch.setattr(smooth, "lines", lambda s, follows: lines)
    monkeypatch.setattr(smooth, "replace", lambda c, **more: (c.name, more))
    two = scene(SENSORS, files=np.repeat([0, 1], ROWS // 2), y=np.zeros(ROWS))
    told = [("a", {"name": UNKNOWN, "domain": "time", "twins": ()})]
    assert smooth._swings(two) == told and smooth._swings(scene()) == []
    assert smooth._swings(scene(SENSORS, x=T)) == []  # one way


def test_lines_of_a_fixed_frequency_come_alone_and_with_harmonics() -> None:
    """Of 2.5 Hz, in a minute of rows at 100 a second."""
    n = 6000
    t = PERIOD_S * np.arange(n)
    y = np.cos(2 * np.pi * 2.5 * t) + 0.01 * np.random.default_rng(1).standard_normal(n)
    s = drive(np.sin(t), residual=y, held=t > 50)
    found = smooth._fixed_lines(s)
    one, five = found[:2]
    f = one.frequency or 0.0
    assert f == pytest.approx(2.5, abs=0.01) and one.fixed == {"frequency": (f, "Hz")}
    assert (one.width, five.width, one.domain, one.kind) == (2, 10, "time", "line")
    x = 2 * np.pi * f * t
    assert one.columns == pytest.approx(np.column_stack([np.cos(x), np.sin(x)]))
    assert five.columns[:, -1] == pytest.approx(np.sin(5 * x))
    quick = drive(np.sin(t), residual=np.cos(2 * np.pi * 30.0 * t))
    assert [c.width for c in smooth._fixed_lines(quick)[:1]] == [2]
    slow = drive(np.sin(t), residual=np.cos(2 * np.pi * 0.04 * t))  # less than four cycles
    assert all((c.frequency or 0.0) >= 4 / 60 for c in smooth._fixed_lines(slow))


@pytest.mark.parametrize(("jumps", "told"), [((), None), ((0.5, -1.5, 1.0), 1.0)])
def test_stamps_that_jump_are_the_clock_s_fault(jumps: tuple[float, ...], told: float | None) -> None:
    """Each is one in as many rows as it is long."""
    f = smooth.clock_jumps(Some(jumps=list(jumps), period_s=0.01))
    assert (f is None) == (told is None)
    if f is not None:
        assert f.parameters["jump"].value == pytest.approx(told) and f.parameters["jump"].unit == "s"
        assert f.evidence == pytest.approx(np.log10(51) + np.log10(151) + np.log10(101))
        assert f.note.startswith("3 stamps jump while the position goes on by one row")
