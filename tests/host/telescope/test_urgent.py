"""The emergency stop does not wait for the host's next tick: it is on the bus within milliseconds."""

from itertools import pairwise

import pytest

from bus.can.frame import Frame
from bus.protocol import COMMAND_BASE, Device, Opcode
from tests.host.telescope.conftest import Rig

MS = 1_000_000


@pytest.mark.parametrize("phase_ms", range(0, 50, 7))
def test_a_stop_is_on_the_bus_within_20_ms_wherever_in_a_tick_it_was_asked_for(
    rig: Rig, phase_ms: int
) -> None:
    """Asked for to a slice's end 10 ms, then a USB frame, the gateway, and two frames on the wire."""
    rig.run(lambda t: t.drive.power_on())
    rig.advance(0.1 + phase_ms * 1e-3)
    stops: dict[int, int] = {}

    def tap(t_ns: int, frame: Frame, _sender: str) -> None:
        if frame.data[1:2] == bytes([Opcode.STOP]):
            stops.setdefault(frame.identifier, t_ns)

    rig.network.wire.tap(tap)
    asked_ns = rig.served.now_ns
    rig.telescope.call(lambda t: t.emergency_stop(), urgent=True)
    rig.advance(0.2)
    assert set(stops) >= {COMMAND_BASE + Device.AXIS_RA, COMMAND_BASE + Device.AXIS_DEC}
    assert max(stops[COMMAND_BASE + axis] for axis in (Device.AXIS_RA, Device.AXIS_DEC)) - asked_ns < 20 * MS


def test_ticks_keep_their_times_after_an_urgent_one(rig: Rig) -> None:
    ticks: list[int] = []
    tick = rig.telescope.tick
    rig.telescope.tick = lambda t_ns: (ticks.append(t_ns), tick(t_ns))[1]  # type: ignore[method-assign]
    rig.advance(0.22)
    rig.telescope.call(lambda t: None, urgent=True)
    rig.advance(0.18)
    gaps = [b - a for a, b in pairwise(ticks)]
    assert sum(gap < 50 * MS for gap in gaps) == 2, "one tick more, which cuts one gap in two"
    assert len(ticks) == 9
