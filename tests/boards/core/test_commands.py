import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.core import OK, Answer, Parameter, ParameterTable, answer
from boards.core.commands import Command, commands, kept
from bus.protocol import Opcode, Result, pack_command

DEVICE = 0x11


def handler(_t_ns: int, arguments: bytes) -> Answer:
    return Answer(Result.OK, 7, len(arguments))


TABLE = {0x10: handler}


def test_one_answer_for_everything_that_can_be_wrong() -> None:
    cases = {
        bytes([DEVICE, 0x10, 0, 0, 0, 0, 0, 0]): (0x10, Result.OK),
        bytes([DEVICE, 0x77, 0, 0, 0, 0, 0, 0]): (0x77, Result.UNKNOWN_OPCODE),
        bytes([DEVICE, 0x10, 0, 0, 0, 0, 0]): (0x10, Result.WRONG_LENGTH),
        bytes([DEVICE]): (0, Result.WRONG_LENGTH),
        b"": (0, Result.WRONG_LENGTH),
        bytes([0x12, 0x10, 0, 0, 0, 0, 0, 0]): (0x10, Result.WRONG_DEVICE_TYPE),
    }
    for data, (opcode, result) in cases.items():
        got, reply = answer(DEVICE, TABLE, 0, data)
        assert (got, reply.result) == (opcode, result), data.hex(" ")


@given(st.binary(max_size=8))
def test_any_frame_is_answered(data: bytes) -> None:
    opcode, reply = answer(DEVICE, TABLE, 0, data)
    assert 0 <= opcode <= 0xFF
    assert reply.result in list(Result)


@given(st.integers(0, 2**32 - 1), st.integers(0, 255))
def test_arguments_are_taken_apart_as_the_protocol_has_them(target: int, speed_class: int) -> None:
    taken: list[tuple[int, ...]] = []
    command = Command(Opcode.MOVE_TO, lambda *values: taken.append(values))
    data = pack_command(DEVICE, Opcode.MOVE_TO, target, speed_class)
    assert command(17, data[2:]) == OK and taken == [(17, target, speed_class)]


@pytest.mark.parametrize(("effort", "result"), [(-3, Result.OK), (5, Result.OK), (-4, 3), (6, 3)])
def test_an_argument_beyond_its_bounds_does_not_reach_the_board(effort: int, result: int) -> None:
    taken: list[int] = []
    command = Command(Opcode.OPEN_LOOP, lambda _t_ns, value: taken.append(value), [(-3, 5)])
    assert command(0, effort.to_bytes(6, "little", signed=True)).result == result
    assert taken == ([effort] if result == Result.OK else [])


def test_parameters_keep_their_bounds() -> None:
    kept = [5]

    def write(value: int) -> None:
        kept[0] = value

    table = ParameterTable([Parameter(3, "x", -10, 10, lambda: kept[0], write)])
    assert table.get(3) == (Result.OK, 3, 5)
    assert table.set(3, 10) == (Result.OK, 3, 10)
    assert table.set(3, 11) == (Result.OUT_OF_RANGE, 3, 10)
    assert table.get(4).result == table.set(4, 0).result == Result.OUT_OF_RANGE
    assert kept == [10]


def test_a_parameter_is_refused_with_its_number_and_the_value_in_force() -> None:
    class Owner:
        gain = 7

    owner = Owner()
    rows = [kept(9, "gain", (-2, 8), owner, "gain"), Parameter(3, "x", 0, 0, lambda: 0, lambda _: None)]
    table = ParameterTable(rows)
    assert [row.number for row in table.rows()] == [3, 9]
    assert table.rows()[1] is rows[0]
    assert table.get(9) == (Result.OK, 9, 7)
    for value, answered in ((-2, -2), (8, 8), (-3, 8), (9, 8)):
        result = Result.OK if value == answered else Result.OUT_OF_RANGE
        assert table.set(9, value) == (result, 9, answered)
    assert owner.gain == 8
    assert table.get(4) == (Result.OUT_OF_RANGE, 4, 0)
    assert table.set(4, 17) == (Result.OUT_OF_RANGE, 4, 17)
    assert ParameterTable().rows() == ()


def test_a_handler_gets_the_time_and_the_six_bytes_behind_the_opcode() -> None:
    seen: list[tuple[int, bytes]] = []

    def noting(t_ns: int, arguments: bytes) -> Answer:
        seen.append((t_ns, arguments))
        return OK

    assert answer(DEVICE, {0x10: noting}, 77, bytes([DEVICE, 0x10, 1, 2, 3, 4, 5, 6])) == (0x10, OK)
    assert seen == [(77, bytes([1, 2, 3, 4, 5, 6]))]
    assert answer(DEVICE, {}, 0, bytes([DEVICE, 0x10]))[0] == 0x10


def test_a_method_may_answer_for_itself() -> None:
    refused = Answer(Result.NOT_ALLOWED)
    table = commands({Opcode.STOP: lambda _t_ns, *_: refused, Opcode.POWER: lambda _t_ns, *_: None})
    assert [table[opcode](0, bytes(6)) for opcode in (Opcode.STOP, Opcode.POWER)] == [refused, OK]
    assert Answer(Result.OK) == (Result.OK, 0, 0)
