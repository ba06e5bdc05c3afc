"""Whatever was set moving is stopped, however the checks end."""

import can
import pytest

from bus import protocol as p
from bus.can import Wire
from bus.conformance import CheckResult, Settings, parse, run
from bus.conformance.limits import PARAMETERS
from bus.outside.pythoncan import SchmidtBus
from bus.time import EventQueue
from scenarios.lab.wiring import network
from tests.conformance.test_checks import FakeAxis

END = [p.Opcode.STOP, p.Opcode.POWER, p.Opcode.STOP, p.Opcode.POWER]


def interrupted(bus: can.BusABC, subject: str, motion: bool = True) -> None:
    """Check the fake axis until `subject` has been seen, then Ctrl-C."""

    def each(result: CheckResult) -> None:
        if subject in result.subject:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(bus, devices=(parse("axis:0x13"),), settings=Settings(motion=motion, stamps_s=0.0, each=each))


@pytest.mark.parametrize("subject", ["POWER 1", "SET_CLASS", "NUDGE", "OPEN_LOOP"])
def test_an_interrupt_ends_in_a_stop(subject: str) -> None:
    wire = Wire(EventQueue())
    axis = FakeAxis(wire)
    with SchmidtBus(wire) as bus:
        interrupted(bus, subject)
    assert axis.heard[-4:] == END
    assert not axis.on


def test_a_second_interrupt_does_not_keep_it_from_stopping(monkeypatch: pytest.MonkeyPatch) -> None:
    wire = Wire(EventQueue())
    axis = FakeAxis(wire)
    stops = 0

    def send(self: SchmidtBus, message: can.Message, timeout: float | None = None) -> None:
        nonlocal stops
        if message.data[1:2] == bytes([p.Opcode.STOP]):
            stops += 1
            if stops == 2:  # the first is one of the checks
                raise KeyboardInterrupt
        sound(self, message, timeout)

    sound = SchmidtBus.send
    monkeypatch.setattr(SchmidtBus, "send", send)
    with SchmidtBus(wire) as bus:
        interrupted(bus, "SET_CLASS 3")
        bus.recv(0.1)
    assert not axis.on
    assert axis.heard[-1] == p.Opcode.POWER


def test_nothing_that_moves_is_sent_unless_asked_for() -> None:
    wire = Wire(EventQueue())
    axis = FakeAxis(wire)
    powered: list[bytes] = []
    wire.tap(lambda _t, frame, _s: powered.append(frame.data) if frame.data[1:3] == b"\x10\x01" else None)
    with SchmidtBus(wire) as bus:
        results = run(bus, devices=(parse("axis:0x13"),), settings=Settings(stamps_s=0.0))
    assert powered == []
    assert not axis.on
    assert any(result.check == "motion" and "--motion" in result.observed for result in results)


def test_the_emulated_axis_is_off_after_an_interrupt() -> None:
    served = network()

    def each(result: CheckResult) -> None:
        if "SET_CLASS 3" in result.subject:
            assert served.boards["AXIS_RA"].motion.mode == p.AxisMode.CLASS  # type: ignore[attr-defined]
            raise KeyboardInterrupt

    with SchmidtBus(served.wire) as bus, pytest.raises(KeyboardInterrupt):
        run(bus, devices=(p.Device.AXIS_RA,), settings=Settings(motion=True, listen_s=0.1, each=each))
    assert served.boards["AXIS_RA"].motion.mode == p.AxisMode.OFF  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["AXIS_RA", "AXIS_DEC", "POSITION_RA", "POSITION_DEC"])
def test_the_limits_checked_are_the_firmwares(name: str) -> None:
    rows = network().boards[name].parameters._rows
    found = {number: (row.low, row.high) for number, row in rows.items()}
    if name.startswith("AXIS"):  # taken with sound coefficients only
        assert found.pop(p.AxisParameter.OBSERVER) == (0, 1)
    assert found == PARAMETERS[name.partition("_")[0]]
