import pytest

from boards.chips.ecan import Ecan, EcanError
from boards.chips.ecan.chip import LIKE, OWN
from bus.can import Frame, Wire
from bus.time import EventQueue

NORMAL, CONFIG = 0x00, 0x80


class Bench:
    def __init__(self) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue)
        self.can = Ecan(self.queue, self.wire.attach("ecan"))
        self.partner = self.wire.attach("partner")
        self.heard: list[Frame] = []
        self.partner.on_receive = lambda _t, frame: self.heard.append(frame)
        self.requests: list[bool] = []
        self.can.interrupt = lambda _t, on: self.requests.append(on)

    def start(self) -> "Bench":
        """40 MHz, BRP 1: TQ 100 ns, 1 + 2 + 4 + 3 = 10 TQ: 1 Mbit/s."""
        for name, value in {"BRGCON1": 0x01, "BRGCON2": 0x99, "BRGCON3": 0x02, "RXB0CON": 0x60}.items():
            self.can.set(name, value)
        self.can.set("CANCON", NORMAL)
        assert self.can.get("CANSTAT") == NORMAL
        return self

    def run(self, ns: int = 1_000_000) -> None:
        self.queue.run_until(self.queue.now_ns + ns)

    def partner_sends(self, frame: Frame) -> None:
        self.partner.send(frame, self.queue.now_ns)
        self.run()


def test_it_wakes_in_configuration_mode_at_its_rate() -> None:
    bench = Bench()
    assert bench.can.get("CANSTAT") == CONFIG
    bench.start()
    assert (bench.can.times.bitrate, bench.can.times.problems) == (1_000_000, ())


def test_it_sends_what_its_registers_say() -> None:
    bench = Bench().start()
    for name, value in {"SIDH": 0x24, "SIDL": 0x60, "DLC": 2, "D0": 7, "D1": 8}.items():
        bench.can.set(f"TXB1{name}", value)
    bench.can.set("PIE3", 0x08)
    bench.can.set("TXB1CON", 0x08)
    bench.run()
    assert bench.heard == [Frame(0x123, b"\x07\x08")]
    assert bench.can.get("PIR3") == 0x08
    assert bench.requests == [True]
    bench.can.set("PIR3", 0)
    assert bench.requests == [True, False]
    assert bench.can.get("TXB1CON") == 0


IDENTIFIER = 0x0ABCDEF5
PARTS = {"SIDH": 0x55, "SIDL": 0xE8, "EIDH": 0xDE, "EIDL": 0xF5}
"""By hand: 28:21, 20:18 above the bit that says extended, 17:16 (0b00), 15:8, 7:0."""
MASK = {"SIDH": 0xFF, "SIDL": 0xE3, "EIDH": 0xFF, "EIDL": 0xFF}
DATA = bytes(range(0x11, 0x19))


def fill(bench: Bench, buffer: str, values: dict[str, int]) -> None:
    for part, value in values.items():
        bench.can.set(buffer + part, value)


@pytest.mark.parametrize("buffer", range(3))
def test_each_transmit_buffer_sends_an_extended_frame(buffer: int) -> None:
    bench = Bench().start()
    whole = PARTS | {"DLC": 8} | {f"D{k}": byte for k, byte in enumerate(DATA)}
    fill(bench, f"TXB{buffer}", whole | {"CON": 0x08})
    bench.run()
    assert bench.heard == [Frame(IDENTIFIER, DATA, extended=True)]
    assert bench.can.get("PIR3") == 0x04 << buffer
    assert [bench.can.get(f"TXB{buffer}{part}") for part in whole] == list(whole.values())


@pytest.mark.parametrize("number", range(6))
def test_each_filter_and_mask_tells_one_frame_from_others(number: int) -> None:
    buffer = int(number > 1)  # filters 0 and 1 are of the first buffer
    for loose, bit in (("none", 0), ("SIDH", 1 << 21), ("SIDL", 1 << 18), ("EIDH", 1 << 8), ("EIDL", 1)):
        bench = Bench()
        fill(bench, "RXM0", MASK)
        fill(bench, "RXM1", MASK)
        fill(bench, f"RXM{buffer}", {loose: 0} if bit else {})
        fill(bench, f"RXF{number}", PARTS)
        bench.start()
        bench.can.set("RXB0CON", 0)
        other = 1 << 8 if bit == 1 else 1
        bench.partner_sends(Frame(IDENTIFIER ^ other, DATA, extended=True))
        assert bench.can.get("PIR3") == 0
        bench.partner_sends(Frame(IDENTIFIER ^ bit, DATA, extended=True))
        assert bench.can.get("PIR3") == 1 << buffer
        told = bench.can.get(f"RXB{buffer}CON")
        assert told & 0x80 and told & (7 if buffer else 1) == number
        if not bit:
            found = [bench.can.get(f"RXB{buffer}{part}") for part in PARTS]
            assert found[0] == PARTS["SIDH"] and found[1] & 0xEB == PARTS["SIDL"]
            assert found[2:] == [PARTS["EIDH"], PARTS["EIDL"]]
            assert bench.can.get(f"RXB{buffer}DLC") == 8
            assert bytes(bench.can.get(f"RXB{buffer}D{k}") for k in range(8)) == DATA


def test_a_receive_buffer_is_freed_by_rxful_not_by_its_flag() -> None:
    bench = Bench().start()
    bench.partner_sends(Frame(0x345, b"\x01"))
    assert bench.can.get("RXB0CON") == 0x80 | 0x60
    assert bench.can.get("PIR3") == 0x01
    bench.can.set("PIR3", 0)
    assert bench.can.get("RXB0CON") & 0x80
    bench.partner_sends(Frame(0x346, b"\x02"))
    assert bench.can.get("RXB0D0") == 1
    assert bench.can.get("COMSTAT") == 0x80
    assert bench.can.get("PIR3") == 0x20
    bench.can.set("RXB0CON", 0x60)
    bench.can.set("COMSTAT", 0)
    bench.partner_sends(Frame(0x347, b"\x03"))
    assert bench.can.get("RXB0D0") == 3
    assert bench.can.get("COMSTAT") == 0


def test_double_buffering() -> None:
    bench = Bench()
    bench.can.set("RXB0CON", 0x04)
    bench.can.set("RXM0SIDH", 0xFF)
    bench.can.set("RXF0SIDH", 0x345 >> 3)
    bench.start()
    bench.can.set("RXB0CON", 0x04)
    bench.partner_sends(Frame(0x345, b"\x01"))
    bench.partner_sends(Frame(0x345, b"\x02"))
    assert bench.can.get("RXB0CON") == 0x86
    assert bench.can.get("RXB1CON") & 0x87 == 0x86
    assert bench.can.get("RXB1D0") == 2


def test_error_state() -> None:
    bench = Bench().start()
    bench.partner.online = False
    bench.can.set("TXB0CON", 0x08)
    bench.run(20_000_000)
    assert bench.can.get("COMSTAT") == 0x15
    assert bench.can.get("TXERRCNT") == 128
    bench.can.set("CANCON", 0x10)
    bench.run()
    assert bench.can.get("TXB0CON") & 0x48 == 0x40
    assert bench.can.get("CANCON") == 0x10


@pytest.mark.parametrize(
    ("tec", "rec", "told"), [(95, 95, 0), (96, 0, 0x05), (0, 96, 0x03), (128, 0, 0x15), (0, 128, 0x0B)]
)
def test_comstat_tells_warnings_and_passive(tec: int, rec: int, told: int) -> None:
    """DS39637, register 23-4: TXBP, RXBP, TXWARN, RXWARN, EWARN from bit 4 down."""
    bench = Bench().start()
    bench.can.port.tec, bench.can.port.rec = tec, rec
    assert (bench.can.get("COMSTAT"), bench.can.get("TXERRCNT"), bench.can.get("RXERRCNT")) == (
        told,
        tec,
        rec,
    )


def test_the_second_buffer_overflows_by_its_own_flag() -> None:
    bench = Bench()
    fill(bench, "RXM0", MASK)
    bench.start()
    bench.can.set("RXB0CON", 0)
    bench.can.set("RXB1CON", 0x60)
    for _ in range(2):
        bench.partner_sends(Frame(0x123, b"\x01"))
    assert (bench.can.get("COMSTAT"), bench.can.get("RXB1CON") & 0xE0) == (0x40, 0xE0)
    bench.can.set("COMSTAT", 0x80)
    assert bench.can.get("COMSTAT") == 0
    bench.can.set("RXB1CON", 0x60)
    assert bench.can.get("RXB1CON") & 0x80 == 0


def test_after_a_reset_nothing_is_enabled_and_nothing_has_come() -> None:
    can = Bench().can
    told = {name: can.get(name) for name in OWN}
    assert told == {"CANCON": 0x80, "CANSTAT": CONFIG} | dict.fromkeys(OWN[2:], 0)


def test_firmware_writes_the_bits_there_are() -> None:
    can = Bench().can
    for name, value, told in (
        ("CANCON", 0x9F, 0x90), ("PIR3", 0x1FF, 0xFF), ("PIE3", 0x108, 0x08), ("PIE3", 0xFF, 0xFF),
    ):  # fmt: skip
        can.set(name, value)
        assert can.get(name) == told
    for value, left in ((0xC0, 0xC0), (0x80, 0x80), (0x40, 0x40), (0x3F, 0)):
        can.write(0x2D, 0xC0)  # EFLG of the stand-alone chip: both have overflowed
        can.set("COMSTAT", value)
        assert can.get("COMSTAT") == left


def test_an_interrupt_that_is_enabled_late_comes_at_once() -> None:
    bench = Bench().start()
    bench.partner_sends(Frame(0x345, b"\x01"))
    assert (bench.can.get("PIR3"), bench.requests) == (0x01, [])
    bench.can.set("PIE3", 0x01)
    assert bench.requests == [True]


BEYOND = (
    "TXB3CON", "TXB3SIDH", "TXB3D0", "TXB0D8", "RXB2SIDH", "RXB2D0", "RXB0D8", "RXM2SIDH", "RXF6SIDH",
)  # fmt: skip
"""Three buffers to send from, two to receive into, of eight bytes; two masks, six filters."""


def test_registers_it_has_not_got_are_refused() -> None:
    bench = Bench()
    for name in (*LIKE, *OWN):
        assert 0 <= bench.can.get(name) <= 0xFF
        bench.can.set(name, 0)
    for name in ("ECANCON", "CANCTRL", "RXF15SIDH", *BEYOND):
        with pytest.raises(EcanError, match="no register"):
            bench.can.get(name)
        with pytest.raises(EcanError, match="no register"):
            bench.can.set(name, 0)
