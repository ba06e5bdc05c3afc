"""Faults of chips, sensors, actuators and the plant, each while it is on and after."""

import itertools
from typing import Any

import numpy as np
import pytest

from bus.protocol import Device, Opcode
from bus.protocol.serial import PacketDecoder
from plant.kernels import layout as at
from scenarios.lab.prepare import chosen
from scenarios.lab.wiring import wired
from tests.scenarios.lab.faults.lab import EXAMPLES, Lab

REPLY_AXIS = 0x100 + Device.AXIS_RA


def test_lost_frames_are_on_the_bus_and_not_at_the_gateway() -> None:
    lab = Lab().run(0.1)
    heard: list[int] = []
    lab.network.hid.to_host = lambda _t, report: heard.extend(report[::8])
    number = lab.faults.start("frame_loss", node="POSITION_RA")
    start = lab.now_ns
    lab.run(0.01)
    heard.clear()
    lab.run(0.1)
    assert "POSITION_RA" in lab.senders(start)
    assert Device.POSITION_RA not in heard
    assert Device.POSITION_DEC in heard
    lab.faults.clear(number)
    lab.run(0.1)
    assert Device.POSITION_RA in heard


def test_a_deaf_controller_answers_nobody_and_sends() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("deaf_controller", node="AXIS_RA")
    start = lab.now_ns
    lab.command(Device.AXIS_RA, Opcode.PING)
    lab.run(0.1)
    identifiers = {frame.identifier for _, frame, _ in lab.since(start)}
    assert REPLY_AXIS not in identifiers
    assert 0x200 + Device.AXIS_RA in identifiers
    lab.faults.clear(number)
    lab.command(Device.AXIS_RA, Opcode.PING)
    lab.run(0.1)
    assert REPLY_AXIS in {frame.identifier for _, frame, _ in lab.since(start)}


def test_a_disturbed_encoder_line_shows_as_a_wrong_crc() -> None:
    lab = Lab().run(0.1)
    number = lab.faults.start("endat_line", axis="ra", probability=1.0)
    start = lab.now_ns + 1_000_000
    lab.run(0.1)
    shown = lab.positions(start)
    assert {flags for flags, _ in shown} == {0x04}  # CRC error; a CRC-5 finds every single bit
    assert len({position for _, position in shown}) == 1
    lab.faults.clear(number)
    start = lab.now_ns + 1_000_000
    lab.run(0.05)
    assert {flags for flags, _ in lab.positions(start)} == {0}


def test_noise_on_a_serial_line_breaks_packets() -> None:
    lab = Lab().run(0.1)
    decoder, packets = PacketDecoder(), []
    lab.network.uarts["POSITION_RA"].sink = lambda _t, data: packets.extend(decoder.feed(data))
    number = lab.faults.start("serial_noise", node="POSITION_RA", probability=1.0)
    lab.run(1.0)
    assert packets == []
    lab.faults.clear(number)
    lab.run(1.0)
    assert len(packets) in (3, 4)


def ramp(t_ns: int) -> int:
    return t_ns // 1000  # one count a microsecond


def moving(kind: str, **arguments: object) -> tuple[list[int], list[int]]:
    """What POSITION_RA shows less what it should show, during a fault and after it, counts."""
    lab = Lab()
    lab.network.boards["POSITION_RA"].endat.encoder.pin = ramp
    lab.run(0.1)
    number = lab.faults.start(kind, sensor="ra.absolute", **arguments)
    during = differences(lab, 0.2)
    lab.faults.clear(number)
    assert lab.network.boards["POSITION_RA"].endat.encoder.pin is ramp
    return during, differences(lab, 0.05)


def differences(lab: Lab, seconds: float) -> list[int]:
    start = lab.now_ns + 1_000_000
    lab.run(seconds)
    found = []
    for t_ns, frame, _ in lab.since(start):
        if frame.identifier == 0x200 + Device.POSITION_RA:
            latched_ns = (
                t_ns - 1
            )  # the frame is some 300 us behind its latch: the ramp's error, not the fault's
            found.append(int.from_bytes(frame.data[2:6], "little") - ramp(latched_ns))
    return found


LATE = range(-700, -100)
"""From the latch to the end of the frame: the routine's cost, 130 us on the bus, waiting for others."""


def test_a_stuck_sensor_stands_still() -> None:
    during, after = moving("sensor_stuck")
    assert np.allclose(np.diff(during), -5000, atol=500)
    assert all(each in LATE for each in after)


def test_a_noisy_sensor_has_the_noise_asked_for() -> None:
    during, after = moving("sensor_noise", deviation=10_000)
    assert 6_000 < np.std(during) < 15_000  # 40 readings: the deviation is known to 11 %
    assert all(each in LATE for each in after)


def test_a_biased_sensor_is_shifted() -> None:
    during, after = moving("sensor_bias", offset=123_456)
    assert all(each - 123_456 in LATE for each in during)
    assert all(each in LATE for each in after)


def test_a_wrong_scale_is_a_factor() -> None:
    during, after = moving("sensor_scale", factor=2.0)
    assert np.allclose(np.diff(during), 5000, atol=500)  # it runs twice as fast
    assert all(each in LATE for each in after)


def test_a_delayed_sensor_is_late() -> None:
    during, after = moving("sensor_delayed", delay="50 ms")
    assert all(each + 50_000 in LATE for each in during[12:])
    assert all(each in LATE for each in after)


def test_a_bad_contact_shows_old_readings_now_and_then() -> None:
    during, after = moving("sensor_intermittent", probability="50 %")
    late = sum(each not in LATE for each in during)
    assert 8 <= late <= 32  # of 40, half; three deviations are 9.5
    assert all(each in LATE for each in after)


def test_currents_and_levels_have_faults_too() -> None:
    lab = Lab().pull(200)  # well below the end of the converter, 6.2 A
    adc = lab.network.boards["AXIS_RA"].adc
    right = adc.read(lab.now_ns, 0), adc.read(lab.now_ns, 1)
    number = lab.faults.start("sensor_bias", sensor="ra.current_a", offset=1.0)
    assert adc.read(lab.now_ns, 0) - right[0] in (163, 164)  # 0.8 V/A, 204.8 counts/V
    assert adc.read(lab.now_ns, 1) == right[1]
    lab.faults.clear(number)
    lab.faults.start("sensor_bias", sensor="focus.lvdt", offset=0.5)
    lab.faults.start("sensor_stuck", sensor="focus.index")
    lab.run(0.05)


def test_declared_boards_have_faulty_sensors_too() -> None:
    network, faults = wired(*chosen(network_name="final"))
    board: Any = network.boards["AUXILIARY_RA"]
    pin = board.pins["encoder"]
    number = faults.start("sensor_bias", sensor="ra.auxiliary", offset=100)
    assert board.pins["encoder"](0) == pin(0) + 100
    faults.clear(number)
    assert board.pins["encoder"] is pin


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_faults_of_one_pin_are_cleared_in_any_order(order: tuple[int, ...]) -> None:
    lab = Lab()
    chip = lab.network.boards["POSITION_RA"].endat.encoder
    pin = chip.pin
    for kind in ("sensor_bias", "sensor_scale", "sensor_bias"):
        lab.faults.start(kind, **EXAMPLES[kind])
    value = pin(0)
    assert chip.pin(0) == round((value + 1000) * 0.5) + 1000
    for number in order:
        assert chip.pin is not pin
        lab.faults.clear(number)
    assert chip.pin is pin


def test_a_stuck_pwm_ignores_what_is_written() -> None:
    lab = Lab().pull(1500)
    held = lab.world(at.DUTY)
    number = lab.faults.start("pwm_stuck", axis="ra")
    lab.command(Device.AXIS_RA, Opcode.OPEN_LOOP, 600)
    lab.run(0.05)
    assert lab.world(at.DUTY) == held
    lab.faults.clear(number)
    assert lab.world(at.DUTY) < held  # what was written last
    assert lab.world(at.DUTY) > 0.0


def test_an_open_motor_has_no_current() -> None:
    lab = Lab().pull()
    assert lab.world(at.OUT + at.OUT_CURRENT_A) > 0.5
    number = lab.faults.start("motor_open", axis="ra", motor="a")
    lab.run(0.05)
    assert lab.world(at.OUT + at.OUT_CURRENT_A) < 0.01
    lab.faults.clear(number)
    lab.run(0.05)
    assert lab.world(at.OUT + at.OUT_CURRENT_A) > 0.5


def test_a_shorted_switch_drives_its_motor_with_everything() -> None:
    lab = Lab().run(0.05)
    number = lab.faults.start("mosfet_short", axis="dec", motor="b")
    lab.run(0.1)
    current, limit = (
        lab.world(at.OUT + at.OUT_CURRENT_B, 1),
        lab.world(at.VOLTAGE, 1) / lab.world(at.RESISTANCE, 1),
    )
    assert 0.3 * limit < current <= 1.01 * limit  # V/R, less what turning takes
    lab.faults.clear(number)
    lab.run(1.0)  # until the axis stands: before, it drives current through the diode
    assert lab.world(at.OUT + at.OUT_CURRENT_B, 1) < 0.01


def test_a_weak_supply_pulls_less() -> None:
    strong, weak = Lab(), Lab()
    voltage = strong.world(at.VOLTAGE)
    number = weak.faults.start("weak_supply", factor="50 %")
    currents = [lab.pull().world(at.OUT + at.OUT_CURRENT_A) for lab in (strong, weak)]
    assert currents[1] == pytest.approx(0.5 * currents[0], rel=0.1)
    assert weak.world(at.VOLTAGE, 1) == 0.5 * voltage
    weak.faults.clear(number)
    assert weak.world(at.VOLTAGE) == weak.world(at.VOLTAGE, 1) == voltage


@pytest.mark.parametrize(("kind", "low", "high"), [("load_change", 0.3, 0.9), ("friction_change", -0.5, 0.9)])
def test_a_heavier_or_stiffer_axis_moves_less(kind: str, low: float, high: float) -> None:
    plain, changed = Lab(), Lab()
    changed.faults.start(kind, **EXAMPLES[kind])
    turns = []
    for lab in (plain, changed):
        start = lab.network.plant.ra.truth(0)[0]
        lab.pull(300).run(0.1)
        turns.append(lab.network.plant.ra.truth(lab.now_ns)[0] - start)
    assert turns[0] > 0
    assert low * turns[0] < turns[1] < high * turns[0]
    before = changed.world(at.INERTIA), changed.world(at.DECLARED_FRICTION + at.F_COULOMB)
    changed.faults.clear(0)
    after = changed.world(at.INERTIA), changed.world(at.DECLARED_FRICTION + at.F_COULOMB)
    assert after != before
    assert after == (plain.world(at.INERTIA), plain.world(at.DECLARED_FRICTION + at.F_COULOMB))


def test_more_play_is_more_play() -> None:
    lab = Lab().run(0.01)
    before = lab.world(at.HALF_PLAY)
    number = lab.faults.start("play_change", axis="ra", angle="10 arcmin")
    assert lab.world(at.HALF_PLAY) - before == pytest.approx(np.radians(5 / 60), rel=1e-9)
    lab.faults.clear(number)
    assert lab.world(at.HALF_PLAY) == before
