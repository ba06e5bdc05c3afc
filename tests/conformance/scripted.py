"""A tester's bus whose boards are one function, on a clock that only waiting moves."""

from collections.abc import Callable, Iterable, Sequence
from heapq import heappop, heappush
from typing import Any

import can

from bus.conformance import Board, CheckResult, Settings, board_of
from bus.conformance.link import Link
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode, Result, pack_reply

Coming = Iterable[tuple[float, can.Message]]
"""Frames, and how many seconds after the tester's own each comes."""
Verdict = tuple[int, int, int]
"""Result, parameter and value of a REPLY."""

DISPLAY = board_of(Device.DISPLAY)
AXIS = board_of(Device.AXIS_RA)
FOCUS = board_of(Device.FOCUS)
GATEWAY = board_of(Device.GATEWAY)
OK, REFUSED, OUTSIDE = Result.OK, Result.NOT_ALLOWED, Result.OUT_OF_RANGE


def silence(_message: can.Message) -> Coming:
    """No board at all."""
    return ()


class ScriptedBus(can.BusABC):
    """answer: what comes of a frame that the tester sends."""

    def __init__(self, answer: Callable[[can.Message], Coming] = silence, now_s: float = 0.0) -> None:
        self.answer = answer
        self.now_s = now_s
        self.sent: list[can.Message] = []
        self.sent_s: list[float] = []
        self._coming: list[tuple[float, int, can.Message]] = []
        self._count = 0
        self._is_shutdown = True

    def hear(self, at_s: float, message: can.Message) -> None:
        """Let a frame come at this time."""
        self._count += 1
        message.timestamp = at_s
        heappush(self._coming, (at_s, self._count, message))

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self.sent.append(msg)
        self.sent_s.append(self.now_s)
        for after_s, message in self.answer(msg):
            self.hear(self.now_s + after_s, message)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        end_s = self.now_s + (timeout or 0.0)
        if self._coming and self._coming[0][0] <= end_s:
            at_s, _, message = heappop(self._coming)
            self.now_s = max(self.now_s, at_s)
            return message
        self.now_s = end_s
        return None

    def lines(self) -> list[str]:
        """All that was sent: identifier (x: extended, r: remote) and bytes."""
        return [line(message) for message in self.sent]


def line(message: can.Message) -> str:
    kind = ("x" if message.is_extended_id else "") + ("r" if message.is_remote_frame else "")
    data = f"dlc {message.dlc}" if message.is_remote_frame else bytes(message.data).hex(" ")
    return f"{message.arbitration_id:03x}{kind}: {data}"


def frame(identifier: int, data: bytes = b"", **kind: Any) -> can.Message:
    return can.Message(arbitration_id=identifier, data=data, is_extended_id=False, **kind)


def reply(device: int, opcode: int, result: int = OK, parameter: int = 0, value: int = 0) -> can.Message:
    return frame(REPLY_BASE + device, pack_reply(device, opcode, result, parameter, value))


def well(_data: bytes) -> Verdict:
    return OK, 0, 0


def deaf(_data: bytes) -> None:
    return None


def board(
    device: int, verdict: Callable[[bytes], Verdict | None] = well, after_s: float = 0.0, times: int = 1
) -> Callable[[can.Message], Coming]:
    """A board that judges its commands so, and answers so often; no verdict: it says nothing."""

    def answer(message: can.Message) -> Coming:
        meant = message.arbitration_id == COMMAND_BASE + device and not message.is_extended_id
        if not meant or message.is_remote_frame:
            return []
        data = bytes(message.data)
        found = verdict(data)
        opcode = data[1] if len(data) > 1 else 0
        return [] if found is None else [(after_s, reply(device, opcode, *found)) for _ in range(times)]

    return answer


class Store:
    """Verdicts of a board with parameters; others are taken. ranges: lowest and highest by number."""

    def __init__(self, ranges: dict[int, tuple[int, int]]) -> None:
        self.ranges = ranges
        self.values = {number: high for number, (_, high) in ranges.items()}

    def __call__(self, data: bytes) -> Verdict:
        number, value = data[2], int.from_bytes(data[3:7], "little", signed=True)
        if data[1] not in (Opcode.GET_PARAMETER, Opcode.SET_PARAMETER):
            return OK, 0, 0
        if number not in self.values:
            return OUTSIDE, number, 0
        low, high = self.ranges[number]
        if data[1] == Opcode.SET_PARAMETER:
            if not low <= value <= high:
                return OUTSIDE, number, self.values[number]
            self.values[number] = value
        return OK, number, self.values[number]


def link_on(bus: ScriptedBus, **settings: Any) -> Link:
    link = Link(bus, Settings(**settings))
    link.now = lambda: bus.now_s
    return link


def told(results: Iterable[CheckResult]) -> list[str]:
    """One line for each result."""
    return [f"{r.level} {r.check}: {r.subject}: {r.expected} | {r.observed}" for r in results]


def wrong(results: Iterable[CheckResult]) -> list[str]:
    return told(each for each in results if not each.passed)


def declared(name: str, devices: Sequence[Device]) -> Board:
    """The declared board of this name."""
    return board_of(next(each for each in devices if each.name == name))
