"""Declared boards by themselves: supplies, inputs over time, and what pins are wired to."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.core.declared import Pin
from bus.protocol.nodes import KindError
from scenarios.lab.nodes import Input, Site, Supply, pins_of


def number(value: float) -> Any:
    return SimpleNamespace(si=value)


class Rig:
    """A plant with a rail of 23 V on a supply of 24 V, motors of 1 to 4 A."""

    def __init__(self) -> None:
        def amperes(first: float) -> Any:
            return SimpleNamespace(current=lambda t_ns, motor: first + motor)

        supply = SimpleNamespace(voltage=number(24.0))
        model = SimpleNamespace(supply=supply)
        self.plant: Any = SimpleNamespace(
            ra=amperes(1.0), dec=amperes(3.0), focus=SimpleNamespace(), model=model, rail=lambda t_ns: 23.0
        )
        self.calls: list[tuple[str, str, int]] = []
        self.boards: dict[str, Any] = {name: self.board(name) for name in ("AXIS_RA", "AXIS_DEC", "FOCUS")}

    def board(self, name: str) -> Any:
        return SimpleNamespace(
            on=True,
            power_on=lambda t_ns: self.calls.append((name, "on", t_ns)),
            power_off=lambda t_ns: self.calls.append((name, "off", t_ns)),
        )


def test_a_supply_takes_a_board_s_share_and_its_motors() -> None:
    """0.15 A of each board that is on; 1 + 2 A of one axis, 3 + 4 A of the other."""
    rig = Rig()
    drives = Supply(rig.plant, rig.boards, [["AXIS_RA"], ["AXIS_DEC", "GONE"]])
    room = Supply(rig.plant, rig.boards, [["FOCUS"], []])
    assert (drives.voltage(0), room.voltage(0)) == (23.0, 24.0)
    assert drives.current(0) == pytest.approx(2 * 0.15 + 3.0 + 7.0)
    assert room.current(0) == pytest.approx(0.15)
    rig.boards["AXIS_RA"].on = False
    assert drives.current(0) == pytest.approx(0.15 + 10.0)


def test_relay_1_is_the_first_channel_and_switches_all_on_it() -> None:
    rig = Rig()
    supply = Supply(rig.plant, rig.boards, [["AXIS_RA", "AXIS_DEC"], ["GONE", "FOCUS"]])
    supply.relay(5, 1, False)
    supply.relay(6, 2, True)
    assert rig.calls == [("AXIS_RA", "off", 5), ("AXIS_DEC", "off", 5), ("FOCUS", "on", 6)]


@given(st.integers(0, 40))
def test_an_input_holds_each_value_from_its_time_on(t_ns: int) -> None:
    steps = Input([0, 10, 30], [1.0, 2.0, 3.0])
    assert steps(t_ns) == (1.0 if t_ns < 10 else 2.0 if t_ns < 30 else 3.0)


def site() -> Any:
    """A site without its plant's air."""
    made: Any = object.__new__(Site)
    made.ra, made.dec = SimpleNamespace(hand=lambda: "ra"), SimpleNamespace(hand=lambda: "dec")
    made.air = SimpleNamespace(wind=lambda t_ns: 7.0)
    made.supplies = {"X_RA": SimpleNamespace(volts=lambda: 24.0)}
    made.parts = {"X_RA": SimpleNamespace(turn=lambda: "turned")}
    made.value = SimpleNamespace(number=3)
    return made


@pytest.mark.parametrize(
    ("source", "board", "result"),
    [("ra.hand", "X_RA", "ra"), ("{side}.hand", "X_DEC", "dec"), ("supply.volts", "X_RA", 24.0),
     ("part.turn", "X_RA", "turned")],
)  # fmt: skip
def test_a_pin_is_wired_by_its_source(source: str, board: str, result: Any) -> None:
    assert site().pin(board, Pin("p", source), {})() == result


@pytest.mark.parametrize(
    "source", ["ra.none", "ra", "moon.hand", "ra._hidden", "supply.volts", "value.number"]
)
def test_a_source_that_is_not_there_is_said(source: str) -> None:
    made = site()
    made.ra._hidden = lambda: 1
    with pytest.raises(KindError) as caught:
        made.pin("Y_RA", Pin("p", source), {})
    assert str(caught.value) == f"board Y_RA: pin p: there is no {source} to wire it to"


def test_a_free_pin_is_the_scenario_s_the_air_s_or_its_default() -> None:
    made, given_input = site(), Input([0], [5.0])
    wind = Pin("wind", default=2.0)
    assert made.pin("WEATHER_MAST", wind, {"wind": given_input})(0) == 5.0
    assert made.pin("WEATHER_MAST", wind, {})(0) == 7.0
    assert made.pin("X_RA", wind, {})(0) == 2.0
    assert made.pin("WEATHER_MAST", Pin("rain", default=1.5), {})(9) == 1.5


class Declared:
    """What a declared board says of its pins."""

    PINS = (Pin("door", default=1.0), Pin("volts", "supply.volts"))
    PART: Callable[[], Any] | None = None


def test_inputs_are_numbers_or_steps_and_before_the_first_the_default() -> None:
    board: Any = Declared
    assert pins_of(board, "X_RA", site(), {"door": 4})["door"](0) == 4.0
    steps = pins_of(board, "X_RA", site(), {"door": [{"at": 0.5, "value": 2}, {"at": 40.0, "value": 3}]})[
        "door"
    ]
    moments = (0, 499_999_999, 500_000_000, 39_999_999_999, 40_000_000_000)
    assert [steps(t_ns) for t_ns in moments] == [1.0, 1.0, 2.0, 2.0, 3.0]
    at_once = pins_of(board, "X_RA", site(), {"door": [{"at": 0.0, "value": 2}]})["door"]
    assert at_once(0) == 2.0


@pytest.mark.parametrize("times", [[1.0, 1.0], [2.0, 1.0]])
def test_times_that_do_not_rise_are_refused(times: list[float]) -> None:
    board: Any = Declared
    given_steps = [{"at": at_s, "value": 1} for at_s in times]
    with pytest.raises(KindError, match=r"^network: nodes\.X_RA\.inputs\.door: the times must rise$"):
        pins_of(board, "X_RA", site(), {"door": given_steps})


def test_an_input_that_the_board_has_not_is_said_with_those_it_has() -> None:
    board: Any = Declared
    with pytest.raises(KindError) as caught:
        pins_of(board, "X_RA", site(), {"volts": 1})
    assert str(caught.value) == "network: nodes.X_RA.inputs: there is no input 'volts'; it has door"
    board = SimpleNamespace(PINS=(), PART=None)
    with pytest.raises(KindError, match=r"it has none$"):
        pins_of(board, "X_RA", site(), {"x": 1})


def test_a_part_is_the_board_s_own() -> None:
    made = site()
    board: Any = SimpleNamespace(
        PINS=(Pin("turn", "part.turn"),), PART=lambda: SimpleNamespace(turn=lambda: 9)
    )
    assert pins_of(board, "Z", made, {})["turn"]() == 9 and "Z" in made.parts
