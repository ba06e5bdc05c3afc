"""A driver written by somebody else, unmodified, on the chip: adafruit-circuitpython-mcp2515 from PyPI."""

import adafruit_mcp2515
import pytest
from adafruit_mcp2515.canio import BusState, Match, Message, RemoteTransmissionRequest

from boards.chips.mcp2515 import Mcp2515
from bus.can import Frame, Wire
from bus.time import EventQueue

BIT_NS = 100
"""SPI at 10 MHz: simulated time goes on while the driver talks."""


class Spi:
    """busio.SPI as far as `adafruit_bus_device` uses it, clocking the chip byte by byte."""

    def __init__(self, chip: Mcp2515, queue: EventQueue) -> None:
        self.chip, self.queue = chip, queue

    def try_lock(self) -> bool:
        return True

    def unlock(self) -> None:
        pass

    def configure(self, **settings: int) -> None:
        assert (settings["polarity"], settings["phase"]) in ((0, 0), (1, 1))

    def _exchange(self, byte: int) -> int:
        self.queue.run_until(self.queue.now_ns + 8 * BIT_NS)
        return self.chip.spi.exchange(byte)

    def write(self, data: bytes, start: int = 0, end: int | None = None) -> None:
        for byte in bytes(data)[start:end]:
            self._exchange(byte)

    def readinto(
        self, buffer: bytearray, start: int = 0, end: int | None = None, write_value: int = 0
    ) -> None:
        for index in range(*slice(start, end).indices(len(buffer))):
            buffer[index] = self._exchange(write_value)

    def write_readinto(
        self, out: bytes, into: bytearray, *, out_start: int, out_end: int, in_start: int, in_end: int
    ) -> None:
        told = [self._exchange(byte) for byte in bytes(out)[out_start:out_end]]
        into[in_start:in_end] = bytes(told)


class ChipSelect:
    """digitalio.DigitalInOut as far as it is used."""

    def __init__(self, chip: Mcp2515) -> None:
        self.chip = chip

    def switch_to_output(self, value: bool) -> None:
        self.value = value

    @property
    def value(self) -> bool:
        return not self.chip.spi.selected

    @value.setter
    def value(self, level: bool) -> None:
        (self.chip.spi.deselect if level else self.chip.spi.select)()


class Rig:
    def __init__(self, **settings: object) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue, int(str(settings.get("baudrate", 250_000))))
        self.chip = Mcp2515(self.queue, self.wire.attach("chip"))
        self.partner = self.wire.attach("partner")
        self.heard: list[Frame] = []
        self.partner.on_receive = lambda _t, frame: self.heard.append(frame)
        self.can = adafruit_mcp2515.MCP2515(Spi(self.chip, self.queue), ChipSelect(self.chip), **settings)

    def run(self, milliseconds: float = 5) -> None:
        self.queue.run_until(self.queue.now_ns + round(milliseconds * 1e6))


@pytest.mark.parametrize("baudrate", [1_000_000, 500_000, 250_000, 125_000, 10_000])
def test_it_brings_the_chip_up_at_its_rate(baudrate: int) -> None:
    rig = Rig(baudrate=baudrate)
    assert rig.chip.times.bitrate == baudrate
    assert rig.chip.times.problems == ()
    assert rig.can.send(Message(0x123, b"hello"))
    rig.run(50)
    assert rig.heard == [Frame(0x123, b"hello")]


@pytest.mark.parametrize(
    ("message", "frame"),
    [
        (Message(0x7FF, b""), Frame(0x7FF, b"")),
        (Message(0x12345678, bytes(range(8)), extended=True), Frame(0x12345678, bytes(range(8)), True)),
        (RemoteTransmissionRequest(0x123, 5), Frame(0x123, bytes(5), False, True)),
        (
            RemoteTransmissionRequest(0x1FFFFFFF, 1, extended=True),
            Frame(0x1FFFFFFF, bytes(1), True, True),
        ),
    ],
)
def test_it_sends_and_receives_every_kind_of_frame(message: Message, frame: Frame) -> None:
    rig = Rig()
    assert rig.can.send(message)
    rig.run()
    assert rig.heard == [frame]
    match = Match(frame.identifier, extended=frame.extended)
    with rig.can.listen([match], timeout=1.0) as listener:
        rig.partner.send(frame, rig.queue.now_ns)
        rig.run()
        got = listener.receive()
    assert (got.id, got.extended, type(got)) == (frame.identifier, frame.extended, type(message))
    if isinstance(got, Message):
        assert bytes(got.data) == frame.data
    else:
        assert got.length == len(frame.data)


def test_without_matches_it_hears_standard_frames_only() -> None:
    # Filters of zero have EXIDE = 0: so it is on the real chip too (autowp/arduino-mcp2515, issue 13 and 35).
    rig = Rig()
    rig.partner.send(Frame(0x12345678, b"", extended=True), rig.queue.now_ns)
    rig.partner.send(Frame(0x123, b""), rig.queue.now_ns)
    rig.run()
    with rig.can.listen(timeout=0.01) as listener:
        assert [listener.receive().id, listener.receive()] == [0x123, None]


def test_three_frames_fill_the_buffers_and_all_arrive() -> None:
    rig = Rig(baudrate=10_000)
    for number in range(3):
        assert rig.can.send(Message(0x100 + number, bytes([number])))
    with pytest.raises(RuntimeError, match="No transmit buffer"):
        rig.can.send(Message(0x103, b""))
    rig.run(60)
    assert sorted(rig.heard, key=str) == [Frame(0x100 + n, bytes([n])) for n in range(3)]


def test_its_filters_are_the_chips() -> None:
    rig = Rig()
    matches = [Match(0x123), Match(0x400, mask=0x700)]
    with rig.can.listen(matches, timeout=1.0) as listener:
        for identifier in (0x123, 0x124, 0x4AB, 0x500):
            rig.partner.send(Frame(identifier, b"\x01"), rig.queue.now_ns)
            rig.run()
        got = []
        while listener.in_waiting():
            got.append(listener.receive().id)
    assert got == [0x123, 0x4AB]


def test_loop_back_and_silent() -> None:
    rig = Rig(loopback=True, silent=True)
    rig.can.send(Message(0x123, b"self"))
    rig.run()
    with rig.can.listen(timeout=1.0) as listener:
        got = listener.receive()
    assert (got.id, bytes(got.data)) == (0x123, b"self")
    assert rig.wire.frames == 0
    silent = Rig(silent=True)
    silent.partner.send(Frame(0x1, b""), silent.queue.now_ns)
    silent.run()
    assert silent.wire.frames == 0


def test_it_reads_the_error_state() -> None:
    rig = Rig()
    rig.partner.online = False
    assert rig.can.state == BusState.ERROR_ACTIVE
    rig.can.send(Message(0x123, b""))
    states = []
    for _ in range(40):
        rig.run(0.5)
        states.append(rig.can.state)
    assert BusState.ERROR_WARNING in states
    assert states[-1] == BusState.ERROR_PASSIVE
    assert rig.can.transmit_error_count == 128
    assert rig.can.receive_error_count == 0
