"""Values at and beyond limits: what is sent, what is put back, and each way of being wrong word by word."""

from collections.abc import Callable

import pytest

from bus.conformance import CheckResult
from bus.conformance.limits import PARAMETERS, _parameter, check_limits, parameters_of
from bus.protocol import Opcode
from bus.protocol.nodes import DEVICES
from tests.conformance.scripted import (
    AXIS,
    DISPLAY,
    FOCUS,
    GATEWAY,
    OK,
    OUTSIDE,
    REFUSED,
    ScriptedBus,
    Store,
    Verdict,
    board,
    declared,
    link_on,
    told,
)

I32, TURN, SUPPLY = 2**31 - 1, 2**29 - 1, 3000 * 256
FASTEST = 318_557_389  # 3.1 deg/s: 11160 arcsec/s x 112896000 / 1296000 counts / 200 ticks x 65536
AXIS_LIMITS = {
    1: (10, 25), 2: (0, 1048576), 3: (0, 1048576), 4: (0, TURN), 5: (0, TURN),
    6: (1, 10_276_044),  # 7200 arcsec/s are 205520896, in 20 ticks of 5 ms
    **dict.fromkeys((7, 8, 9, 10, 11), (1, FASTEST)),
    12: (0, 1), 13: (0, 1), 14: (0, SUPPLY), 15: (1, 112_896_000),
    **{16 + 3 * line: (0, I32) for line in range(8)},
    **{k + 3 * line: (-SUPPLY, SUPPLY) for line in range(8) for k in (17, 18)},
    40: (0, 76_800), 41: (0, 1), 42: (0, 15),
    **dict.fromkeys(range(44, 69), (-I32, I32)),
}  # fmt: skip


def test_the_table_is_the_papers_and_the_protocols() -> None:
    assert parameters_of(AXIS) == AXIS_LIMITS == PARAMETERS["AXIS"]
    assert PARAMETERS["POSITION"] == {4: (0, TURN), 5: (0, TURN)}
    assert parameters_of(DISPLAY) == {}
    assert parameters_of(declared("DOME", DEVICES)) == {1: (10, 1000), 2: (0, 1)}
    assert parameters_of(declared("AUXILIARY_RA", DEVICES)) == {}


GET = "0d1: 51 02 07 00 00 00 00 00"


def put(value: int) -> str:
    return f"0d1: 51 03 07 {value.to_bytes(4, 'little', signed=True).hex(' ')} 00"


def store() -> Store:
    found = Store({7: (1, 10)})
    found.values[7] = 4
    return found


def checked(verdict: Callable[[bytes], Verdict | None]) -> CheckResult:
    """Of parameter 7 of a board that judges so."""
    return next(_parameter(link_on(ScriptedBus(board(0x51, verdict))), DISPLAY, 7, 1, 10))


def test_a_parameter_is_set_to_its_limits_and_beyond_and_put_back() -> None:
    bus = ScriptedBus(board(0x51, store(), after_s=0.25), now_s=8.0)
    (result,) = _parameter(link_on(bus), DISPLAY, 7, 1, 10)
    expected = "1..10 taken, beyond refused, 4 put back"
    assert told([result]) == [f"ok limits: DISPLAY parameter 7: {expected} | so"]
    steps = [line for value in (1, 10, 0, 11) for line in (put(value), GET)]
    assert bus.lines() == [GET, *steps, put(4)]
    assert result.duration_s == pytest.approx(10 * 0.2505)


@pytest.mark.parametrize(
    ("low", "high", "beyond"), [(-I32, I32, [-I32 - 1]), (-I32 - 1, I32 - 1, [I32]), (-I32 - 1, I32, [])]
)
def test_what_has_no_room_in_a_command_is_not_sent(low: int, high: int, beyond: list[int]) -> None:
    bus = ScriptedBus(board(0x51, Store({7: (low, high)})))
    (result,) = _parameter(link_on(bus), DISPLAY, 7, low, high)
    assert result.passed
    assert [line for line in bus.lines() if line != GET] == [*map(put, (low, high, *beyond, high))]


@pytest.mark.parametrize(
    ("call", "verdict", "said"),
    [
        (1, (OUTSIDE, 7, 4), "1: OUT_OF_RANGE parameter 7 value 4"),
        (1, (OK, 8, 1), "1: OK parameter 8 value 1"),
        (1, None, "1: no reply"),
        (2, (OK, 7, 4), "1: then OK parameter 7 value 4"),
        (2, (OK, 8, 1), "1: then OK parameter 8 value 1"),
        (2, None, "1: then no reply"),
        (3, (6, 7, 10), "10: result 6 parameter 7 value 10"),
        (4, (OK, 7, 9), "10: then OK parameter 7 value 9"),
        (5, (OK, 7, 0), "0: OK parameter 7 value 0"),
        (6, (OK, 7, 0), "0: then OK parameter 7 value 0"),
        (7, (REFUSED, 7, 0), "11: NOT_ALLOWED parameter 7 value 0"),
        (8, (OK, 7, 11), "11: then OK parameter 7 value 11"),
        (9, (OK, 7, 5), "4 put back: OK parameter 7 value 5"),
        (9, (OUTSIDE, 7, 4), "4 put back: OUT_OF_RANGE parameter 7 value 4"),
        (9, None, "4 put back: no reply"),
    ],
)
def test_each_way_of_being_wrong_is_told(call: int, verdict: Verdict | None, said: str) -> None:
    calls, sound = iter(range(10)), store()

    def spoiled(data: bytes) -> Verdict | None:
        right = sound(data)
        return verdict if next(calls) == call else right

    expected = "1..10 taken, beyond refused, 4 put back"
    assert told([checked(spoiled)]) == [f"error limits: DISPLAY parameter 7: {expected} | {said}"]


def test_all_that_is_wrong_is_told() -> None:
    result = checked(lambda data: (OK, 7, data[3]))
    said = "1: then {0} 0; 10: then {0} 0; 0: {0} 0; 11: {0} 11".format("OK parameter 7 value")
    assert result.observed == said


@pytest.mark.parametrize(
    ("verdict", "said"), [(None, "no reply"), ((OUTSIDE, 7, 3), "OUT_OF_RANGE parameter 7 value 3")]
)
def test_a_parameter_that_cannot_be_read_is_left_alone(verdict: Verdict | None, said: str) -> None:
    bus = ScriptedBus(board(0x51, lambda _: verdict, after_s=0.9995), now_s=8.0)
    (result,) = _parameter(link_on(bus, reply_s=1.0), DISPLAY, 7, 1, 10)
    assert told([result]) == [f"error limits: DISPLAY parameter 7: a value | {said}"]
    assert bus.lines() == [GET]
    assert result.duration_s == pytest.approx(1.0)


def test_an_interrupt_leaves_no_parameter_changed() -> None:
    sound = store()

    def interrupted(data: bytes) -> Verdict:
        if data[1:4] == b"\x03\x07\x0a":
            raise KeyboardInterrupt
        return sound(data)

    with pytest.raises(KeyboardInterrupt):
        checked(interrupted)
    assert sound.values == {7: 4}


BEYOND = (
    "SET_RATE 318557390", "SET_RATE -318557390", "OPEN_LOOP 3001", "OPEN_LOOP -3001", "SET_CLASS 0 1",
    "SET_CLASS 6 1", "SET_CLASS 1 -2", "SET_CLASS 1 2", "POWER 255",
)  # fmt: skip
AT = (
    "SET_RATE 318557389", "SET_RATE -318557389", "OPEN_LOOP 3000", "OPEN_LOOP -3000", "SET_CLASS 1 -1",
    "SET_CLASS 5 1",
)  # fmt: skip


@pytest.mark.parametrize(
    ("motion", "low", "high", "targets"),
    [
        (True, 5, 9, ["MOVE_TO 4 1", "MOVE_TO 10 1"]),
        (False, 1, 0, ["MOVE_TO 0 1", "MOVE_TO 1 1"]),
        (False, 0, TURN, [f"MOVE_TO {TURN + 1} 1"]),
    ],
)
def test_an_axis_is_asked_for_what_it_may_not_take(
    motion: bool, low: int, high: int, targets: list[str]
) -> None:
    sound = Store(AXIS_LIMITS)
    sound.values |= {4: low, 5: high}
    bus = ScriptedBus(board(0x11, sound))
    results = list(check_limits(link_on(bus, motion=motion), AXIS))
    numbers = [f"AXIS_RA parameter {number}" for number in sorted(AXIS_LIMITS)]
    assert [each.subject for each in results if each.passed] == numbers
    wanted = [(each, "OUT_OF_RANGE") for each in (*BEYOND, *targets)]
    wanted += [(each, "NOT_ALLOWED") for each in AT if motion]
    assert told(results[len(numbers) :]) == [
        f"error limits: AXIS_RA {subject}: one reply: {result} | OK" for subject, result in wanted
    ]


def test_an_axis_that_does_not_tell_its_limits_is_sent_no_targets() -> None:
    for verdict in ((OUTSIDE, 4, 5), None):
        bus = ScriptedBus(board(0x11, lambda _, verdict=verdict: verdict))  # type: ignore[misc]
        list(check_limits(link_on(bus, reply_s=0.001, quiet_s=0.001), AXIS))
        assert not [each for each in bus.sent if each.data[1] == Opcode.MOVE_TO]


def test_other_boards_are_asked_at_their_limits_too() -> None:
    assert told(check_limits(link_on(ScriptedBus(board(0x51))), DISPLAY)) == [
        "error limits: DISPLAY BRIGHTNESS 255: one reply: OUT_OF_RANGE | OK",
        "ok limits: DISPLAY BRIGHTNESS 0: one reply: OK | OK",
        "ok limits: DISPLAY BRIGHTNESS 100: one reply: OK | OK",
    ]
    assert told(check_limits(link_on(ScriptedBus(board(0x41, lambda _: (OUTSIDE, 0, 0)))), FOCUS)) == [
        "ok limits: FOCUS FOCUS_MOVE_TO 801: one reply: OUT_OF_RANGE | OUT_OF_RANGE",
        "ok limits: FOCUS FOCUS_MOVE_TO -801: one reply: OUT_OF_RANGE | OUT_OF_RANGE",
    ]
    assert told(check_limits(link_on(ScriptedBus()), GATEWAY)) == []
