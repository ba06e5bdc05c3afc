"""Commands in quick succession and back to back: their pace, who is waited for, and what is lost."""

from collections.abc import Mapping, Sequence
from itertools import count

import can
import pytest

from bus.conformance.flood import _full, check_flood
from bus.protocol import Opcode
from tests.conformance.scripted import DISPLAY, OK, Coming, ScriptedBus, link_on, reply, told

PACE_S = 0.0005
EXPECTED = "64 answers, 0.5 ms apart or as they come"
PING = "0d1: 51 01 00 00 00 00 00 00"
STILL_THERE = "ok still there: DISPLAY, flooded: one reply: OK | OK"


Times = Sequence[float]
NO_OTHERS: Mapping[int, Times] = {}


class Busy:
    """Answers command k after each of `after_s[k]` seconds; others after `usual_s`."""

    def __init__(self, usual_s: Times, after_s: Mapping[int, Times] = NO_OTHERS) -> None:
        self.usual_s, self.after_s = usual_s, after_s
        self.numbers = count()
        self.health = 0

    def __call__(self, message: can.Message) -> Coming:
        assert (message.arbitration_id, bytes(message.data)) == (0x0D1, b"\x51\x01\0\0\0\0\0\0")
        for after_s in self.after_s.get(next(self.numbers), self.usual_s):
            yield after_s, reply(0x51, Opcode.PING, OK, 0, self.health)


def lost(*numbers: int) -> dict[int, Times]:
    return dict.fromkeys(numbers, ())


@pytest.mark.parametrize(
    ("usual_s", "after_s", "answers", "sent", "waits_s"),
    [
        ([0.0], {}, 64, 64, 0.75),
        ([0.0004], {}, 64, 64, 0.75),
        ([0.0], {63: [0.75]}, 64, 64, 0.75 + 1.0),
        ([0.0], {63: [1.25]}, 63, 64, 1.0),
        ([0.0], lost(9), 63, 64, 1.0),
        ([0.0], lost(9, 10), 62, 64, 1.0 + 0.75),
        ([0.0], lost(9, 20), 62, 64, 1.0 + 0.75),
        ([0.0], {5: [0.0, 0.0]}, 65, 64, 0.75),
        ([0.0], {63: [0.0, 0.75]}, 65, 64, 1.5),
        ([], {}, 0, 6, 3 * 1.0 + 0.75),
        ([], {0: [0.0]}, 1, 7, 3 * 1.0 + 0.75),
        ([0.0], lost(*range(60, 64)), 60, 64, 2 * 1.0 + 0.75),
    ],
)
def test_a_quick_succession_is_answered(
    usual_s: Times, after_s: Mapping[int, Times], answers: int, sent: int, waits_s: float
) -> None:
    bus = ScriptedBus(Busy(usual_s, after_s), now_s=8.0)
    result = next(check_flood(link_on(bus, reply_s=1.0, quiet_s=0.25), DISPLAY))
    level = "ok" if answers == 64 else "error"
    assert told([result]) == [f"{level} flooding: DISPLAY: {EXPECTED} | {answers}"]
    assert bus.lines() == [PING] * sent
    assert result.duration_s == pytest.approx(sent * PACE_S + waits_s, abs=2e-3)


def test_commands_come_at_their_pace() -> None:
    bus = ScriptedBus(Busy([0.0]))
    next(check_flood(link_on(bus), DISPLAY))
    assert bus.sent_s == pytest.approx([PACE_S * k for k in range(64)])


def test_two_commands_are_on_their_way_at_a_time_to_a_board_that_is_slow() -> None:
    bus = ScriptedBus(Busy([0.1]))
    assert next(check_flood(link_on(bus), DISPLAY)).observed == "64"
    assert bus.sent_s[:5] == pytest.approx([0.0, PACE_S, 0.1, 0.1 + PACE_S, 0.2])
    assert len(bus.sent) == 64


def test_only_a_full_bus_is_asked_for() -> None:
    calm = [f"ok flooding: DISPLAY: {EXPECTED} | 64"]
    full = [
        "ok full bus: DISPLAY: at most 64 answers | 64",
        "info full bus: DISPLAY:  | nothing was lost",
    ]
    for flood, count_sent, lines in ((False, 65, calm), (True, 129, calm + full)):
        bus = ScriptedBus(Busy([0.0]))
        assert told(check_flood(link_on(bus, flood=flood), DISPLAY)) == [*lines, STILL_THERE]
        assert bus.lines() == [PING] * count_sent


@pytest.mark.parametrize(("health", "level"), [(0x10, "ok"), (0x31, "ok"), (0x00, "issue"), (0x2F, "issue")])
def test_a_board_owns_up_to_what_a_full_bus_has_lost(health: int, level: str) -> None:
    board = Busy([0.25], lost(*range(40, 64)))
    board.health = health
    bus = ScriptedBus(board, now_s=8.0)
    results = list(_full(link_on(bus, quiet_s=0.25), DISPLAY))
    assert told(results) == [
        "ok full bus: DISPLAY: at most 64 answers | 40",
        f"{level} full bus: DISPLAY, loss owned up to: health bit 0x10, as 24 answers were lost "
        f"| health {health:#x}",
    ]
    assert bus.sent_s == [8.0] * 64 + [9.0]
    assert [each.duration_s for each in results] == [1.0, 1.0]


def test_a_board_that_a_full_bus_has_silenced() -> None:
    bus = ScriptedBus(Busy([]))
    assert told(_full(link_on(bus), DISPLAY)) == [
        "ok full bus: DISPLAY: at most 64 answers | 0",
        "issue full bus: DISPLAY, loss owned up to: health bit 0x10, as 64 answers were lost | no reply",
    ]


def test_an_answer_too_many_is_no_loss() -> None:
    bus = ScriptedBus(Busy([0.0], {7: [0.0, 0.0]}))
    assert told(_full(link_on(bus), DISPLAY)) == [
        "error full bus: DISPLAY: at most 64 answers | 65",
        "info full bus: DISPLAY:  | nothing was lost",
    ]
    assert bus.lines() == [PING] * 64
