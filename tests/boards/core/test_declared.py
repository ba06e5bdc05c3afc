"""What a declaration makes of a board, and what is said when the author's own code fails."""

import inspect
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from boards.core import Place
from boards.core.declared import BoardError, DeclaredBoard, Pin, board_error, uart_of
from boards.power.firmware import PowerBoard
from boards.weather.firmware import WeatherBoard
from bus.can import Wire
from bus.protocol import Health, State, unpack_heartbeat
from bus.protocol.nodes import POWER, WEATHER, Kind
from bus.protocol.serial import PacketDecoder
from bus.time import EventQueue, Oscillator
from tests.boards.alone import MS, SECOND, Alone

NUMBER, POWER_DRIVES = 0x72, 0x73
FIRST_MS = 1000.0012
"""The first second of the board's timer, and 12 cycles at 10 MHz."""


class Odd(WeatherBoard):
    """Measures whatever it is told to."""

    given: Any = None

    def measure(self, t_ns: int) -> Mapping[str, float]:
        if isinstance(self.given, BaseException):
            raise self.given
        found: Mapping[str, float] = self.given
        return found


def fails(given: Any) -> str:
    """What is said of a measure, behind board and time."""
    alone = Alone(Odd, NUMBER)
    alone.board.given = given
    with pytest.raises(BoardError) as caught:
        alone.run(1.1)
    where = f"{__file__}: board WEATHER_MAST fails at {FIRST_MS / 1000:.6g} s: "
    assert str(caught.value).startswith(where) and caught.value.__cause__ is None
    return str(caught.value).removeprefix(where)


class Wordless(Exception):
    def __str__(self) -> str:
        raise ValueError


@pytest.mark.parametrize(("given", "reason"), [
    ([], "measure returned list, expected a mapping of signals"),
    (None, "measure returned NoneType, expected a mapping of signals"),
    ({"Rain": "wet"}, "measure returned Rain as str, expected a number"),
    ({"Wind": float("nan")}, "measure returned Wind that is no finite number"),
    ({"Wind": float("inf")}, "measure returned Wind that is no finite number"),
    ({"Wind": 10**400}, "measure returned Wind that is no finite number"),
    ({"Rain": 0, "Snow": 1, "Hail": 1}, "LookupError: measure returned Hail, which no frame has"),
    (ValueError("two\n lines"), "ValueError: two lines"), (ValueError(), "ValueError"),
    (Wordless(), "Wordless"),
])  # fmt: skip
def test_a_measure_that_cannot_be_sent_is_one_line(given: Any, reason: str) -> None:
    assert fails(given) == reason


def test_an_interruption_is_no_fault_of_the_board() -> None:
    alone = Alone(Odd, NUMBER)
    alone.board.given = KeyboardInterrupt()
    with pytest.raises(KeyboardInterrupt):
        alone.run(1.1)
    with pytest.raises(KeyboardInterrupt):
        board_error(Odd, "a", 0, KeyboardInterrupt())


def test_signals_that_are_missing_are_nothing_and_further_ones_are_not_missed() -> None:
    alone = Alone(Odd, NUMBER)
    alone.board.given = {"Wind": 3, "Humid": True}
    alone.run(1.1)
    assert (alone.said()["Wind"], alone.said()["Humid"], alone.said()["Humidity"]) == (3.0, 1, 0)


class Broken(PowerBoard):
    """Whose own code says nothing that a frame can hold."""

    def relay(self, t_ns: int, channel: int, on: int) -> None:
        raise ArithmeticError(f"relay {channel}")


def test_a_command_that_fails_is_the_boards() -> None:
    alone = Alone(Broken, POWER_DRIVES, voltage=24.0)
    with pytest.raises(
        BoardError, match=r"board POWER_DRIVES fails at 0\.00\d+ s: ArithmeticError: relay 3$"
    ):
        alone.command("RELAY", 3, 0)


def test_a_state_or_health_that_no_frame_holds_is_the_boards(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = Alone(PowerBoard, POWER_DRIVES, voltage=24.0)
    monkeypatch.setattr(PowerBoard, "health", lambda _: "well")
    with pytest.raises(BoardError, match="fails at 2 s: health cannot be sent"):
        alone.board._ping(2 * SECOND)
    monkeypatch.setattr(PowerBoard, "state", lambda _: 300)
    with pytest.raises(BoardError, match="state cannot be sent: "):
        alone.run(0.3)


def test_a_heartbeat_comes_with_the_first_frame_and_once_a_second() -> None:
    alone = Alone(PowerBoard, POWER_DRIVES, voltage=24.0)
    alone.run(3.1)
    beats = [(t_ns, unpack_heartbeat(f.data)) for t_ns, f in alone.frames if f.identifier == 0x773]
    assert [round(t_ns / SECOND, 2) for t_ns, _ in beats] == [0.25, 1.25, 2.25]
    assert [beat.state for _, beat in beats] == [State.READY] * 3
    assert [round(t_ns / SECOND, 2) for t_ns, _ in alone.told()] == [k / 4 for k in range(1, 13)]


def test_parameters_have_the_bounds_of_the_declaration_and_come_back_with_power() -> None:
    alone = Alone(PowerBoard, POWER_DRIVES, voltage=24.0)
    rows = {row.number: (row.name, row.low, row.high, row.read()) for row in alone.board.parameters.rows()}
    assert rows == {1: ("undervoltage_mv", 0, 30000, 20000), 2: ("overcurrent_ma", 0, 60000, 30000)}
    assert alone.board.parameters.set(1, 12345) == (0, 1, 12345)
    assert alone.board.values["undervoltage_mv"].get() == 12345
    alone.board.reset()
    assert alone.board.values["undervoltage_mv"].get() == 20000
    assert sorted(alone.board.commands) == [1, 2, 3, 72]


def test_a_packet_has_25_of_its_frames_and_its_parts_leave_at_once() -> None:
    alone = Alone(PowerBoard, POWER_DRIVES, voltage=24.0, current=5.0)
    packets: list[tuple[int, bytes]] = []
    parts: list[tuple[int, bytes]] = []
    uart = uart_of(alone.board)
    assert uart is alone.board.uart
    uart.sink = lambda t_ns, data: packets.append((t_ns, data))
    uart.line = lambda t_ns, data: parts.append((t_ns, data))
    alone.run(13.0)
    decoder = PacketDecoder([POWER_DRIVES])
    found = [packet for _, data in packets for packet in decoder.feed(data)]
    assert [(packet.device, packet.sequence, packet.stamp) for packet in found] == [
        (POWER_DRIVES, 0, 2500), (POWER_DRIVES, 1, 65_000),
    ]  # fmt: skip
    own = [tuple(frame.data[1:]) for _, frame in alone.told()]
    assert [row for packet in found for row in packet.rows] == own[:50]
    assert b"".join(data for _, data in parts)[: sum(len(data) for _, data in packets)] == b"".join(
        data for _, data in packets
    )
    assert [len(data) for _, data in parts[:26]] == [2 + 6 + 7, *[7] * 23, 7 + 2, 2 + 6 + 7]
    cost_ns = 100_000
    assert parts[0][0] == 250 * MS + 1200 + cost_ns


def test_power_begins_a_packet_afresh_and_numbers_go_on() -> None:
    alone = Alone(PowerBoard, POWER_DRIVES, voltage=24.0)
    packets: list[bytes] = []
    alone.board.uart.sink = lambda _t_ns, data: packets.append(data)
    alone.run(7.0)
    alone.board.power_off(alone.queue.now_ns)
    alone.board.power_on(alone.queue.now_ns)
    alone.run(7.0)
    assert [data[3] for data in packets] == [0, 1]
    (packet,) = PacketDecoder([POWER_DRIVES]).feed(packets[1])
    own = [tuple(frame.data[1:]) for _, frame in alone.told()]
    assert list(packet.rows) == own[28:53]  # four a second, of seven seconds, went before
    assert packet.stamp == 10_000 * 7.5  # the first of them; a boot of 300 ms ends between two
    alone.board.packets.sequence = 255
    alone.run(6.3)
    alone.run(6.3)
    assert [data[3] for data in packets[2:]] == [255, 0]


def test_who_has_no_line_has_none() -> None:
    alone = Alone(PowerBoard, POWER_DRIVES)
    del alone.board.uart
    assert uart_of(alone.board) is None


def test_a_value_that_does_not_fit_its_field_is_told() -> None:
    alone = Alone(Odd, NUMBER)
    alone.board.given = {"Wind": 1000.0}
    alone.run(1.1)
    assert alone.said()["Wind"] == 75.0
    assert Health.RANGE in alone.board.health() and alone.board.clipped == 1


def made(kind: Kind) -> DeclaredBoard:
    board = type("Made", (WeatherBoard,), {"KIND": kind})
    wire = Wire(EventQueue())
    place = Place(
        name="WEATHER_MAST", device_type=NUMBER, queue=wire.queue, wire=wire, oscillator=Oscillator(0.0, 0)
    )
    found: DeclaredBoard = board(place, {pin.name: lambda _t: 0.0 for pin in WeatherBoard.PINS})
    return found


@pytest.mark.parametrize(("period_ms", "good"), [(1000, True), (500, True), (300, False), (2000, False)])
def test_a_period_divides_the_second_of_the_heartbeat(tmp_path: Path, period_ms: int, good: bool) -> None:
    text = WEATHER.dbc.read_text(encoding="utf-8").replace("BO_ 512 1000;", f"BO_ 512 {period_ms};")
    (tmp_path / f"weather{period_ms}.dbc").write_text(text, encoding="utf-8")
    kind = replace(WEATHER, name=f"WEATHER{period_ms}", dbc=tmp_path / f"weather{period_ms}.dbc")
    if good:
        assert made(kind).period_ns == period_ms * MS
        return
    words = f"{kind.dbc}: periods must be multiples of the shortest, which divides 1 s"
    with pytest.raises(ValueError, match=re.escape(words)):
        made(kind)


def test_a_board_without_supply_is_as_after_power_up() -> None:
    wire = Wire(EventQueue())
    place = Place(
        name="POWER_DRIVES", device_type=POWER_DRIVES, queue=wire.queue, wire=wire,
        oscillator=Oscillator(0.0, 0),
    )  # fmt: skip
    board = PowerBoard(place, {})
    assert (board.relays, board.wrong, board.on) == (255, False, False)


def test_each_frame_has_its_own_period(tmp_path: Path) -> None:
    text = WEATHER.dbc.read_text(encoding="utf-8").replace("BO_ 512 1000;", "BO_ 512 500;")
    slow = 'BO_ 768 SLOW: 8 NODE\n SG_ Count : 16|8@1+ (1,0) [0|255] "" GATEWAY\n\n'
    text = text.replace("BO_ 512 WEATHER", f"{slow}BO_ 512 WEATHER")
    text = text.replace("BO_ 512 500;", 'BO_ 512 500;\nBA_ "GenMsgCycleTime" BO_ 768 1000;')
    (tmp_path / "both.dbc").write_text(text, encoding="utf-8")
    board = made(replace(WEATHER, name="BOTH", dbc=tmp_path / "both.dbc"))
    sent: list[int] = []
    partner = board.port._wire.attach("partner")
    partner.on_receive = lambda _t, frame: sent.append(frame.identifier)
    board.begin()
    board.queue.run_until(4 * SECOND + 100 * MS)
    assert (sent.count(0x200 + NUMBER), sent.count(0x300 + NUMBER)) == (8, 4)


def test_a_board_writes_its_own_measure() -> None:
    assert Pin("a") == ("a", "", 0.0, "")
    assert inspect.isfunction(DeclaredBoard.measure)
    alone = Alone(PowerBoard, POWER_DRIVES)
    with pytest.raises(NotImplementedError):
        DeclaredBoard.measure(alone.board, 0)
    assert alone.board.KIND is POWER
