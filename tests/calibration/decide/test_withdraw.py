"""Names that findings keep, lose, or bear in another form once everything has been tried."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.decide.selection import Selection
from calibration.decide.withdraw import (
    accepted,
    against_nature,
    as_told,
    failed_controls,
    of_calibrated,
    unnamed,
    withdraw,
)
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.names.friction_warmup import OF_COULOMB
from calibration.names.scene import Scene
from tests.calibration.decide.made import problem


def one(name: str, channel: str = "T", domain: str = "axis_angle", **more: Any) -> Finding:
    return Finding(name, channel, domain, **more)


def control(what: str, f: Finding, accepted: bool = True, **more: Any) -> dict[str, Any]:
    place = {"name": f.name, "stage": f.stage, "harmonic": f.harmonic}
    return {"what": what, "accepted": accepted, **place, **more}


MESH = one("gear_mesh", stage="mesh1", harmonic=2, order=3.0)


def test_controls_of_the_name_and_place_or_of_the_order_count_where_they_were_accepted() -> None:
    elsewhere: dict[str, Any] = {"name": "brake_drag", "stage": None, "harmonic": None}
    some = [
        control("time reversed (gear_mesh on mesh1)", MESH),
        control("sign flipped (gear_mesh on mesh1)", MESH, accepted=False),
        control("one tooth more (gear_mesh)", MESH, harmonic=3),
        control("order 3.2 in place of 3 (brake_drag)", MESH, **elsewhere),
        control("order 4.2 in place of 4 (brake_drag)", MESH, **elsewhere),
        control("order 2.8 in place of 3 (brake_drag)", MESH, accepted=False, **elsewhere),
    ]
    assert accepted(MESH, some) == ["time reversed", "order 3.2 in place of 3"]
    of_no_order = one("gear_mesh", stage="mesh1", harmonic=2)
    assert accepted(of_no_order, some) == ["time reversed"]
    assert failed_controls(some)(MESH) == "accepted as well with time reversed, order 3.2 in place of 3"
    assert failed_controls([])(MESH) == ""


def test_the_first_reason_withdraws_a_name_and_says_its_place() -> None:
    drag, wrap = one("brake_drag"), one("cable_wrap", "K")

    def no_drag(f: Finding) -> str:
        return "no drag" if f.name == "brake_drag" else ""

    def no_torque(f: Finding) -> str:
        return "no torque" if f.channel == "T" else ""

    kept, refused = withdraw([drag, wrap, MESH], no_drag, no_torque)
    assert kept == [wrap]
    assert refused == [
        ("T", "brake_drag", "withdrawn: no drag"),
        ("T", "gear_mesh on mesh1", "withdrawn: no torque"),
    ]


@pytest.mark.parametrize(("size", "withdrawn"), [(-1.0, True), (1.0, False)])
def test_beside_a_friction_that_drives_no_name_of_its_channel_stands(size: float, withdrawn: bool) -> None:
    rng = np.random.default_rng(8)
    a = rng.standard_normal(1200)
    p = problem(size * a + 0.1 * rng.standard_normal(1200), a[:, None])
    p.base_labels = [("viscous", "N m s")]
    says = against_nature({"T": Selection.of(p)})
    assert says(one("brake_drag", "K")) == ""
    why = says(one("brake_drag"))
    assert bool(why) is withdrawn
    if withdrawn:
        first, value, unit = why.rsplit(" ", 3)[0], float(why.split()[-4]), why.rsplit(" ", 3)[1:]
        assert first.startswith("beside it viscous would be")
        assert value == pytest.approx(size, abs=0.05) and unit == ["N", "m", "s"]


def test_what_loses_its_name_on_a_rig_stays_as_unknown() -> None:
    wrong = [control("time reversed (gear_mesh)", MESH), control("order 3.2 in place of 3 (gear_mesh)", MESH)]
    drag = one("brake_drag", equivalent=["cable_wrap"])
    gone, kept = unnamed([MESH, drag], wrong)
    assert kept == drag
    assert (gone.name, gone.stage, gone.harmonic, gone.order) == (UNKNOWN, None, None, 3.0)
    assert gone.note == "time reversed fits as well: the name gear_mesh is withdrawn."
    nameless = one(UNKNOWN, equivalent=["brake_drag"])
    assert unnamed([nameless], [control("time reversed (unknown)", nameless)]) == [nameless]


def scene(force: bool = True, stroke: float = 20.0, unit: str = "deg") -> Scene:
    view = SimpleNamespace(rig=SimpleNamespace(stages=()), response=SimpleNamespace(is_speed=False))
    made = SimpleNamespace(force=force, stroke=stroke, angle_unit=unit, pair=None, both=True, view=view)
    return cast(Scene, cast(Any, made))


def loop(name: str, key: str, travel: float, **more: Any) -> Finding:
    sizes = {key: Parameter(travel, "deg"), "torque": Parameter(1.0, "N m")}
    return one(name, domain="reversal", parameters=sizes, equivalent=["brake_drag"], **more)


@pytest.mark.parametrize(
    ("name", "key"), [("play", "gap"), ("presliding", "breakaway_travel"), ("presliding", "bristle_travel")]
)
def test_a_loop_over_more_than_a_twentieth_of_the_stroke_has_no_name(name: str, key: str) -> None:
    narrow = loop(name, key, 1.0)
    assert as_told([narrow], scene(stroke=20.0)) == [narrow]
    (wide,) = as_told([loop(name, key, 1.01)], scene(stroke=20.0))
    assert (wide.name, wide.equivalent) == (UNKNOWN, [])
    assert wide.note == "a loop of 1.01 deg after every reversal: too wide for bristles or gears"
    wrap = one("cable_wrap", parameters={"gap": Parameter(5.0, "deg")})  # no loop
    assert as_told([wrap], scene(stroke=20.0)) == [wrap]


@pytest.mark.parametrize(
    ("stroke", "unit", "named"),
    [(1e-3, "m", True), (1.5e-3, "m", False), (1.0, "mm", True), (1.5, "mm", False), (0.5, "deg", False)],
)
def test_bristles_may_fill_a_stroke_of_a_millimetre(stroke: float, unit: str, named: bool) -> None:
    (found,) = as_told([loop("presliding", "bristle_travel", stroke)], scene(stroke=stroke, unit=unit))
    assert found.name == ("presliding" if named else UNKNOWN)


def test_only_the_first_of_several_loops_of_a_force_is_an_effect() -> None:
    first, second = loop("play", "gap", 0.1), loop("presliding", "bristle_travel", 0.2)
    wrap, wave = one("cable_wrap", domain="reversal"), one("gear_mesh")
    told = as_told([wrap, wave, first, wrap, second, wave], scene())
    assert told == [wrap, wave, first.noted("its shape needs a second element (presliding)"), wrap, wave]
    nameless = one(UNKNOWN, domain="reversal")
    assert as_told([nameless, first], scene()) == [nameless.noted("its shape needs a second element (play)")]
    over_place = one("play", parameters=first.parameters)
    assert as_told([first, over_place], scene()) == [first, over_place]
    assert as_told([first, second], scene(force=False)) == [first, second]


@pytest.mark.parametrize("ends", [True, False])
def test_a_gap_below_nothing_is_one_of_the_sensors_taken_the_other_way_round(ends: bool) -> None:
    low, high = (-1.2, -0.7) if ends else (None, None)
    gap = Parameter(-1.0, "deg", low, high)
    (found,) = as_told([one("play", "K", parameters={"gap": gap})], scene())
    turned = Parameter(1.0, "deg", *((0.7, 1.2) if ends else (None, None)))
    assert found.parameters == {"gap": turned}
    assert found.note == "the column is the first sensor less the second"
    assert as_told([found], scene()) == [found]
    others = [
        one("play", "T", parameters={"gap": gap}),
        one("play", "K", parameters={"travel": gap}),
        one("play", "K", parameters={"gap": Parameter(0.0, "deg", -0.1, 0.1)}),
    ]
    assert as_told(others, scene()) == others


SPEED = np.array([-2.0, 4.0, 99.0])
OK = np.array([True, True, False])


def calibrated(f: Finding, final: dict[str, float], declared: float = 2.0, **more: Any) -> Finding:
    """Of a friction that was 6 on the rows that count, where the mean speed is 3."""
    response = SimpleNamespace(ratio=more.get("ratio"))
    view = SimpleNamespace(response=response, speed=SPEED, ok=more.get("ok", OK))
    sliding = SimpleNamespace(size=np.array([5.0, 7.0, 99.0]))
    made = SimpleNamespace(view=view, sliding=sliding, declared={"coulomb": declared} if declared else {})
    (found,) = of_calibrated([f], cast(Scene, cast(Any, made)), final)
    return found


def warm_up(**more: tuple[float, str]) -> Finding:
    sizes = {"depth": (-0.5, "1"), "time_constant": (60.0, "s"), **more}
    return one("friction_warmup", parameters={k: Parameter(*x) for k, x in sizes.items()})


@pytest.mark.parametrize(
    ("final", "now"),
    [
        ({"coulomb": 0.5, "viscous": 0.25}, 0.5 + 0.25 * 3.0),
        ({"coulomb": 3.0, "viscous": 2.0}, 3.0 + 2.0 * 3.0),
        ({"coulomb": 0.5}, 0.5),
        ({"coulomb": 0.5, "viscous": -1.0}, 0.5),
    ],
)
def test_a_part_of_the_friction_is_told_of_the_one_that_is_known_at_last(
    final: dict[str, float], now: float
) -> None:
    """The torque is the same: part times friction."""
    found = calibrated(warm_up(), final)
    assert found.parameters["depth"].value * now == pytest.approx(-0.5 * 6.0)
    assert found.parameters["time_constant"].value == 60.0


def test_a_part_of_what_knows_no_speed_is_told_of_coulombs_friction() -> None:
    part = warm_up(**{OF_COULOMB: (1.0, "")})
    for declared in (2.0, 0.5):
        found = calibrated(part, {"coulomb": 0.4, "viscous": 2.0}, declared)
        assert found.parameters["depth"].value * 0.4 == pytest.approx(-0.5 * declared)
    for declared in (0.0, -1.0):
        assert calibrated(part, {"coulomb": 0.5}, declared) == part


def test_sizes_in_a_torques_unit_are_no_parts_and_stay() -> None:
    sizes = {"coulomb_asymmetry": Parameter(0.3, "N m"), "viscous_asymmetry": Parameter(0.2, "1")}
    f = one("friction_asymmetry", parameters=sizes)
    found = calibrated(f, {"coulomb": 3.0})
    assert found.parameters["coulomb_asymmetry"].value == 0.3
    assert found.parameters["viscous_asymmetry"].value == pytest.approx(0.2 * 6.0 / 3.0)
    partial = one("friction_asymmetry", parameters={"coulomb_asymmetry": Parameter(0.3, "1")})
    assert calibrated(partial, {"coulomb": 3.0}).parameters["coulomb_asymmetry"].value == pytest.approx(0.6)


@pytest.mark.parametrize("final", [{}, {"coulomb": 0.0, "viscous": 1.0}, {"coulomb": -1.0, "viscous": 1.0}])
def test_of_no_friction_nothing_is_a_part(final: dict[str, float]) -> None:
    assert calibrated(warm_up(), final) == warm_up()
    assert calibrated(warm_up(), {"coulomb": 1.0}, ok=np.zeros(3, bool)) == warm_up()


@pytest.mark.parametrize(
    ("final", "ratio", "part"),
    [
        ({"scale": -0.5}, 4.0, 0.4),
        ({}, 4.0, 0.05),
        ({}, None, 0.2),
        ({"scale": 0.5, "coulomb": 1.0}, 4.0, 0.4),
    ],
)
def test_a_sensor_of_which_a_part_is_late_is_late_by_that_part(
    final: dict[str, float], ratio: float | None, part: float
) -> None:
    sizes = {"delay": Parameter(0.5, "s", 0.4, 0.6), "ratio": Parameter(-0.2, "1")}
    found = calibrated(one("channel_delay", "K", parameters=sizes), final, ratio=ratio)
    assert list(found.parameters) == ["delay"]
    delay = found.parameters["delay"]
    assert (delay.value, delay.low, delay.high) == pytest.approx((0.5 * part, 0.4 * part, 0.6 * part))
    whole = one("channel_delay", "K", parameters={"delay": sizes["delay"]})
    assert calibrated(whole, final, ratio=ratio) == whole
    other = one("play", "K", parameters=sizes)
    assert calibrated(other, final, ratio=ratio) == other
