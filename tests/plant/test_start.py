"""Where things stand at the start: axes in steps of their absolute encoders, the focus in half steps."""

from math import pi

import pytest

from plant.plant import Plant
from tests.plant.bench import bare, changed


def test_axes_start_where_they_are_put() -> None:
    plant = Plant(bare(), 1, {"ra": 2.0**27, "dec": 1000.0})
    assert plant.ra.absolute(0) == pytest.approx(2**27, abs=1)
    assert plant.dec.absolute(0) == pytest.approx(1000, abs=1)
    assert plant.ra.truth(0)[0] == pytest.approx(pi / 2)  # of 29 bits a quarter of a turn
    rest = Plant(bare(), 1)
    assert (rest.ra.truth(0)[0], rest.dec.truth(0)[0]) == (0.0, 0.0)


def test_an_encoder_of_fewer_bits_has_wider_steps() -> None:
    """Of 20 bits in the place of 29, of 14 in the place of 17."""
    few = changed(bare(), encoders__absolute=20.0, encoders__auxiliary=14.0)
    plant = Plant(few, 1, {"ra": 2.0**18})
    assert plant.ra.truth(0)[0] == pytest.approx(pi / 2)
    assert plant.ra.absolute(0) == pytest.approx(2**18, abs=1)
    assert 0 <= plant.ra.auxiliary(0) < 2**14
    assert plant.ra.auxiliary(0) == pytest.approx(
        Plant(bare(), 1, {"ra": 2.0**27}).ra.auxiliary(0) / 8, abs=1
    )


def test_the_focus_starts_in_the_middle_unless_it_is_said() -> None:
    model = bare()
    assert Plant(model, 1).focus.position_m(0) == 0.0
    f = model.focus  # half steps of a motor, through a belt, onto a screw
    moved = 400.0 / f.half_steps.si / f.belt_ratio.si * f.screw_lead.si
    assert Plant(model, 1, {"focus": 400.0}).focus.position_m(0) == pytest.approx(moved)
    assert Plant(model, 1, {"focus": -400.0}).focus.position_m(0) == pytest.approx(-moved)


def test_a_name_that_nothing_has_is_refused() -> None:
    with pytest.raises(ValueError, match="'hour' is not known; expected ra, dec, focus"):
        Plant(bare(), 1, {"hour": 1.0})
