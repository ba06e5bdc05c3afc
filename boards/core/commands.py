"""Commands and parameters: opcode to handler, exactly one reply for each, and what a change sets off."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from mypy_extensions import mypyc_attr

from bus.protocol import FRAME_BYTES, Opcode, Result, layout_of


class Answer(NamedTuple):
    """Result, the parameter it is about (0: none) and a value (i32): what goes into the REPLY frame."""

    result: Result
    parameter: int = 0
    value: int = 0


OK = Answer(Result.OK)
OUT_OF_RANGE = Answer(Result.OUT_OF_RANGE)
NOT_ALLOWED = Answer(Result.NOT_ALLOWED)


Handler = Callable[[int, bytes], Answer]
"""(t_ns, the six bytes after device type and opcode) -> reply."""


def answer(device_type: int, table: Mapping[int, Handler], t_ns: int, data: bytes) -> tuple[int, Answer]:
    """Check and run one command; returns its opcode (0: the frame is too short to have one) and the reply."""
    opcode = data[1] if len(data) > 1 else 0
    if len(data) != FRAME_BYTES:
        return opcode, Answer(Result.WRONG_LENGTH)
    if data[0] != device_type:
        return opcode, Answer(Result.WRONG_DEVICE_TYPE)
    handler = table.get(opcode)
    if handler is None:
        return opcode, Answer(Result.UNKNOWN_OPCODE)
    return opcode, handler(t_ns, data[2:])


class Command:
    """Takes the arguments of one opcode apart as the protocol lays them out, then calls `method` with the
    time and them. It returns an Answer, or None for OK.

    bounds: (low, high) of each argument, beyond which the answer is "out of range"; none: the method looks.
    """

    def __init__(
        self, opcode: Opcode, method: Callable[..., Answer | None], bounds: Sequence[tuple[int, int]] = ()
    ) -> None:
        self.opcode, self.method, self.bounds = opcode, method, bounds

    def __call__(self, t_ns: int, data: bytes) -> Answer:
        """Serve it; `data` is bytes 2..7."""
        values = layout_of(self.opcode)[0].unpack(data)
        for value, (low, high) in zip(values, self.bounds, strict=False):
            if not low <= value <= high:
                return OUT_OF_RANGE
        return self.method(t_ns, *values) or OK


def commands(methods: Mapping[Opcode, Callable[..., Answer | None]]) -> dict[int, Handler]:
    """A table of commands whose methods look at their arguments themselves."""
    return {opcode: Command(opcode, method) for opcode, method in methods.items()}


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row: number on the wire, name, bounds (inclusive, integers in the name's unit), accessors."""

    number: int
    name: str
    low: int
    high: int
    read: Callable[[], int]
    write: Callable[[int], None]


def kept(number: int, name: str, bounds: tuple[int, int], owner: object, attribute: str) -> Parameter:
    """A parameter whose value is an attribute of `owner`."""

    def write(value: int) -> None:
        setattr(owner, attribute, value)

    return Parameter(number, name, *bounds, lambda: int(getattr(owner, attribute)), write)


@mypyc_attr(allow_interpreted_subclasses=True)
class ParameterTable:
    """Answers GET_PARAMETER and SET_PARAMETER."""

    def __init__(self, rows: Iterable[Parameter] = ()) -> None:
        self._rows = {row.number: row for row in rows}

    def rows(self) -> tuple[Parameter, ...]:
        """All of them, by number."""
        return tuple(self._rows[number] for number in sorted(self._rows))

    def get(self, number: int) -> Answer:
        """The value, or out of range when there is no such parameter."""
        row = self._rows.get(number)
        return (
            OUT_OF_RANGE._replace(parameter=number) if row is None else Answer(Result.OK, number, row.read())
        )

    def set(self, number: int, value: int) -> Answer:
        """Change it if it exists and the value is inside its bounds; the reply has the value in force."""
        row = self._rows.get(number)
        if row is None:
            return Answer(Result.OUT_OF_RANGE, number, value)
        if not row.low <= value <= row.high:
            return Answer(Result.OUT_OF_RANGE, number, row.read())
        row.write(value)
        return Answer(Result.OK, number, row.read())
