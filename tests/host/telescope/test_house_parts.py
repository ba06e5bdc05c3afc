"""The slit that follows, and what a house may be told, over a client that writes down."""

import math
from collections.abc import Generator
from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.protocol import Device
from bus.protocol.serial import PACKET_NS
from host.logs.journal import Journal
from host.procedures.dome import BOARD
from host.serial_link import SerialLink
from host.sky.observed import Observed
from host.telescope import Reason, Refused
from host.telescope.house import House
from host.telescope.jobs import Side

SECOND_NS = 1_000_000_000


class Wire:
    """A client. told: names of opcodes and arguments."""

    def __init__(self, heard: bool = True) -> None:
        self.told: list[tuple[Any, ...]] = []
        self.devices = (BOARD,)
        self.now_ns = 10 * SECOND_NS
        self.link = Some(measurements={BOARD: b""} if heard else {}, measured_ns={})

    @property
    def now_s(self) -> float:
        return self.now_ns * 1e-9

    def ask(self, device: Device, opcode: Any, *arguments: int) -> Generator[None, None, None]:
        self.told.append((opcode.name, *arguments))
        return
        yield

    def forget(self, device: Device) -> None:
        self.told.append(("forget", device))


def house(aim: Observed | None = None, **dome: float) -> tuple[House, Wire]:
    wire = Wire()
    made = House(wire, Side(), lambda: aim)  # type: ignore[arg-type]
    found = {"Azimuth": 100.0, "Target": 200.0, "Moving": 0.0} | dome
    made.reading = lambda board: found  # type: ignore[method-assign]
    return made, wire


def at(azimuth_deg: float, altitude_deg: float = 45.0) -> Observed:
    return Observed(0.0, 0.0, math.radians(altitude_deg), math.radians(azimuth_deg))


@pytest.mark.parametrize(("aim", "dome", "told"), [
    (at(101.9), {}, []), (at(102.1), {}, [("DOME_GOTO", 10210)]), (at(97.9), {}, [("DOME_GOTO", 9790)]),
    (at(-1.0), {"Azimuth": 0.5}, []), (at(-3.0), {"Azimuth": 0.5}, [("DOME_GOTO", 35700)]),
    (at(201.9), {"Moving": 1.0}, []), (at(100.0), {"Moving": 1.0}, [("DOME_GOTO", 10000)]),
    (at(150.0, 87.9), {}, [("DOME_GOTO", 15000)]), (at(150.0, 88.1), {}, []), (None, {}, []),
])  # fmt: skip
def test_the_slit_follows_by_more_than_two_degrees(
    aim: Observed | None, dome: dict[str, float], told: list[tuple[Any, ...]]
) -> None:
    made, wire = house(aim, **dome)
    made.tick()
    assert wire.told == [], "it does not follow yet"
    made.slave(True)
    made.tick()
    assert wire.told == told


def test_the_slit_is_looked_at_once_a_second() -> None:
    made, wire = house(at(150.0))
    made.slave(True)
    for ticks in range(41):
        wire.now_ns = (10 + ticks * 0.05) * SECOND_NS  # type: ignore[assignment]
        made.tick()
    assert len(wire.told) == 3
    made.slave(False)
    wire.now_ns += 5 * SECOND_NS
    made.tick()
    assert len(wire.told) == 3


def test_what_a_dome_is_told() -> None:
    made, wire = house()
    made.turn(0.0)
    made.turn(359.99)
    assert not made.opening
    made.shutter(True)
    assert made.opening
    made.shutter(False)
    assert not made.opening
    made.slave(True)
    made.stop()
    assert not made.slaved
    assert wire.told == [
        ("DOME_GOTO", 0), ("DOME_GOTO", 35999), ("DOME_SHUTTER", 1), ("DOME_SHUTTER", 0), ("forget", BOARD),
        ("DOME_STOP",),
    ]  # fmt: skip
    for azimuth in (-0.1, 360.0):
        with pytest.raises(Refused, match=r"is not within 0\.\.360°") as found:
            made.turn(azimuth)
        assert found.value.reason is Reason.VALUE
    made.slave(True)
    with pytest.raises(Refused, match="the dome follows the telescope; end that first") as found:
        made.turn(10.0)
    assert found.value.reason is Reason.SLAVED


def test_a_dome_that_is_not_there_is_told_nothing() -> None:
    made = House(Wire(heard=False), Side(), lambda: None)  # type: ignore[arg-type]
    for act in (lambda: made.turn(1.0), lambda: made.slave(True), lambda: made.shutter(True), made.stop):
        with pytest.raises(Refused, match="DOME is not on this network, or silent") as found:
            act()
        assert found.value.reason is Reason.SILENT
    assert not made.slaved


def test_a_serial_port_is_silent_after_four_packets() -> None:
    journal = Journal(None)
    made = SerialLink(Device.AXIS_RA, journal, lambda _t, _p: None)
    made.watch(4 * PACKET_NS)
    assert not journal.entries
    made.watch(4 * PACKET_NS + 1)
    made.watch(9 * PACKET_NS)
    assert [(each.kind, each.where, each.text) for each in journal.entries] == [
        ("error", "AXIS_RA serial", "silent since 0.00 s"),
    ]  # fmt: skip
    made.last_ns = 8 * PACKET_NS
    made.watch(9 * PACKET_NS)
    made.watch(9 * PACKET_NS)
    assert [each.text for each in journal.entries][1:] == ["packets are back"]
