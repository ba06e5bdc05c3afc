"""The answer to every command: exactly one, from the right board, with its opcode and a result that fits."""

from collections.abc import Iterator, Sequence

from bus.conformance.boards import Board
from bus.conformance.families import FAMILIES, NOTHING, Case
from bus.conformance.link import Answers, Link
from bus.conformance.result import CheckResult, doubted, judged, told
from bus.protocol import Device, Health, Opcode, Reply, Result, pack_command
from bus.protocol.nodes import arguments_of, kind_of

_OK = (Result.OK,)
_REFUSED_TOO = (Result.OK, Result.NOT_ALLOWED)
_EXISTS_OR_NOT = (Result.OK, Result.OUT_OF_RANGE)
_PARAMETER = 1
"""Axis boards have it; a board without parameters says out of range."""


def declared_cases(device: Device) -> tuple[Case, ...]:
    """Opcodes of a declared board's own, every argument at its upper limit."""
    kind = kind_of(device)
    return tuple(
        Case(opcode, tuple(each.high for each in arguments), _REFUSED_TOO, True)
        for opcode, arguments in (arguments_of(kind) if kind is not None else {}).items()
    )


def judge(
    check: str, subject: str, replies: Answers, device: int, results: Sequence[int], duration_s: float
) -> CheckResult:
    """One answer, from `device`, with one of `results`, about the parameter that was named."""
    about = "" if replies.parameter is None else f" of parameter {replies.parameter}"
    expected = "one reply: " + " or ".join(Result(result).name for result in results) + about
    none = f"no reply; {replies.instead}" if replies.instead else "no reply"
    observed = ", ".join(_text(reply, device, replies.parameter) for reply in replies) or none
    passed = len(replies) == 1 and replies[0].device == device and replies[0].result in results
    passed = passed and replies.parameter in (None, replies[0].parameter)
    return judged(check, subject, passed, expected, observed, duration_s)


def asked(
    link: Link, board: Board, check: str, subject: str, data: bytes, results: Sequence[int]
) -> CheckResult:
    """Send any bytes as a command and judge the answer."""
    start = link.now()
    replies = link.ask_raw(board.device, data)
    return judge(check, subject, replies, board.device, results, link.now() - start)


def _text(reply: Reply, device: int, parameter: int | None) -> str:
    name = Result(reply.result).name if reply.result in set(Result) else f"result {reply.result}"
    value = f" value {reply.value}" if reply.value else ""
    if parameter not in (None, reply.parameter):
        value += f" of parameter {reply.parameter}"
    return name + value + ("" if reply.device == device else f" from device type {reply.device:#04x}")


def check_commands(link: Link, board: Board) -> Iterator[CheckResult]:
    """Every command `board` knows; those that move something only when the settings allow it."""
    name, device = board.name, board.device
    start = link.now()
    replies = link.ask(device, Opcode.PING)
    yield judge("command", f"{name} PING", replies, device, _OK, link.now() - start)
    health = replies[0].value if replies else None
    # foreign frames are this program's own: its checks of other boards have sent some
    well = health is not None and health & ~Health.FOREIGN == 0
    observed = "no reply" if health is None else f"{health:#x}"
    yield doubted("health", name, well, "0", observed)
    yield from _parameters(link, board)
    cases = FAMILIES.get(board.family, NOTHING).commands or declared_cases(board.model)
    for case in cases:
        if case.moves and not link.settings.motion:
            continue
        arguments = "".join(f" {argument}" for argument in case.arguments)
        data = pack_command(device, case.opcode, *case.arguments)
        yield asked(link, board, "command", f"{name} {case.opcode.name}{arguments}", data, case.results)
    left = 0 if link.settings.motion else sum(case.moves for case in cases)
    if left:
        yield told("motion", name, f"{left} commands that may move something not sent; --motion sends them")


def check_answers(link: Link, board: Board) -> Iterator[CheckResult]:
    """How long the answers to all commands so far took."""
    took = link.took_s.get(board.device)
    if not took:
        return
    allowed = link.settings.answer_s + link.settings.stamps_s * link.settings.speed
    quickest, (slowest, opcode) = min(took)[0] * link.settings.speed, max(took)
    slowest *= link.settings.speed
    named = Opcode(opcode).name if opcode in set(Opcode) else f"opcode {opcode:#04x}"
    observed = f"{quickest * 1e3:.3f}..{slowest * 1e3:.3f} ms, {len(took)} answers, the slowest to {named}"
    expected = f"within {allowed * 1e3:.3f} ms"
    yield judged("response time", board.name, slowest <= allowed, expected, observed)


def _parameters(link: Link, board: Board) -> Iterator[CheckResult]:
    """Read a parameter and write the same value back; one that was not read is left alone."""
    name, device = board.name, board.device
    kind = kind_of(board.model)
    has_parameters = board.family == "AXIS" or (kind is not None and bool(kind.parameters))
    results = _OK if has_parameters else _EXISTS_OR_NOT
    start = link.now()
    replies = link.ask(device, Opcode.GET_PARAMETER, _PARAMETER)
    subject = f"{name} GET_PARAMETER {_PARAMETER}"
    yield judge("command", subject, replies, device, results, link.now() - start)
    if not replies:
        return
    data = pack_command(device, Opcode.SET_PARAMETER, _PARAMETER, replies[0].value)
    yield asked(link, board, "command", f"{name} SET_PARAMETER {_PARAMETER}", data, results)
