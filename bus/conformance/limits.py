"""Values at and beyond every limit: parameters, which are put back, and arguments of commands."""

from collections.abc import Iterator
from typing import Final

from bus.conformance.boards import Board
from bus.conformance.commands import asked
from bus.conformance.families import FAMILIES, NOTHING, Command
from bus.conformance.link import Link
from bus.conformance.result import CheckResult, judged
from bus.protocol import HARMONICS, OBSERVER_CELLS, AxisParameter, Opcode, Reply, Result, pack_command
from bus.protocol.nodes import kind_of
from bus.protocol.scales import COUNTS_PER_TURN, STEPS_PER_TURN, rate_q16

_LAST_STEP: Final = STEPS_PER_TURN - 1
_FASTEST: Final = rate_q16(3.1 * 3600)
"""The paper reports up to 3 deg/s (Fig. 12)."""
_ACCELERATION: Final = rate_q16(7200.0) // 20
"""Q16 counts per 5 ms, per 5 ms: slew speed within 100 ms."""
_SUPPLY_Q8: Final = 3000 << 8
"""All of the supply, PWM steps in Q8 (paper, section 3.3)."""
_I32: Final = 1 << 31

_CELLS = ((0, _I32 - 1), (-_SUPPLY_Q8, _SUPPLY_Q8), (-_SUPPLY_Q8, _SUPPLY_Q8))
_SOFT_LIMITS = {4: (0, _LAST_STEP), 5: (0, _LAST_STEP)}
PARAMETERS: dict[str, dict[int, tuple[int, int]]] = {
    "AXIS": {
        AxisParameter.COUNTER_SPLIT_PERCENT: (10, 25),
        AxisParameter.KP_Q12: (0, 1 << 20),
        AxisParameter.KI_Q12: (0, 1 << 20),
        **_SOFT_LIMITS,
        AxisParameter.ACCELERATION: (1, _ACCELERATION),
        **dict.fromkeys(range(AxisParameter.RATE_SLEW_Q16, AxisParameter.DUTY_FRACTION), (1, _FASTEST)),
        AxisParameter.DUTY_FRACTION: (0, 1),
        AxisParameter.COMPENSATION: (0, 1),
        AxisParameter.FRICTION_LEVEL_Q8: (0, _SUPPLY_Q8),
        AxisParameter.FRICTION_TRAVEL_COUNTS: (1, COUNTS_PER_TURN),
        **{AxisParameter.HARMONIC_FIRST + at: _CELLS[at % 3] for at in range(3 * HARMONICS)},
        AxisParameter.COUNTER_BIAS_Q8: (0, 300 << 8),
        AxisParameter.RATE_LOCK: (0, 1),
        AxisParameter.POSITION_BLEND: (0, 15),
        **{AxisParameter.OBSERVER_FIRST + at: (1 - _I32, _I32 - 1) for at in range(OBSERVER_CELLS)},
    },
    "POSITION": _SOFT_LIMITS,
}
"""Type of board -> parameter -> lowest and highest value, in the parameter's own unit. A test compares them
with the firmware's. Whether 1 is taken as OBSERVER hangs on its coefficients, so it is not here."""

_RIGHT = {"AXIS": Result.NOT_ALLOWED, "DISPLAY": Result.OK}


def check_limits(link: Link, board: Board) -> Iterator[CheckResult]:
    """Parameters and arguments; nothing is left changed."""
    for number, (low, high) in parameters_of(board).items():
        yield from _parameter(link, board, number, low, high)
    family = FAMILIES.get(board.family, NOTHING)
    wanted = [(each, Result.OUT_OF_RANGE) for each in (*family.beyond, *_around(link, board))]
    if link.settings.motion or board.family != "AXIS":
        wanted += [(each, _RIGHT[board.family]) for each in family.at]
    for (opcode, arguments), result in wanted:
        subject = f"{board.name} {opcode.name} {' '.join(map(str, arguments))}"
        data = pack_command(board.device, opcode, *arguments)
        yield asked(link, board, "limits", subject, data, (result,))


def parameters_of(board: Board) -> dict[int, tuple[int, int]]:
    """Parameter to lowest and highest value: of the table above, or of the board's declaration."""
    kind = kind_of(board.model)
    if kind is None:
        return PARAMETERS.get(board.family, {})
    return {row.number: (row.low, row.high) for row in kind.parameters}


def _around(link: Link, board: Board) -> list[Command]:
    """Targets one step outside the soft limits that are in force."""
    if board.family != "AXIS":
        return []
    found: list[Command] = []
    for number, outwards in ((AxisParameter.LIMIT_LOW_STEPS, -1), (AxisParameter.LIMIT_HIGH_STEPS, 1)):
        reply = link.first(board.device, Opcode.GET_PARAMETER, number)
        if reply is not None and reply.result == Result.OK and reply.value + outwards >= 0:
            found.append((Opcode.MOVE_TO, (reply.value + outwards, 1)))
    return found


def _parameter(link: Link, board: Board, number: int, low: int, high: int) -> Iterator[CheckResult]:
    """Both limits are taken, one beyond either is refused and changes nothing; then what was is again."""
    start = link.now()
    before = link.first(board.device, Opcode.GET_PARAMETER, number)
    subject = f"{board.name} parameter {number}"
    if before is None or before.result != Result.OK:
        yield judged("limits", subject, False, "a value", _said(before), link.now() - start)
        return
    wrong: list[str] = []
    try:
        for value, right in ((low, True), (high, True), (low - 1, False), (high + 1, False)):
            if -_I32 <= value < _I32:
                wrong += _set(link, board, number, value, right)
    finally:
        after = link.first(board.device, Opcode.SET_PARAMETER, number, before.value)
    if after is None or after.result != Result.OK or after.value != before.value:
        wrong.append(f"{before.value} put back: {_said(after)}")
    expected = f"{low}..{high} taken, beyond refused, {before.value} put back"
    yield judged("limits", subject, not wrong, expected, "; ".join(wrong) or "so", link.now() - start)


def _set(link: Link, board: Board, number: int, value: int, right: bool) -> list[str]:
    """What is wrong with the answer to setting a parameter, or with its value afterwards."""
    reply = link.first(board.device, Opcode.SET_PARAMETER, number, value)
    result = Result.OK if right else Result.OUT_OF_RANGE
    if reply is None or (reply.result, reply.parameter) != (result, number):
        return [f"{value}: {_said(reply)}"]
    there = link.first(board.device, Opcode.GET_PARAMETER, number)
    if there is None or there.parameter != number or (there.value == value) != right:
        return [f"{value}: then {_said(there)}"]
    return []


def _said(reply: Reply | None) -> str:
    if reply is None:
        return "no reply"
    name = Result(reply.result).name if reply.result in set(Result) else f"result {reply.result}"
    return f"{name} parameter {reply.parameter} value {reply.value}"
