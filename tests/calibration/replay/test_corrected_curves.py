"""Curves of what has no name, the facts a plant file needs, and what is written and run when."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.finding import Curve, Finding, Parameter
from calibration.inputs.train import MESH, SHAFT
from calibration.look.looked import Looked, Options
from calibration.names.inplant import Facts
from calibration.replay import corrected as module
from calibration.replay.corrected import (
    correct_and_replay,
    curve_of,
    facts_of,
    knots_over,
    twists,
    with_curves,
)
from calibration.replay.held import Replay
from plant.gears import RATIO
from plant.model import load, with_effects
from tests.calibration.report.drawn import effect, fit, problem, selection

N = 600
U = np.linspace(-2.0, 4.0, N)


def test_knots_are_even_but_over_speed_denser_about_zero() -> None:
    assert knots_over("axis_angle", U) == pytest.approx(np.linspace(-2.0, 4.0, 24))
    low, high = -1e-3, 4e-3
    found = knots_over("velocity", np.array([high, 0.0, low]))
    assert (found[0], found[-1], len(found)) == (pytest.approx(low), pytest.approx(high), 24)
    z = np.sign(found) * np.log1p(np.abs(found) / 5e-5)  # even in the logarithm beyond 5e-5 rad/s
    assert np.diff(z) == pytest.approx(np.full(23, (np.log1p(high / 5e-5) + np.log1p(-low / 5e-5)) / 23))


def view(**columns: np.ndarray) -> Any:
    zero = np.zeros(N)
    return SimpleNamespace(columns=columns, x=U, speed=zero, clock=zero, rows=np.arange(N))


def curve(
    domain: str = "axis_angle", kind: str = "linear", spread: float = 0.0, held: int = 0, **more: Any
) -> Curve | None:
    """Of a column that bends once, -3 U beyond 1, with the coefficient 2."""
    column = np.where(U > 1.0, -3.0 * (U - 1.0), 0.0)
    p = problem(more.pop("y", np.zeros(N)), held, block_s=6.0)
    after = replace(fit(np.zeros(N), 2.0), covariance=np.array([[spread**2]]))
    s = selection(p, replace(effect(column, "unknown", kind=kind), domain=domain), after=after)
    return curve_of(s, 0, more.pop("view", view()))


def test_a_curve_adds_what_the_balance_lacks_the_other_way() -> None:
    found = curve()
    assert found is not None and (found.domain, found.unit, len(found.x)) == ("axis_angle", "N m", 24)
    x = np.array(found.x)
    inside = np.abs(x - 1.0) > 0.4
    assert np.array(found.y)[inside] == pytest.approx(6.0 * np.maximum(x - 1.0, 0.0)[inside], abs=0.05)


def test_a_curves_half_width_is_of_the_blocks_and_the_models_own_error() -> None:
    """Three per cent of a value, or the coefficient's error; 50 blocks of twelve rows, less two."""
    t_48 = 2.0106  # tables of Student's t, 97.5 %
    exact, spread = curve(), curve(spread=0.5)
    assert exact is not None and spread is not None
    assert exact.half[-1] == pytest.approx(t_48 * 0.03 * exact.y[-1], rel=1e-3)
    size = np.hypot(0.03 * spread.y[-1], 0.5 * 3.0 * (spread.x[-1] - 1.0))
    assert spread.half[-1] == pytest.approx(t_48 * size, rel=0.05)
    few = curve(held=560)
    assert few is not None and few.half[0] == pytest.approx(
        3.1824 * 0.03 * abs(few.y[0]), rel=1e-3
    )  # t of three


def test_a_function_of_current_is_one_of_torque() -> None:
    found = curve("current", y=10.0 + U)
    assert found is not None and found.domain == "torque"
    assert [found.x[0], found.x[-1]] == pytest.approx([8.0, 14.0])
    other = curve("temperature", view=view(temperature=U + 20.0))
    assert other is not None and other.domain == "temperature" and other.x[0] == pytest.approx(18.0)


@pytest.mark.parametrize(
    "more", [{"kind": "line"}, {"domain": "moon"}, {"domain": "time"}, {"domain": "temperature"}]
)
def test_a_line_a_domain_without_a_column_and_one_that_stands_have_no_curve(more: dict[str, Any]) -> None:
    assert curve(**more) is None


def test_only_functions_without_a_name_of_an_axis_torque_have_a_curve(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def made(s: Any, k: int, view: Any) -> Curve:
        asked.append((k, view))
        return Curve("time", "N m", (), (), ())

    monkeypatch.setattr(module, "curve_of", made)
    column = np.ones(N)
    s = selection(
        problem(np.zeros(N)), effect(column, "drag"), effect(column, "unknown"), effect(column, "unknown")
    )
    result: Any = SimpleNamespace(selections={"T": s}, views={"T": "the view"})
    effects = [
        Finding("unknown", "T", "time"), Finding("unknown", "T", "velocity"), Finding("unknown", "K", "time"),
        Finding("drag", "T", "time"),
    ]  # fmt: skip
    looked = Looked(title="", header={"axis": "ra"}, axis=result, effects=effects)
    found = with_curves(looked).effects
    assert [f.curve is not None for f in found] == [True, False, False, False] and asked == [(1, "the view")]
    for other in (replace(looked, header=None), replace(looked, axis=None)):
        assert with_curves(other) is other
    bare = replace(looked, axis=SimpleNamespace(selections={}, views={}))  # type: ignore[arg-type]
    assert with_curves(bare) is bare


MODEL = with_effects(load("low_preload"), "ra", [])


def result_of(**more: Any) -> Any:
    run = SimpleNamespace(name="run1", header={"axis": "ra"})
    motion = SimpleNamespace(x=np.array([1.0, 2.0, 4.0, 99.0]), rows=np.array([0, 1, 2]))
    frame = SimpleNamespace(runs=[run], t=np.array([5.0, 6.0, 9.0, 99.0]), scale={"supply_V": 36.0})
    plain: dict[str, Any] = {"frame": frame, "motion": motion, "torque": None, "selections": {},
             "held": "held", "declared": SimpleNamespace(ripple=None, lines=())}  # fmt: skip
    return SimpleNamespace(**(plain | more))


def test_the_facts_of_a_log_stand_beside_the_findings() -> None:
    part = MODEL.axes.ra
    loop = part.motor.loop
    torque = SimpleNamespace(drive=SimpleNamespace(per_ampere=77.0))
    found = facts_of(result_of(torque=torque), {"resistance": Parameter(loop + 0.5, "ohm")}, MODEL, "a log")
    assert (found.name, found.axis, found.span) == ("a log", "ra", 3.0)
    assert found.middle == pytest.approx(7 / 3)
    assert (found.duration_s, found.supply, found.per_ampere) == (4.0, 36.0, 77.0)
    assert found.half_play == pytest.approx(0.5 * part.gear.backlash.si * RATIO)
    assert found.resistance == loop + 0.5 and found.winding == pytest.approx(0.5 + part.motor.resistance.si)
    assert found.warming == MODEL.environment.warming.si and found.twists == {}
    plain = facts_of(result_of(), {}, MODEL, "a log")
    assert (plain.resistance, plain.per_ampere) == (loop, 140.0)
    assert facts_of(result_of(), {"resistance": Parameter(0.0, "ohm")}, MODEL, "a log").winding == 0.1
    still = result_of()
    still.frame.t = np.zeros(4)
    assert facts_of(still, {}, MODEL, "a log").duration_s == 1.0


def test_a_twist_is_a_gears_line_that_both_trains_show(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = {"amplitude": Parameter(3.0, "arcsec"), "phase": Parameter(0.5, "rad")}
    monkeypatch.setattr(module, "parameters_of", lambda s, k: sizes if k in (0, 4) else {})
    both, one = np.ones(8), np.where(np.arange(8) < 4, 1.0, 0.0)
    candidates = [
        effect(both, MESH, stage="mesh2", harmonic=2),
        effect(one, MESH, stage="a"), effect(1 - one, SHAFT, stage="b"),
        effect(both, "drag", stage="c"), effect(both, SHAFT, stage="d"), effect(both, SHAFT),
    ]  # fmt: skip
    s = selection(problem(np.zeros(8)), *candidates)
    assert twists(result_of(selections={"K": s})) == {("mesh2", 2): (3.0, 0.5), ("d", 1): (3.0, 0.5)}


def looked(**more: Any) -> Looked:
    header = {"axis": "ra", "preload": "low", "note": ""}
    return Looked(**({"title": "", "header": header, "axis": result_of()} | more))


def written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, found: Looked, run: bool = True
) -> tuple[Replay, dict[str, Any]]:
    got: dict[str, Any] = {"told": []}

    def replayed(*given: Any) -> Replay:
        got["replay"] = given
        return Replay(reasons=["replayed"])

    def plant(out: Path, model: Any, calibrated: Any, effects: Any, facts: Facts, skip: Any) -> Any:
        got["plant"] = (out, calibrated, effects, facts, skip)
        out.write_text("")
        return "corrected", ["a remark"]

    monkeypatch.setattr(module, "replay", replayed)
    monkeypatch.setattr(module, "write_plant", plant)
    monkeypatch.setattr(module, "load", lambda path: MODEL)
    monkeypatch.setattr(module, "declared_model", lambda header, path: (MODEL, False))
    monkeypatch.setattr(module, "calibrate_model", lambda *given: (given, []))
    monkeypatch.setattr("plant.compensation.write", lambda out, *_: got.update(compensation=out))
    options = Options(out=tmp_path, replay=run, tell=got["told"].append)
    return correct_and_replay(found, options), got


def test_a_drive_that_the_emulator_does_not_run_has_no_plant(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    again, got = written(monkeypatch, tmp_path, Looked(title=""))
    assert again.reasons == () and set(got) == {"told"}
    again, got = written(monkeypatch, tmp_path, looked(axis=None))
    assert got["plant"] == (tmp_path / "plant.yaml", {}, [], Facts("cannot tell", "ra"), [])
    assert again.reasons == () and "replay" not in got and "compensation" not in got


def test_the_corrected_plant_is_written_and_run_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    found = looked(effects=[Finding("drag", "T", "time")], not_identifiable=["viscous"])
    again, got = written(monkeypatch, tmp_path, found)
    _, calibrated, effects, facts, skip = got["plant"]
    assert (calibrated, effects, skip, facts.name) == ({}, found.effects, ["viscous"], "run1")
    assert got["compensation"] == tmp_path / "compensation.yaml" and got["told"] == [
        "running the closed loop again"
    ]
    assert again.reasons == ["replayed", "a remark"]
    _, held, declared, corrected, per_ampere, mean = got["replay"]
    assert (held, corrected, per_ampere, mean) == ("held", "corrected", 0.0, False) and declared[3:] == (
        "run1",
        ["viscous"],
    )
    silent, got = written(monkeypatch, tmp_path, found, run=False)
    assert silent.reasons == ["a remark"] and "replay" not in got and got["told"] == []


def test_mean_currents_are_those_of_a_declared_or_a_fitted_ripple(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    torque = SimpleNamespace(drive=SimpleNamespace(per_ampere=77.0))
    e = SimpleNamespace(
        chosen=[], problem=SimpleNamespace(base_labels=[("resistance", "ohm"), ("current_ripple", "A")])
    )
    declared = SimpleNamespace(ripple=0.1, lines=())
    for more, mean in (({"declared": declared}, True), ({"selections": {"E": e}}, True), ({}, False)):
        given = result_of(torque=torque, **more)
        got = written(monkeypatch, tmp_path, looked(axis=given))[1]["replay"]
        assert got[4:] == (77.0, mean)
