"""An axis with one effect of each kind, ready to be exported; for tests."""

from plant import model
from plant.fmu.variables import Exported, exported
from plant.parts import EffectModel, Number

EFFECTS = (
    EffectModel("gear_mesh", "mesh1", 2, {"amplitude": Number(500.0, "N mm motor", "a test")}),
    EffectModel("sample_loss"),  # acts in the host's log alone
    EffectModel("encoder_eccentricity", "axis", enabled=False),
    EffectModel("winding_heating"),
    EffectModel("channel_delay"),
    EffectModel("shaft_compliance"),
    EffectModel("play"),  # has a parameter that says where it acts
    EffectModel("cable_wrap", parameters={"width": Number(0.5, "deg", "a test")}),
)
DECLARED = 39
"""Numbers of an axis before those of its effects: 30 of its file, 5 of effects, 4 of the start."""


def axis() -> Exported:
    """Right ascension of a plant file, with these effects."""
    return exported(model.with_effects(model.load("low_preload"), "ra", EFFECTS), "ra", 3)
