"""Command dispatch: opcode to handler, and exactly one reply for each command, whatever is wrong with it."""

from collections.abc import Callable, Mapping, Sequence

from boards.core.results import OK, OUT_OF_RANGE, Answer
from bus.protocol import FRAME_BYTES, Opcode, Result, layout_of

Handler = Callable[[int, bytes], Answer]
"""(t_ns, the six bytes after device type and opcode) -> reply."""


def answer(device_type: int, table: Mapping[int, Handler], t_ns: int, data: bytes) -> tuple[int, Answer]:
    """Check and run one command; returns its opcode (0 when the frame is too short to have one) and the
    reply."""
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
