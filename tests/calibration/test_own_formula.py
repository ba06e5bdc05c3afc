"""Names that are found by the effect's own formula alone."""

import numpy as np
import pytest

from calibration.names.name import OwnFormula
from calibration.names.own import from_formula, own_candidates
from plant.effects.signals import ANGLE, TIME

ANGLES = np.linspace(0.0, 3.0, 50)


def test_columns_are_the_torque_that_the_motors_must_give() -> None:
    own = OwnFormula("amplitude", {"phase": (0.5, 1.5)})
    along = {TIME: np.arange(50.0), ANGLE: ANGLES}
    first, second = own_candidates("gravity_imbalance", own, along, lambda full: full)
    for candidate, phase in ((first, 0.5), (second, 1.5)):
        # effects.md, catalogue: T = A cos(angle - phase), positive accelerates
        assert candidate.columns[:, 0] == pytest.approx(-np.cos(ANGLES - phase))
        assert candidate.fixed == {"phase": (phase, "rad")}
        assert candidate.labels == (("amplitude", "N m"),)


def test_a_tried_value_stays_within_its_bounds() -> None:
    own = OwnFormula("amplitude", {"phase": (0.5,)})
    (one,) = own_candidates("gravity_imbalance", own, {TIME: np.arange(50.0), ANGLE: ANGLES}, lambda x: x)
    assert one.shape is not None
    assert one.shape(np.array([99.0]))[:, 0] == pytest.approx(-np.cos(ANGLES - 3.2))


@pytest.mark.parametrize("name", ["brake_drag", "gear_eccentricity", "adc_offset"])
def test_what_is_no_plain_torque_at_the_axis_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name}: only a torque at the axis"):
        from_formula(name, "torque", {}, (), "none")
