import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.silicon.adc import CurrentAdc, VoltageAdc
from boards.silicon.can import FULL_MASK, CanController
from boards.silicon.hid import HidEndpoint, next_frame_ns
from boards.silicon.pwm import STEPS, MotorPwm
from boards.silicon.qei import Qei, difference
from boards.silicon.stepper import HALF_STEPS, StepperDriver
from boards.silicon.uart import Uart
from bus.can import Wire
from bus.time import EventQueue


@given(st.integers(-(2**40), 2**40), st.integers(-32768, 32767))
def test_P7_differences_survive_the_wrap_of_the_counter(start: int, moved: int) -> None:
    before = Qei(lambda _t: start).poscnt(0)
    now = Qei(lambda _t: start + moved).poscnt(0)
    assert 0 <= now <= 0xFFFF
    assert difference(now, before) == moved


def test_B1_pwm_resolution_at_30_mips() -> None:
    # hardware.md 3.4: PTPER 0x3FF is 11 bit at 29.3 kHz; 20 kHz gives 3000 steps
    assert STEPS == 3000


def test_B1_pwm_is_off_at_zero_and_saturates() -> None:
    driven: list[tuple[int, float, float]] = []
    pwm = MotorPwm(lambda *arguments: driven.append(arguments), steps=3000, pwm_hz=20_000)
    pwm.write(10, 1500, 0)
    pwm.write(20, 1500, 0)
    pwm.write(60_000, 4000, 3000)
    # taken at the end of the running 50 us period; an unchanged value is no event
    assert driven == [(50_000, 0.5, 0.0), (100_000, 1.0, 1.0)]


def test_B1_current_sense_is_6_1_mA_per_count() -> None:
    adc = CurrentAdc(lambda _t, motor: (2.0, 50.0)[motor])
    assert adc.read(0, 0) == int(2.0 / 0.0061035)
    assert adc.read(0, 1) == 1023
    assert CurrentAdc(lambda _t, _m: -1.0).read(0, 0) == 0


def test_P12_lvdt_adc_spans_the_reference() -> None:
    assert [VoltageAdc(lambda _t, v=v: v).read(0) for v in (0.0, 2.5, 5.0)] == [0, 512, 1023]  # type: ignore[misc]


def test_L3_a_packet_that_left_in_parts_is_through_with_its_last_one() -> None:
    queue = EventQueue()
    got: list[tuple[int, bytes]] = []
    heard: list[tuple[int, bytes]] = []
    uart = Uart(queue, baud=115_200, sink=lambda t, packet: got.append((t, packet)))
    uart.line = lambda t, part: heard.append((t, part))
    uart.part(0, b"one")
    uart.part(10_000_000, b"two")
    assert uart.send(20_000_000, b"onetwoend", 3)
    queue.run_until(1_000_000_000)
    assert heard == [(0, b"one"), (10_000_000, b"two"), (20_000_000, b"end")]
    assert got == [(20_000_000 + 3 * 10 * 1_000_000_000 // 115_200, b"onetwoend")]


def test_L3_uart_bytes_take_their_time() -> None:
    queue = EventQueue()
    got: list[tuple[int, bytes]] = []
    uart = Uart(queue, baud=115_200, sink=lambda t, packet: got.append((t, packet)))
    assert uart.send(0, bytes(1152))
    assert uart.send(0, b"x")
    assert not uart.send(0, b"y")
    queue.run_until(10**9)
    assert got == [(100_000_000, bytes(1152)), (100_000_000 + 10**10 // 115_200, b"x")]
    assert uart.dropped == 1


def test_B5_half_steps_turn_the_field_by_an_eighth() -> None:
    import cmath
    import math

    angles = [cmath.phase(complex(a, b)) for a, b in HALF_STEPS]
    for before, after in zip(angles, angles[1:] + angles[:1], strict=True):
        assert (after - before) % (2 * math.pi) == pytest.approx(math.pi / 4)


def test_B5_hold_and_free_take_the_current_off() -> None:
    calls: list[tuple[int, int, bool, bool]] = []
    driver = StepperDriver(lambda *arguments: calls.append(arguments))
    driver.step(1, -1)
    driver.rest(2)
    driver.release(3)
    assert calls == [(1, 7, True, False), (2, 7, False, True), (3, 7, False, False)]


def test_B7_hid_takes_64_bytes_and_frames_are_a_millisecond_apart() -> None:
    with pytest.raises(ValueError, match="64"):
        HidEndpoint().write(0, bytes(65))
    assert next_frame_ns(0) == next_frame_ns(999_999) == 1_000_000


def test_can_filters_are_two_masks_and_six_filters() -> None:
    queue = EventQueue()
    wire = Wire(queue)
    controller = CanController(wire.attach("a"), lambda _t, _f: None)
    controller.accept((FULL_MASK, [0x91]), (FULL_MASK, [0x221, 0x231, 0x232]))
    assert controller.port.passes(0x231)
    assert not controller.port.passes(0x233)
    with pytest.raises(ValueError, match="masks"):
        controller.accept((1, [1]), (2, [2]), (3, [3]))
    with pytest.raises(ValueError, match="filters"):
        controller.accept((1, [1, 2, 3]), (2, [1, 2, 3]))
