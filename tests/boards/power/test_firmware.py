"""The power board: eight relays, two limits, and what happens without supply."""

import pytest

from boards.power.firmware import PowerBoard
from bus.protocol import Health, Result
from tests.boards.alone import SECOND, Alone

POWER_DRIVES = 0x73


@pytest.fixture
def alone() -> Alone[PowerBoard]:
    return Alone(PowerBoard, POWER_DRIVES, voltage=24.0, current=5.0)


def limits(alone: Alone[PowerBoard], millivolts: int, milliamperes: int) -> dict[str, float]:
    """What is said of the supply by these limits."""
    alone.board.values["undervoltage_mv"].value = millivolts
    alone.board.values["overcurrent_ma"].value = milliamperes
    alone.run(0.25)
    return alone.said()


def test_routines_take_what_the_table_says(alone: Alone[PowerBoard]) -> None:
    """100 us for two conversions, 60 us for a command, at 10 MHz."""
    sample, can = (alone.board.cpu.lines[name] for name in ("sample", "can"))
    assert (sample.cost_ns, sample.latency_ns, sample.source.level) == (100_000, 1200, False)
    assert (can.cost_ns, can.latency_ns, can.source.level) == (60_000, 1200, True)


def test_four_frames_a_second_have_ten_bits_of_each(alone: Alone[PowerBoard]) -> None:
    alone.run(1.1)
    assert len(alone.told()) == 4
    said = alone.said()
    assert said["Voltage"] == pytest.approx(614 * 40 / 1023, abs=0.001)  # 24 V is 613.8 counts
    assert said["Current"] == pytest.approx(128 * 40 / 1023, abs=0.001)  # 5 A is 127.9 counts
    assert (said["Relays"], said["UnderVoltage"], said["OverCurrent"]) == (255, 0, 0)
    assert alone.writes() == []


def test_a_supply_is_wrong_below_its_voltage_or_above_its_current(alone: Alone[PowerBoard]) -> None:
    alone.run(0.25)
    assert Health.FAULT not in alone.board.health()
    for millivolts, milliamperes, under, over in (
        (24_007, 5_006, 0, 0), (24_008, 5_006, 1, 0), (24_007, 5_004, 0, 1), (24_008, 5_004, 1, 1),
    ):  # fmt: skip
        said = limits(alone, millivolts, milliamperes)  # 24.0078 V and 5.0049 A are read
        assert (said["UnderVoltage"], said["OverCurrent"]) == (under, over)
        assert (Health.FAULT in alone.board.health()) is bool(under or over)
    alone.pins.update(voltage=0.0, current=0.0)
    said = limits(alone, 0, 0)
    assert (said["UnderVoltage"], said["OverCurrent"]) == (0, 0)  # at the limit is within it


@pytest.mark.parametrize("channel", [1, 3, 8])
def test_a_relay_is_driven_when_it_changes(alone: Alone[PowerBoard], channel: int) -> None:
    for on, writes in (
        (1, []), (0, [("relay", channel, False)]), (0, []), (1, [("relay", channel, True)]), (1, []),
    ):  # fmt: skip
        assert alone.command("RELAY", channel, on) == Result.OK
        assert alone.writes() == writes
        alone.run(0.25)
        assert alone.said()["Relays"] == (255 if on else 255 - 2 ** (channel - 1))


@pytest.mark.parametrize(("channel", "on"), [(0, 0), (9, 0), (1, 2)])
def test_a_relay_that_there_is_not_is_out_of_range(alone: Alone[PowerBoard], channel: int, on: int) -> None:
    assert alone.command("RELAY", channel, on) == Result.OUT_OF_RANGE
    assert alone.writes() == []


def test_without_supply_every_relay_falls_back_closed(alone: Alone[PowerBoard]) -> None:
    for channel in (1, 8):
        alone.command("RELAY", channel, 0)
    alone.writes()
    alone.board.power_off(alone.queue.now_ns)
    assert alone.writes() == [("relay", 1, True), ("relay", 8, True)]


def test_after_power_up_all_is_closed_and_nothing_is_wrong(alone: Alone[PowerBoard]) -> None:
    alone.pins["voltage"] = 3.0
    alone.board.values["overcurrent_ma"].value = 1
    alone.command("RELAY", 5, 0)
    alone.run(1.0)
    assert Health.FAULT in alone.board.health()
    alone.pins["voltage"] = 24.0
    alone.board.power_off(alone.queue.now_ns)
    alone.board.power_on(alone.queue.now_ns)
    alone.queue.run_until(alone.queue.now_ns + SECOND // 3)
    assert (alone.board.relays, alone.board.wrong, alone.board.health()) == (255, False, Health(0))
    assert alone.board.values["overcurrent_ma"].value == 30_000
