"""Interrupt tables by the cycles that FIDELITY.md publishes as times: first instruction, end, who waits for whom."""

import pytest

from boards.axis import config as axis
from boards.core import InterruptController, Source
from boards.display import firmware as display
from boards.focus import config as focus
from boards.motor_velocity import firmware as motor
from boards.position import firmware as position
from bus.time import EventQueue

US = 1000
PIC18, DSPIC = 1200, 300
"""Twelve cycles at 10 MIPS, nine at 30; ns."""


@pytest.mark.parametrize(("table", "fcy_hz", "latency_ns", "costs"), [
    (axis.TABLE, axis.FCY_HZ, DSPIC, {"control": 40 * US, "can": 30 * US}),
    (position.TABLE, position.FCY_HZ, PIC18, {"sample": 120 * US, "can": 40 * US}),
    (motor.TABLE, motor.FCY_HZ, PIC18, {"sample": 40 * US, "can": 60 * US}),
    (focus.TABLE, focus.FCY_HZ, PIC18, {"sample": 50 * US, "step": 15 * US, "can": 60 * US}),
    (display.TABLE, display.FCY_HZ, PIC18, {"refresh": 500 * US, "can": 60 * US}),
])  # fmt: skip
def test_a_routine_takes_what_is_published_and_the_first_goes_first(
    table: tuple[Source, ...], fcy_hz: int, latency_ns: int, costs: dict[str, int]
) -> None:
    lines = InterruptController(EventQueue(), fcy_hz, table).lines
    assert {name: line.cost_ns for name, line in lines.items()} == costs
    assert {line.latency_ns for line in lines.values()} == {latency_ns}
    priorities = [line.priority for line in lines.values()]
    assert priorities == sorted(set(priorities), reverse=True)
    assert [line.source.level for line in lines.values()] == [name == "can" for name in lines]
