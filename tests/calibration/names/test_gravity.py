"""Which forces a log cannot tell from a weight: those that a stage of one turn is declared to have."""

import pytest

from calibration.inputs.declaration import Stage
from calibration.names.gravity_imbalance import forces_once_a_turn


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        (None, ("gear_eccentricity",)),
        ("unknown", ("gear_eccentricity", "gear_mesh", "motor_cogging")),
        ("motor", ("gear_eccentricity",)),
        ("motor_cogging", ("motor_cogging",)),
        ("encoder_eccentricity", ()),
    ],
)
def test_a_weight_has_the_force_of_a_stage_of_one_turn_as_its_twin(
    kind: str | None, names: tuple[str, ...]
) -> None:
    stages = [Stage("a", 360.0, None, 2, kind), Stage("b", 36.0, None, 2, "gear_mesh")]
    assert forces_once_a_turn(stages, 360.0) == names
    assert forces_once_a_turn([stages[0], stages[0]], 360.0) == names
