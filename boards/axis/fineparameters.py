"""Parameters 12 to 42: spread duty, compensation table, friction model, bias, lock, blend."""

from typing import Final

from boards.axis.motion import Motion
from boards.axis.output import FineOutput
from boards.core import Parameter
from boards.core.parameters import kept
from bus.protocol import HARMONICS, AxisParameter
from bus.protocol.scales import COUNTS_PER_TURN

_EFFORT_Q8: Final = 3000 << 8
"""All of the supply."""
_BIAS_Q8: Final = 300 << 8
"""A tenth of the supply."""
_ORDER_Q16: Final = (1 << 31) - 1
"""32767 cycles per turn of the axis: motor orders up to 90."""


def fine_parameters(output: FineOutput, motion: Motion) -> list[Parameter]:
    """Rows of the parameter table; the interrupt table is booked again when one changes."""
    compensator = output.compensator

    def cell(number: int, name: str, bound: int, column: list[int], line: int) -> Parameter:
        def write(value: int) -> None:
            column[line] = value
            output.refresh()

        low = 0 if column is compensator.orders_q16 else -bound
        return Parameter(number, f"{name}_{line}", low, bound, lambda: column[line], write)

    columns: tuple[tuple[str, int, list[int]], ...] = (
        ("harmonic_order_q16", _ORDER_Q16, compensator.orders_q16),
        ("harmonic_cosine_q8", _EFFORT_Q8, compensator.cosines_q8),
        ("harmonic_sine_q8", _EFFORT_Q8, compensator.sines_q8),
    )
    first = AxisParameter.HARMONIC_FIRST
    return [
        Parameter(
            AxisParameter.DUTY_FRACTION, "duty_fraction", 0, 1,
            lambda: output.spread, output.set_spread,
        ),
        Parameter(
            AxisParameter.COMPENSATION, "compensation", 0, 1,
            lambda: compensator.on, output.set_compensation,
        ),
        kept(
            AxisParameter.FRICTION_LEVEL_Q8, "friction_level_q8", (0, _EFFORT_Q8), compensator, "level_q8",
        ),
        kept(
            AxisParameter.FRICTION_TRAVEL_COUNTS, "friction_travel_counts", (1, COUNTS_PER_TURN), compensator,
            "travel",
        ),
        *(
            cell(first + 3 * line + place, name, bound, column, line)
            for line in range(HARMONICS)
            for place, (name, bound, column) in enumerate(columns)
        ),
        Parameter(
            AxisParameter.COUNTER_BIAS_Q8, "counter_bias_q8", 0, _BIAS_Q8,
            lambda: output.bias_q8, output.set_bias,
        ),
        Parameter(
            AxisParameter.RATE_LOCK, "rate_lock", 0, 1,
            lambda: int(motion.lock is not None), motion.set_lock,
        ),
        Parameter(
            AxisParameter.POSITION_BLEND, "position_blend", 0, 15,
            lambda: motion.blend.shift if motion.blend else 0, motion.set_blend,
        ),
    ]  # fmt: skip
