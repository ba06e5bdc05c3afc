"""Parts of a board by themselves, at the limits of what their data sheets and pages say."""

import pytest

from boards.silicon.adc import CurrentAdc, VoltageAdc, convert
from boards.silicon.can import CanController
from boards.silicon.hid import HidEndpoint, next_frame_ns
from boards.silicon.pwm import FCY_HZ, ONE, MotorPwm
from boards.silicon.stepper import HALF_STEPS, StepperDriver
from boards.silicon.uart import BUFFERS, Uart
from bus.can import Frame, Wire
from bus.time import EventQueue

BYTE_NS = 10 * 10**9 // 115_200


@pytest.mark.parametrize(("volts", "counts"), [
    (0.0, 0), (-0.1, 0), (5.0 / 1024, 1), (5.0 / 1025, 0), (1023 * 5.0 / 1024, 1023), (4.999, 1023),
    (1022.5 * 5.0 / 1024, 1022), (5.0, 1023), (12.0, 1023), (-12.0, 0),
])  # fmt: skip
def test_ten_bits_of_five_volts_are_clipped_at_both_ends(volts: float, counts: int) -> None:
    assert convert(volts) == counts
    assert VoltageAdc(lambda _t: volts).read(0) == counts
    amperes = volts / (0.1 * 8.0)  # a shunt of 0.1 ohm and a gain of 8
    nearly = CurrentAdc(lambda _t, _m: amperes * (1 + 1e-12)).read(0, 0)
    assert nearly == counts


def test_an_adc_reads_its_pin_when_it_is_asked() -> None:
    seen: list[tuple[int, ...]] = []

    def amperes(*asked: int) -> float:
        seen.append(asked)
        return 0.0

    current, voltage = CurrentAdc(amperes), VoltageAdc(amperes)
    current.read(5, 1)
    voltage.read(7)
    assert seen == [(5, 1), (7,)]


class Line:
    """A transmitter, what left it and what was through."""

    def __init__(self) -> None:
        self.queue = EventQueue()
        self.uart = Uart(self.queue)
        self.began: list[tuple[int, bytes]] = []
        self.through: list[tuple[int, bytes]] = []
        self.uart.line = lambda t_ns, data: self.began.append((t_ns, data))
        self.uart.sink = lambda t_ns, packet: self.through.append((t_ns, packet))


def test_a_byte_is_ten_bits_at_the_usual_rate() -> None:
    uart = Uart(EventQueue())
    assert (uart.baud, BUFFERS, uart.dropped) == (115_200, 2, 0)
    lengths = (0, 1, 1152, 11_520_000)
    assert [uart.duration_ns(length) for length in lengths] == [0, BYTE_NS, 10**8, 10**12]


def test_packets_leave_one_after_the_other_and_two_at_most_wait() -> None:
    line = Line()
    assert line.uart.send(1000, b"abc")
    assert line.uart.send(2000, b"de")
    assert not line.uart.send(3000, b"f") and not line.uart.send(3000, b"g")
    first, second = (
        1000 + line.uart.duration_ns(3),
        1000 + line.uart.duration_ns(3) + line.uart.duration_ns(2),
    )
    assert line.began == [(1000, b"abc"), (first, b"de")]
    line.queue.run_until(10**9)
    assert line.through == [(first, b"abc"), (second, b"de")]
    assert line.uart.dropped == 2
    assert line.uart.send(10**9, b"h")
    assert line.began[-1] == (10**9, b"h")


def test_nobody_needs_to_listen() -> None:
    queue = EventQueue()
    uart = Uart(queue)
    uart.part(0, b"a")
    assert uart.send(0, b"ab", 1)
    queue.run_until(10**9)
    assert uart.send(10**9, b"c")


def controller() -> CanController:
    return CanController(Wire(EventQueue()).attach("a"), lambda _t, _f: None)


def test_four_filters_hang_on_one_mask_and_two_on_the_other() -> None:
    for groups in (
        [(0x7FF, [1, 2, 3, 4])], [(0x7FF, [1, 2, 3, 4]), (0x700, [0x100, 0x200])],
        [(0x700, [0x100, 0x200]), (0x7FF, [1, 2, 3, 4])], [(0x7FF, []), (0x700, [0x100])], [],
    ):  # fmt: skip
        made = controller()
        made.accept(*groups)
        for mask, codes in groups:
            assert all(made.port.passes(code) for code in codes)
            assert not made.port.passes(0x7F0 & mask) or not codes
    with pytest.raises(ValueError, match="has 4 filters for mask 0x7ff, 5 asked for"):
        controller().accept((0x7FF, [1, 2, 3, 4, 5]))
    with pytest.raises(ValueError, match="has 2 filters for mask 0x700, 3 asked for"):
        controller().accept((0x7FF, [1, 2, 3, 4]), (0x700, [1, 2, 3]))
    with pytest.raises(ValueError, match="has 2 masks, 3 asked for"):
        controller().accept((1, []), (2, []), (3, []))


def test_a_controller_sends_and_hears_by_its_port() -> None:
    queue = EventQueue()
    wire = Wire(queue)
    heard: list[int] = []
    one = CanController(wire.attach("one"), lambda _t, _f: None)
    CanController(wire.attach("two"), lambda _t, frame: heard.append(frame.identifier))
    assert one.send(Frame(0x123, b""), 0)
    queue.run_until(1_000_000)
    assert heard == [0x123]


def test_reports_before_the_firmware_are_lost_and_those_after_reach_it() -> None:
    endpoint = HidEndpoint()
    assert endpoint.ready() is True
    endpoint.write(1, bytes(64))
    got: list[tuple[int, bytes]] = []
    endpoint.from_host = lambda t_ns, report: got.append((t_ns, report))
    endpoint.write(2, b"\x05" * 64)
    assert got == [(2, b"\x05" * 64)]
    with pytest.raises(ValueError, match="report has 63 bytes, the endpoint takes 64"):
        endpoint.write(3, bytes(63))
    assert len(got) == 1


@pytest.mark.parametrize(("t_ns", "next_ns"), [
    (-1, 0), (0, 1_000_000), (1, 1_000_000), (1_000_000, 2_000_000), (2_999_999, 3_000_000),
])  # fmt: skip
def test_a_frame_starts_every_millisecond(t_ns: int, next_ns: int) -> None:
    assert next_frame_ns(t_ns) == next_ns


class Bridge:
    def __init__(self, **given: int) -> None:
        self.driven: list[tuple[int, float, float]] = []
        self.pwm = MotorPwm(lambda *each: self.driven.append(each), **given)


def test_duties_count_from_the_next_period_on() -> None:
    bridge = Bridge()
    assert (bridge.pwm.period_ns, bridge.pwm.steps, FCY_HZ) == (50_000, 3000, 30_000_000)
    bridge.pwm.write(0, 0, 0)  # off, as it is
    bridge.pwm.write(50_000, 3000, 1)  # at the boundary itself
    bridge.pwm.write(50_001, 2999, 3001)
    bridge.pwm.write(120_000, 2999, 3001)
    bridge.pwm.write(120_000, 2999, 3000)
    bridge.pwm.write(170_000, 0, 3000)
    assert bridge.driven == [
        (50_000, 1.0, 1 / 3000), (100_000, 2999 / 3000, 1.0), (150_000, 2999 / 3000, 1.0),
        (200_000, 0.0, 1.0),
    ]  # fmt: skip
    assert (bridge.pwm.pdc_a, bridge.pwm.pdc_b) == (0, 3000)


def test_fractions_of_a_step_are_spread_until_whole_steps_are_written() -> None:
    bridge = Bridge(steps=1000, pwm_hz=10_000)
    assert bridge.pwm.spreading is False
    half = ONE // 2
    bridge.pwm.write_spread(100_000, 500 * ONE + half, 1000 * ONE)
    assert (bridge.pwm.pdc_a, bridge.pwm.pdc_b, bridge.pwm.spreading) == (500, 1000, True)
    bridge.pwm.write_spread(100_001, 1001 * ONE, 999 * ONE + half)
    bridge.pwm.write_spread(110_000, 0, 1000 * ONE + 1)
    bridge.pwm.write_spread(110_000, 1001 * ONE, 999 * ONE + half)
    bridge.pwm.write(200_001, 1001, 999)  # other duties than the fractions had
    bridge.pwm.write(200_001, 1001, 999)
    assert bridge.driven == [
        (100_000, 0.5005, 1.0), (200_000, 1.0, 0.9995), (200_000, 0.0, 1.0), (200_000, 1.0, 0.9995),
        (300_000, 1.0, 0.999),
    ]  # fmt: skip
    assert bridge.pwm.spreading is False


def test_a_half_step_is_full_current_in_a_coil_or_none() -> None:
    assert {abs(current) for coils in HALF_STEPS for current in coils} == {0, 1}


def test_a_stepper_is_free_at_first_and_comes_round_in_eight_half_steps() -> None:
    calls: list[tuple[int, int, bool, bool]] = []
    driver = StepperDriver(lambda *each: calls.append(each))
    assert (driver.phase, driver.energised, driver.hold) == (0, False, False)
    for t_ns in range(9):
        driver.step(t_ns, 1)
        assert (driver.energised, driver.hold) == (True, False)
    assert calls == [(t_ns, (t_ns + 1) % 8, True, False) for t_ns in range(9)]
    driver.rest(10)
    assert (driver.phase, driver.energised, driver.hold) == (1, False, True)
    driver.step(11, -1)
    assert (driver.phase, driver.energised, driver.hold) == (0, True, False)
    driver.rest(12)
    driver.release(13)
    assert (driver.phase, driver.energised, driver.hold) == (0, False, False)
