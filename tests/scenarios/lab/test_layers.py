"""Things on an attribute: put on and taken away in any order; the proof that they acted."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.can import Frame
from bus.can.port import BusError
from plant.kernels import layout as at
from scenarios.lab.layers import AXES, Errors, Evidence, Laid, Stacks, Staged, Watched, chained, turned, words
from tests.scenarios.lab.faults.stub import acted


class Adds(Laid):
    """Adds its number to what is below."""

    def __init__(self, layers: Stacks, owner: Any, name: str, number: int) -> None:
        self.number = number
        super().__init__(layers, owner, name)

    def __call__(self, *arguments: Any) -> Any:
        return [*self.below(*arguments), self.number]

    def turn(self, value: int) -> int:
        return 10 * value + self.number


@given(st.permutations(range(4)))
def test_whatever_goes_first_the_rest_lies_in_its_order(order: list[int]) -> None:
    chip = SimpleNamespace(pin=list)
    base, layers = chip.pin, Stacks(chained)
    laid = [Adds(layers, chip, "pin", number) for number in range(4)]
    assert chip.pin() == [0, 1, 2, 3]
    left = list(range(4))
    for number in order:
        laid[number].clear(0)
        left.remove(number)
        assert chip.pin() == left
    assert chip.pin is base and not layers._stacks


def test_entries_of_a_dictionary_and_of_a_world_are_attributes_too() -> None:
    pins: dict[str, Any] = {"a": list, "b": list}
    layers = Stacks(chained)
    one, _ = Adds(layers, pins, "a", 1), Adds(layers, pins, "b", 2)
    assert (pins["a"](), pins["b"]()) == ([1], [2])
    one.clear(0)
    assert pins["a"]() == []
    world, dials = memoryview(bytearray(4)).cast("i"), Stacks(turned)
    world[0] = 5
    item = one
    dials.add(world, 0, item)
    assert world[0] == 51
    dials.remove(world, 0, item)
    assert world[0] == 5


def test_of_two_owners_with_one_name_each_has_its_own() -> None:
    first, second = SimpleNamespace(pin=3), SimpleNamespace(pin=3)
    layers, turn = Stacks(turned), SimpleNamespace(turn=lambda value: value + 1)
    layers.add(first, "pin", turn)
    layers.add(first, "pin", SimpleNamespace(turn=lambda value: value * 10))
    assert (first.pin, second.pin) == (40, 3)
    layers.remove(first, "pin", turn)
    assert first.pin == 30
    with pytest.raises(NotImplementedError):
        Laid(Stacks(chained), second, "pin")()


def test_evidence_keeps_the_first_time() -> None:
    evidence = Evidence("hang", {"node": "X"}, 2_000_000_000, may_not_act=False)
    assert evidence.missing
    assert evidence.as_json() == {
        "name": "hang", "arguments": {"node": "X"}, "at_s": 2.0,
        "first_s": None, "on": "", "may_not_act": False,
    }  # fmt: skip
    evidence.act(3_000_000_000, "frame")
    evidence.act(4_000_000_000, "sample")
    assert not evidence.missing
    assert (evidence.as_json()["first_s"], evidence.on) == (3.0, "frame")
    assert not Evidence("x").missing and Evidence("x").at_ns == 0 and Evidence("x").arguments == {}


def test_a_frame_in_words() -> None:
    assert words(Frame(0x11, bytes([0xAB, 1]))) == "frame 011#AB01"


def test_a_sample_unlike_the_first_one_shows_that_something_moved() -> None:
    readings = iter([0, 0, 7, 0])
    chip, evidence = SimpleNamespace(read=lambda t_ns: next(readings)), Evidence("x")
    layers = Stacks(chained)
    watched = Watched(layers, (chip, "read"), evidence, "ra.absolute")
    assert [chip.read(1), chip.read(2)] == [0, 0] and evidence.first_ns is None
    assert chip.read(3) == 7
    assert acted(evidence) == (3, "sample of ra.absolute")
    watched.clear(4)
    assert chip.read(5) == 0


class Board:
    """Two axis boards' PWM over a world of duties; written: what reaches the switches."""

    def __init__(self) -> None:
        self.written: list[tuple[int, float, float]] = []
        self.pwm = SimpleNamespace(drive=lambda t_ns, a, b: self.written.append((t_ns, a, b)))
        view = [0.0] * (2 * at.WIDTH)
        for axis, duties in ((0, (0.1, 0.2)), (1, (0.3, 0.4))):
            view[axis * at.WIDTH + at.DUTY : axis * at.WIDTH + at.DUTY + 2] = duties
        boards = {"AXIS_RA": SimpleNamespace(pwm=self.pwm), "AXIS_DEC": SimpleNamespace(pwm=self.pwm)}
        self.network: Any = SimpleNamespace(
            boards=boards, plant=SimpleNamespace(view=view), layers=Stacks(chained), queue=None
        )


class Half(Staged):
    """Half of what motor A is to have."""

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        return wanted[0] / 2, wanted[1]


class Plus(Staged):
    """A tenth more for motor A."""

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        return wanted[0] + 0.1, wanted[1]


class Cut(Staged):
    """Nothing, whatever lies there."""

    last = True

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        return 0.0, 0.0


@pytest.mark.parametrize(("axis", "wanted"), [("ra", (0.1, 0.2)), ("dec", (0.3, 0.4))])
def test_a_stage_acts_at_once_on_the_duties_that_are_there(axis: str, wanted: tuple[float, float]) -> None:
    board, evidence = Board(), Evidence("x")
    half = Half(board.network, axis, evidence, 5)
    assert board.written == [(5, wanted[0] / 2, wanted[1])]
    assert acted(evidence) == (5, f"duties of {axis}")
    board.pwm.drive(6, 0.8, 0.6)
    half.clear(7)
    assert board.written[1:] == [(6, 0.4, 0.6), (7, 0.8, 0.6)]
    assert AXES == {"ra": 0, "dec": 1}


def test_a_stage_that_changes_nothing_has_not_acted() -> None:
    board, evidence = Board(), Evidence("x")
    Half(board.network, "ra", evidence, 5)
    other, quiet = Board(), Evidence("y")
    other.network.plant.view[at.DUTY] = 0.0
    Half(other.network, "ra", quiet, 5)
    assert quiet.first_ns is None
    with pytest.raises(NotImplementedError):
        Staged(other.network, "ra", quiet, 5)


def test_a_later_stage_comes_after_an_earlier_one() -> None:
    board = Board()
    for kind in (Half, Plus):
        kind(board.network, "ra", Evidence("x"), 1)
    board.pwm.drive(2, 0.8, 0.6)
    assert board.written[-1] == pytest.approx((2, 0.5, 0.6))


@pytest.mark.parametrize("first", [Plus, Cut])
def test_the_last_word_is_had_whichever_came_first(first: type[Staged]) -> None:
    board = Board()
    second = Cut if first is Plus else Plus
    stages = [kind(board.network, "ra", Evidence("x"), 1) for kind in (first, second)]
    board.pwm.drive(2, 0.8, 0.6)
    assert board.written[-1] == (2, 0.0, 0.0)
    next(each for each in stages if isinstance(each, Cut)).clear(3)
    assert board.written[-1] == (3, 0.9, 0.6)  # wanted is what the board wrote last
    next(each for each in stages if isinstance(each, Plus)).clear(4)
    assert board.written[-1] == (4, 0.8, 0.6)


@pytest.mark.parametrize(("kind", "online", "mine", "acts"), [
    ("bit", True, True, True), ("", True, True, False),
    ("bit", False, True, False), ("bit", True, False, False),
])  # fmt: skip
@pytest.mark.parametrize("listens", [True, False])
def test_an_error_is_a_fault_s_while_it_is_online_and_its_own(
    kind: str, online: bool, mine: bool, acts: bool, listens: bool
) -> None:
    heard: list[tuple[int, BusError]] = []
    port: Any = SimpleNamespace(name="DISPLAY", online=online)
    port.on_error = (lambda *each: heard.append(each)) if listens else None
    evidence, error = Evidence("x"), BusError(kind)
    Errors(Stacks(chained), port, evidence, lambda: mine)
    port.on_error(9, error)
    assert heard == ([(9, error)] if listens else [])
    assert acted(evidence) == ((9, "bit error at DISPLAY") if acts else (None, ""))
