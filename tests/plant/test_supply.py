"""One supply for both axes: Ohm's law by hand, and nothing shared where it is stiff."""

import numpy as np
import pytest

from plant import model
from plant.kernels import layout as at
from plant.kernels.advance import advance, advance_axis
from plant.plant import Plant
from scenarios.lab.nodes import CHANNELS, Supply
from tests.plant.bench import SECOND, bare

LOOP_OHM = 2.2 + 0.085 + 0.1  # motor, switch and sense resistor of low_preload.yaml
RESISTANCE_OHM = 0.4


def pulled(ra: float, dec: float, resistance: float = RESISTANCE_OHM) -> Plant:
    """Both motors of an axis pull against each other at the same duty for half a second: nothing turns."""
    plant = Plant(model.with_value(bare(), "supply.resistance", resistance), 1)
    plant.ra.drive(0, ra, ra)
    plant.dec.drive(0, dec, dec)
    plant.advance(SECOND // 2)
    return plant


@pytest.mark.parametrize(("ra", "dec"), [(0.0, 0.5), (1.0, 0.5), (0.3, 0.3), (1.0, 1.0)])
def test_P4_both_axes_draw_through_one_resistance(ra: float, dec: float) -> None:
    plant = pulled(ra, dec)
    # a motor takes D V / R from its stage, and its stage D times that from the supply; there are two an axis
    volts = 24.0 / (1.0 + RESISTANCE_OHM * 2.0 * (ra**2 + dec**2) / LOOP_OHM)
    assert plant.rail(plant.now_ns) == pytest.approx(volts, rel=1e-6)
    for row, duty in enumerate((ra, dec)):
        for motor in (0, 1):
            current = plant.world[row, at.MOTORS + motor * at.MOTOR_SIZE + at.M_CURRENT]
            assert current == pytest.approx(duty * volts / LOOP_OHM, rel=1e-6, abs=1e-9)


def test_P4_a_stiff_supply_leaves_each_axis_alone() -> None:
    plant = Plant(model.load("low_preload_bridge"), 1)
    plant.ra.drive(0, 0.9, 0.0)
    plant.dec.drive(0, 0.0, 0.3)
    alone = plant.world.copy()
    advance(plant.world, 2000)
    for row in alone:
        advance_axis(row, 2000)
    assert plant.world[:, at.SUPPLY_CURRENT].min() > 0.0  # each would have felt the other
    assert np.array_equal(plant.world, alone)


def test_B8_the_drives_board_measures_the_sag_and_the_rooms_does_not() -> None:
    plant = pulled(1.0, 1.0)
    drives, room = (Supply(plant, {}, CHANNELS[name]) for name in ("POWER_DRIVES", "POWER_ROOM"))
    volts = 24.0 / (1.0 + RESISTANCE_OHM * 4.0 / LOOP_OHM)
    assert drives.voltage(plant.now_ns) == pytest.approx(volts, rel=1e-6)
    assert room.voltage(plant.now_ns) == 24.0


def test_a_file_without_the_resistance_has_a_stiff_supply_and_keeps_one_that_it_is_given() -> None:
    plain = model.load("low_preload_bridge")
    assert plain.supply.resistance.si == 0.0
    given = model.with_value(plain, "supply.resistance", 0.25)
    assert model.loads(model.dumps(given)).supply.resistance.si == 0.25
