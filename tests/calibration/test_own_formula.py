"""Names that are found by the effect's own formula alone."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.inputs.declaration import FrictionLaw, Stage
from calibration.names.own import fits, from_formula, own_candidates
from calibration.names.scene import Scene
from plant.effects import REGISTRY

ANGLES = np.linspace(0.1, 3.0, 50)


def scene(**declared: float) -> Scene:
    """A rig in rad whose filter does nothing, moving forwards."""
    view = SimpleNamespace(t=np.arange(50.0), x=ANGLES, speed=np.full(50, 0.3), turn=2 * np.pi)
    same: Any = lambda full: full  # noqa: E731
    given = {"view": view, "pair": None, "declared": declared, "unit": "N m", "at": same, "answer": same}
    return cast(Scene, SimpleNamespace(sliding=SimpleNamespace(law=FrictionLaw()), **given))


def first(name: str, size: str, stage: Stage | None = None, **tried: tuple[float, ...]) -> list[Candidate]:
    return own_candidates(REGISTRY[name], size, tried, scene(coulomb=10.0, viscous=2.0), stage)


def test_columns_are_the_torque_that_the_motors_must_give() -> None:
    found = first("gravity_imbalance", "amplitude", phase=(0.5, 1.5))
    for candidate, phase in zip(found, (0.5, 1.5), strict=True):
        # effects.md, catalogue: T = A cos(angle - phase), positive accelerates
        assert candidate.columns[:, 0] == pytest.approx(-np.cos(ANGLES - phase))
        assert candidate.fixed == {"phase": (phase, "rad")}
        assert candidate.labels == (("amplitude", "N m"),)


def test_a_tried_value_stays_within_its_bounds() -> None:
    (one,) = first("gravity_imbalance", "amplitude", phase=(0.5,))
    assert one.shape is not None
    assert one.shape(np.array([99.0]))[:, 0] == pytest.approx(-np.cos(ANGLES - 3.2))


def test_a_step_is_a_part_of_the_way_to_the_next_value() -> None:
    found = first("gravity_imbalance", "amplitude", phase=(0.0, 0.5, 2.5))
    assert [c.steps for c in found] == [pytest.approx((x,)) for x in (0.05, 0.05, 0.2)]


def test_a_stage_gives_the_formula_its_order() -> None:
    stage = Stage("worm", 2 * np.pi / 7, None, 2, "gear_mesh")
    (one,) = first("gear_mesh", "amplitude", stage, phase=(0.0,))
    assert one.columns[:, 0] == pytest.approx(-np.sin(7 * ANGLES))
    assert (one.stage, one.harmonic, one.order) == ("worm", 1, pytest.approx(7.0))


def test_friction_is_the_change_of_its_torque_along_the_motion() -> None:
    (one,) = first("viscous_change", "factor")
    # effects.md, catalogue: sigma2 -> factor sigma2; at a factor of one nothing changes
    assert one.columns[:, 0] == pytest.approx(np.zeros(50))
    (one,) = first("position_friction", "amplitude", Stage("axis", 2 * np.pi, None, 1, None), phase=(0.5,))
    assert one.columns[:, 0] == pytest.approx(np.cos(ANGLES - 0.5))


def test_a_mesh_sits_on_a_mesh_and_a_shaft_on_a_shaft() -> None:
    mesh, shaft = Stage("teeth", 1.0, None, 1, "gear_mesh"), Stage("screw", 1.0, None, 1, None)
    assert [fits(REGISTRY["gear_mesh"], g) for g in (mesh, shaft)] == [True, False]
    assert [fits(REGISTRY["damaged_tooth"], g) for g in (mesh, shaft)] == [False, True]
    assert fits(REGISTRY["gear_mesh"], Stage("mesh2", 1.0, None, 1, None))


@pytest.mark.parametrize("name", ["shaft_compliance", "adc_offset", "channel_delay"])
def test_what_is_no_torque_at_the_axis_and_no_friction_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name}: only a torque at the axis, or its friction"):
        from_formula(name, size="torque", tried={}, experiment="none")
