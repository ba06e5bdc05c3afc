"""A friction that the rig file neither estimates nor knows is missing from the model, as any other effect."""

from pathlib import Path

import pytest

from tests.calibration.test_drives import COULOMB, FORCE, VISCOUS, answer, motion


@pytest.mark.slow
@pytest.mark.parametrize(("term", "size", "unit"), [("coulomb", COULOMB, "N"), ("viscous", VISCOUS, "N s/m")])
def test_a_term_of_friction_that_nobody_declared_has_its_name_and_size(
    tmp_path: Path, term: str, size: float, unit: str
) -> None:
    (first, *more) = answer(tmp_path, FORCE.replace(f" {term},", ""), motion())["effects"]
    assert not more
    assert first["name"] == f"{term}_change"
    found = first["parameters"][f"{term}_change"]
    assert (found["value"], found["unit"]) == (pytest.approx(size, rel=0.05), unit)
