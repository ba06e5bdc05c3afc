"""Friction that falls with the time or the temperature: the declared one times what is left of it."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.names.friction_warmup import NAME, OF_COULOMB, columns, lacks, to_plant
from calibration.names.inplant import Facts
from calibration.names.scene import Scene
from tests.calibration.names.made import back_and_forth, drive

X = back_and_forth()
BOTH = {"coulomb": 3.0, "viscous": 2.0}
STATED = {"estimate": ("coulomb", "viscous")}
SPAN_S = 19.99


def warming(declared: dict[str, float] = BOTH, rig: dict[str, Any] = STATED, **more: Any) -> Scene:
    return drive(X, declared=declared, rig=rig, **more)


def test_all_friction_or_what_knows_no_speed_falls_by_an_exponential_of_the_time() -> None:
    s = warming()
    found = columns(s)
    assert [c.fixed["time_constant"][0] for c in found] == pytest.approx(
        2 * [part * SPAN_S for part in (0.05, 0.1, 0.2, 0.4, 0.8)]
    )
    assert [OF_COULOMB in c.fixed for c in found] == [False] * 5 + [True] * 5
    assert found[5].fixed[OF_COULOMB][0] == 1.0
    fade = np.exp(-s.view.clock / (0.2 * SPAN_S))
    way, speed = s.view.direction, s.view.speed
    assert found[2].columns[:, 0] == pytest.approx(-fade * (3.0 * way + 2.0 * speed))
    assert found[7].columns[:, 0] == pytest.approx(-fade * 3.0 * way)
    assert all(c.sign == -1 and c.labels[0][0] == "depth" for c in found)
    assert found[2].steps == (pytest.approx(0.02 * SPAN_S),)


@pytest.mark.parametrize("declared", [{"coulomb": 3.0}, {"coulomb": 3.0, "viscous": 0.0}, {"viscous": 2.0}])
def test_of_one_kind_of_friction_there_is_no_part(declared: dict[str, float]) -> None:
    found = columns(warming(declared))
    assert len(found) == 5 and not any(OF_COULOMB in c.fixed for c in found)


def test_a_part_of_friction_is_told_however_small_it_is() -> None:
    assert len(columns(warming({"coulomb": 0.3, "viscous": 0.2}))) == 10


def test_a_depth_is_of_the_friction_that_was_declared() -> None:
    """Of twice the friction it is half as deep. A drive warms up once."""
    f = Finding(NAME.name, "T", "time", parameters={"depth": Parameter(-0.2, "")})
    assert NAME.retold(f, {"coulomb": 0.5}).parameters["depth"].value == pytest.approx(-0.1)
    assert NAME.beside.single


def test_a_time_constant_stays_within_the_log() -> None:
    s = warming()
    shape = columns(s)[0].shape
    assert shape is not None
    for asked, tau in ((1e9, SPAN_S), (0.0, 1e-3 * SPAN_S), (4.0, 4.0)):
        friction = 3.0 * s.view.direction + 2.0 * s.view.speed
        assert shape(np.array([asked]))[:, 0] == pytest.approx(-np.exp(-s.view.clock / tau) * friction)


def test_every_file_may_warm_up_by_itself() -> None:
    files = np.repeat([0, 1], 1000)
    names = [next(iter(c.fixed)) for c in columns(warming(files=files))]
    assert names == (["time_constant"] * 5 + ["time_constant_in_run"] * 5) * 2
    found = columns(warming(files=files))[5]
    # the speed is taken over both files where they meet
    assert found.columns[1:990] == pytest.approx(found.columns[1001:1990])
    ordered = columns(warming(files=files, in_order=True))
    assert {next(iter(c.fixed)) for c in ordered} == {"time_constant_in_run"} and len(ordered) == 10


def test_the_temperature_takes_its_mean_off() -> None:
    t = 20.0 + np.linspace(0, 3.0, len(X)) ** 2
    s = warming(columns={"temperature": t})
    c = columns(s)[-1]
    friction = 3.0 * s.view.direction + 2.0 * s.view.speed
    assert c.columns[:, 0] == pytest.approx((t - t.mean()) * friction)
    assert (c.domain, c.sign, c.labels) == ("temperature", -1, (("depth", "1/K"),))


def test_without_friction_that_is_stated_nothing_warms_up() -> None:
    said = "declared friction ('coulomb'), which changes"
    assert lacks(warming({})) == lacks(warming({"coulomb": -1.0})) == said
    assert lacks(warming(rig={})) == said and columns(warming(rig={})) == []
    assert lacks(warming(rig={"constants": {"coulomb": 3.0}})) == lacks(warming({"viscous": 1.0})) == ""


def test_two_motors_have_one_session_each_and_always_friction() -> None:
    """All from the start of its session, whatever the clock; no temperature."""
    clock = np.arange(6.0)
    session = np.array([0, 0, 0, 1, 1, 1])
    view = SimpleNamespace(clock=clock, rig=SimpleNamespace(estimate=(), constants={}))
    frame = SimpleNamespace(session=session)
    parts = {
        "view": view,
        "declared": {},
        "pair": SimpleNamespace(motion=SimpleNamespace(frame=frame)),
        "clocks": {"start": clock},
        "temperature": clock,
        "unit": "N m",
        "sliding": SimpleNamespace(steady=np.full(6, 2.0), drag=np.ones(6)),
        "answer": lambda x: x,
        "at": lambda x: x,
    }
    found = columns(cast(Scene, cast(Any, SimpleNamespace(**parts))))
    assert len(found) == 5
    since = np.tile(np.arange(3.0), 2)
    assert found[1].columns[:, 0] == pytest.approx(-3.0 * np.exp(-since / 0.2))


def test_a_plant_is_told_of_what_it_scales() -> None:
    sizes = {"depth": Parameter(-0.2, ""), "time_constant": Parameter(100.0, "s")}
    f = Finding(NAME.name, "T", "time", parameters=sizes)
    assert to_plant(f, Facts("a.log")).remarks == []
    part = to_plant(f.having(of_coulomb=Parameter(1.0, "")), Facts("a.log"))
    assert [r.partition(":")[0] for r in part.remarks] == ["friction_warmup"]
    assert "Tc, Ts and sigma2 alike" in part.remarks[0]
    assert part.effects[0].parameters["time_constant"].value == 100.0
