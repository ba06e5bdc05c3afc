"""A plant out of its model: late columns, effects of the log writer, the rail, first readings."""

from dataclasses import replace

import pytest

from plant import model
from plant.kernels import layout as at
from plant.model import PlantModel
from plant.parts import EffectModel, Number
from plant.plant import COLUMNS, Plant, delays_ns
from tests.plant.bench import bare


def late(column: int, seconds: float, enabled: bool = True) -> EffectModel:
    given = {"column": Number(float(column), "1", ""), "delay": Number(seconds, "s", "")}
    return EffectModel("channel_delay", parameters=given, enabled=enabled)


def of_dec(*effects: EffectModel) -> PlantModel:
    return model.with_effects(bare(), "dec", effects)


def test_delays_of_a_column_add_up() -> None:
    """Whole nanoseconds, by the catalogue's order: effort, position, velocity, currents, tachometers."""
    given = (late(1, 0.012), late(1, 0.0005), late(4, 0.1234567894), late(2, 0.05, enabled=False))
    found = delays_ns(of_dec(*given, EffectModel("sample_loss")).axes.dec)
    assert found == {"effort": 0, "position": 12_500_000, "velocity": 0, "currents": 0,
                     "tachometers": 123_456_789}  # fmt: skip
    assert tuple(found) == COLUMNS


def test_a_delay_fits_into_what_is_kept() -> None:
    """Of 512 steps of 0.5 ms all but two."""
    whole = (late(3, 0.12), late(3, 0.12), late(3, 0.015))
    plant = Plant(of_dec(*whole), 1)
    assert plant.world[:, at.DELAY_ON].tolist() == [0.0, 1.0]
    with pytest.raises(ValueError, match=r"^plant: axes\.dec: channel_delay beyond 0\.255 s$"):
        Plant(of_dec(*whole, late(3, 1e-9)), 1)


def test_the_log_writer_gets_what_acts_in_the_log_alone() -> None:
    """Of the delays that of the effort: the plant has no effort to delay."""
    loss = EffectModel("sample_loss", parameters={"repeats": Number(0.25, "1", "")})
    off = replace(loss, enabled=False)
    plant = Plant(of_dec(off, late(0, 0.004), EffectModel("gravity_imbalance"), late(1, 0.002), loss), 1)
    assert plant.log_effects("dec") == [
        ("channel_delay", {"column": 0.0, "delay": 0.004}),
        ("sample_loss", {"packet_loss": 0.02, "repeats": 0.25}),
    ]
    assert plant.log_effects("ra") == []


def test_the_rail_is_the_supply_less_what_both_axes_draw() -> None:
    plant = Plant(model.with_value(bare(), "supply.resistance", 0.4), 1)
    plant.world[:, at.SUPPLY_CURRENT] = [3.0, 2.0]
    assert plant.rail(0) == pytest.approx(24.0 - 0.4 * 5.0)
    plant.rail(3_000_000)
    assert plant.now_ns == 3_000_000


def test_readings_are_there_before_the_first_step() -> None:
    plant = Plant(bare(), 1, {"ra": 12345.5, "dec": 77.5, "focus": 8.0})
    assert (plant.world[0, at.STEP], plant.now_ns) == (0.0, 0)
    assert (plant.ra.absolute(0), plant.dec.absolute(0), plant.focus.position(0)) == (12345, 77, 8.0)
    assert Plant(bare(), 1).focus.position(0) == 0.0
