from hypothesis import given
from hypothesis import strategies as st

from boards.core import Answer, Parameter, ParameterTable, answer
from boards.core.commands import i8, i16, i32, u8, u32
from bus.protocol import Result

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


@given(st.integers(-(2**31), 2**31 - 1))
def test_arguments_are_little_endian(value: int) -> None:
    data = value.to_bytes(4, "little", signed=True) + b"\xff\x80"
    assert i32(data) == value
    assert u32(data) == value % 2**32
    assert (i8(data, 4), u8(data, 4), i16(data, 4)) == (-1, 255, -32513)


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
