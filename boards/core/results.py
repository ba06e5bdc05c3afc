"""What a command handler answers."""

from typing import NamedTuple

from bus.protocol import Result


class Answer(NamedTuple):
    """Result, the parameter it is about (0: none) and a value (i32): what goes into the REPLY frame."""

    result: Result
    parameter: int = 0
    value: int = 0


OK = Answer(Result.OK)
OUT_OF_RANGE = Answer(Result.OUT_OF_RANGE)
NOT_ALLOWED = Answer(Result.NOT_ALLOWED)
