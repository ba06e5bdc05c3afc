"""What the table has rows for: plants with more in them than the declared one, and firmwares."""

from dataclasses import dataclass

from bus.protocol import AxisParameter
from plant.model import with_effects
from plant.parts import EffectModel, PlantModel
from plant.wind import wind

EFFECTS = ("motor_cogging", "torque_ripple", "pwm_deadband", "encoder_subdivision")
"""At the catalogue's default size (`schmidt effects NAME`)."""
PAPER = "the paper's firmware"
STARTS = 8
SPEEDS_M_S = (1.0, 3.0, 10.0)
"""Of the wind in the slit."""
FIRST_DEG, LAST_DEG = 85.0, 265.0
"""Of the absolute encoder: 95 deg before the middle of the travel to 85 deg after it."""


@dataclass(frozen=True)
class Case:
    """One row: which plant, what is added to it, which firmware, with the compensation table or not."""

    name: str
    effects: tuple[str, ...] = ()
    firmware: str = "fine"
    without: tuple[int, ...] = ()
    """Parameters of the firmware that are left out: the steps of a ladder."""
    compensated: bool = False
    high: bool = False
    wind_m_s: float = 0.0

    def plant(self, low: PlantModel, high: PlantModel) -> PlantModel:
        """The plant with the effects added to those it has."""
        model = high if self.high else low
        added = [EffectModel(name) for name in self.effects]
        if self.wind_m_s:
            added.append(wind(self.wind_m_s))
        return with_effects(model, "ra", (*model.axes.ra.effects, *added))


def cases(compensation: bool) -> tuple[Case, ...]:
    """Rows of the table; with a compensation file, those of the fine firmware once more with it."""
    rows = [Case(name=PAPER, firmware="paper"), Case(name="spread duty, bias, lock, blend")]
    if compensation:
        rows.append(Case(name="the same, compensated", compensated=True))
    for effect in EFFECTS:
        rows.append(Case(name=f"with {effect}", effects=(effect,)))
    rows.append(Case(name="with all four", effects=EFFECTS))
    rows.append(Case(name="with all four, the paper's firmware", effects=EFFECTS, firmware="paper"))
    rows.append(Case(name="high preload, the paper's firmware", firmware="paper", high=True))
    rows.append(Case(name="high preload, spread duty, bias, lock, blend", high=True))
    for speed in SPEEDS_M_S:
        name = f"wind of {speed:g} m/s"
        rows.append(Case(name=f"{name}, {PAPER}", firmware="paper", wind_m_s=speed))
        rows.append(Case(name=name, wind_m_s=speed))
    return tuple(rows)


RUNGS = (
    ("spread duty", AxisParameter.DUTY_FRACTION),
    ("locked rate", AxisParameter.RATE_LOCK),
    ("blended position", AxisParameter.POSITION_BLEND),
    ("bias", AxisParameter.COUNTER_BIAS_Q8),
)
"""In the order in which docs/results/one-arcsecond.md proposes them."""


def ladder() -> tuple[Case, ...]:
    """The firmware's changes one after the other, on the declared plant and with all four effects."""
    rows = []
    for added, effects in (("", ()), (", all four effects", EFFECTS)):
        rows.append(Case(name="the paper's firmware" + added, effects=effects, firmware="paper"))
        for place, (name, _) in enumerate(RUNGS, 1):
            left = tuple(int(number) for _, number in RUNGS[place:])
            rows.append(Case(name=f"+ {name}{added}", effects=effects, without=left))
    return tuple(rows)


def starts(shift_deg: float, count: int = STARTS) -> list[float]:
    """Start angles, deg of the absolute encoder, evenly over the travel; `shift_deg` moves all of them.

    Neighbours are 22.9 deg apart, no multiple of a gear's order, so each has its own phases.
    """
    spacing = (LAST_DEG - FIRST_DEG) / (count - 0.13)
    return [FIRST_DEG + (k * spacing + shift_deg) % (LAST_DEG - FIRST_DEG) for k in range(count)]
