"""The CANopen part on a scripted node: what is sent, in which order, and every result word by word."""

from collections.abc import Callable

import can
import pytest

from bus.conformance.canopen import _heartbeat, _objects, check_canopen
from bus.conformance.link import Link
from tests.conformance.canopen_node import ABORTS, RESET, START, STOP, Node
from tests.conformance.scripted import DISPLAY, ScriptedBus, frame, link_on, told, wrong

THERE = (
    "1000:0", "1001:0", "1003:0", "1005:0", "1008:0", "1010:1", "1011:1", "1014:0", "1016:1", "1017:0",
    "1018:1", "1018:2", "1018:3", "1018:4", "1200:1", "1400:1", "1600:1", "1800:1", "1a00:1",
)  # fmt: skip
"""Objects of docs/reference/canopen.md that every node has."""
REFUSED = (
    "no such object", "no such sub-index", "read only", "another length", "no such specifier",
    "a segment of nothing", "a value that is none", "mapped while it is valid", "not saved by another word",
)  # fmt: skip


def upload(name: str) -> str:
    return f"40 {name[2:4]} {name[:2]} 0{name[5]} 00 00 00 00"


REQUESTS = [upload("1017:0"), *map(upload, THERE), *ABORTS, "40 00 10"]


def found(node: Node, **settings: float) -> tuple[ScriptedBus, list[str]]:
    bus = ScriptedBus(node)
    link = link_on(bus, stamps_s=0.0, **settings)
    return bus, told(check_canopen(link, [DISPLAY]))


def test_a_sound_node_word_by_word() -> None:
    _, lines = found(Node(0x51))
    objects = []
    for each in THERE:
        value = "4b 17 10 00 e8 03 05 07" if each == "1017:0" else f"43 {upload(each)[3:11]} 11 22 33 44"
        objects.append(f"ok object: DISPLAY 0x{each}: a value of {upload(each)[3:11]} | {value}")
    assert lines == [
        "ok boot-up: DISPLAY: 00 after NMT 82 | 00 7f 7f 7f",
        "ok state: DISPLAY: 7f from then on | 00 7f 7f 7f",
        "ok heartbeat: DISPLAY: every 1.000 s, by 0x1017 | 1.000, 1.000",
        "ok pre-operational: DISPLAY: no PDO | none",
        *objects,
        *(f"ok abort: DISPLAY, {what}: {code:#010x} | {code:#010x}"
          for what, code in zip(REFUSED, ABORTS.values(), strict=True)),
        "ok short request: DISPLAY: no answer | none",
        "ok state: DISPLAY, NMT 02: 04 | 04",
        "ok stopped: DISPLAY: no PDO | none",
        "ok state: DISPLAY, NMT 01: 05 | 05",
        "ok server: DISPLAY: 43 ... | 43 00 10 00 11 22 33 44",
        "ok operational: DISPLAY: REPLY to PING | 51 01 00 00 00 00 00 00",
        "ok SYNC: DISPLAY: 4 frames of TPDO4 | 4",
        "ok event again: DISPLAY: 60 ... | 60 03 18 02 00 00 00 00",
    ]  # fmt: skip


def test_what_is_sent_in_its_order_and_when() -> None:
    bus, _ = found(Node(0x51), quiet_s=0.25, speed=2.0)
    assert bus.lines() == [
        f"000: {RESET}", *(f"651: {each}" for each in REQUESTS), f"000: {STOP}", f"000: {START}",
        "651: 40 00 10 00 00 00 00 00", "0d1: 51 01 00 00 00 00 00 00", "651: 2f 03 18 02 01 00 00 00",
        *4 * ["080: "], "651: 2f 03 18 02 ff 00 00 00",
    ]  # fmt: skip
    times = [at_s for message, at_s in zip(bus.sent, bus.sent_s, strict=True) if message.arbitration_id < 99]
    # 0.1 s; then, at double speed, half of 3.2 s and 3 x 0.25 s without an answer; half of 1.6 s
    assert times == pytest.approx([0.1, 2.45, 3.25])
    syncs = [at_s for line, at_s in zip(bus.lines(), bus.sent_s, strict=True) if line == "080: "]
    assert syncs == pytest.approx([4.65, 4.7, 4.75, 4.8])


def frames(node: Node, command: str, *bases: int) -> None:
    node.beats[command] = [*node.beats[command], *((0.25, base, "51") for base in bases)]


def spoiled(request: str, said: str | None) -> Callable[[Node], None]:
    return lambda node: node.spoil.update({request: lambda _: said})


OTHER = "43 00 10 00 00 00 00 00"
NONE = "nothing"
PDO = "error {}: DISPLAY: no PDO | frames"
WRONG: list[tuple[Callable[[Node], None], list[str]]] = [
    *((lambda n, base=base: frames(n, RESET, base), [PDO.format("pre-operational")])
      for base in (0x100, 0x200, 0x300, 0x380)),
    *((lambda n, base=base: frames(n, STOP, base), [PDO.format("stopped")])
      for base in (0x100, 0x200, 0x300, 0x380)),
    (lambda n: frames(n, RESET, 0x400, 0x180), []),
    (lambda n: n.beats.update({STOP: [(0.5, 0x700, "05"), (0.75, 0x700, "04")]}),
     ["error state: DISPLAY, NMT 02: 04 | 04 05"]),
    (lambda n: n.beats.update({START: []}), ["error state: DISPLAY, NMT 01: 05 | nothing"]),
    (lambda n: setattr(n, "ping", lambda _: ()), ["error operational: DISPLAY: REPLY to PING | none"]),
    (lambda n: setattr(n, "short", True), ["error short request: DISPLAY: no answer | one"]),
    (lambda n: setattr(n, "per_sync", 2), ["error SYNC: DISPLAY: 4 frames of TPDO4 | 8"]),
    (lambda n: setattr(n, "per_sync", 0), ["error SYNC: DISPLAY: 4 frames of TPDO4 | 0"]),
    (spoiled(upload("1001:0"), "80 01 10 00 00 00 00 08"),
     ["error object: DISPLAY 0x1001:0: a value of 01 10 00 | 80 01 10 00 00 00 00 08"]),
    (spoiled(upload("1001:0"), OTHER), [f"error object: DISPLAY 0x1001:0: a value of 01 10 00 | {OTHER}"]),
    (spoiled(upload("1018:4"), None), [f"error object: DISPLAY 0x1018:4: a value of 18 10 04 | {NONE}"]),
    (spoiled("40 00 50 00 00 00 00 00", None),
     [f"error abort: DISPLAY, no such object: 0x06020000 | {NONE}"]),
    (spoiled("40 00 50 00 00 00 00 00", "43 00 00 00 00 00 02 06"),
     ["error abort: DISPLAY, no such object: 0x06020000 | 43 00 00 00 00 00 02 06"]),
    (spoiled("40 00 50 00 00 00 00 00", "80 00 50 00 01 00 02 06"),
     ["error abort: DISPLAY, no such object: 0x06020000 | 0x06020001"]),
    (spoiled("2f 03 18 02 ff 00 00 00", None), [f"error event again: DISPLAY: 60 ... | {NONE}"]),
    (spoiled("2f 03 18 02 ff 00 00 00", "80"), ["error event again: DISPLAY: 60 ... | 80"]),
]  # fmt: skip


@pytest.mark.parametrize(("change", "lines"), WRONG)
def test_what_is_wrong_is_told_and_nothing_else(change: Callable[[Node], None], lines: list[str]) -> None:
    node = Node(0x51)
    change(node)
    assert [line for line in found(node)[1] if not line.startswith("ok")] == lines


def test_a_node_that_is_not_there() -> None:
    bus = ScriptedBus()
    lines = told(check_canopen(link_on(bus, reply_s=0.25), [DISPLAY]))
    assert [line for line in lines if line.startswith("ok")] == [
        "ok pre-operational: DISPLAY: no PDO | none", "ok short request: DISPLAY: no answer | none",
        "ok stopped: DISPLAY: no PDO | none",
    ]  # fmt: skip
    assert lines[:3] == [
        "error boot-up: DISPLAY: 00 after NMT 82 | nothing",
        "error state: DISPLAY: 7f from then on | nothing",
        "error heartbeat: DISPLAY: every 0.000 s, by 0x1017 | nothing",
    ]  # fmt: skip
    assert "error server: DISPLAY: 43 ... | nothing" in lines


def test_frames_that_are_no_pdos_of_its_are_none() -> None:
    bus = ScriptedBus(Node(0x51))
    bus.hear(1.0, can.Message(arbitration_id=0x3D1, is_extended_id=True))
    bus.hear(1.0, frame(0x3D1, is_remote_frame=True))
    bus.hear(1.0, frame(0x3D2))
    assert wrong(check_canopen(link_on(bus), [DISPLAY])) == []


def heard(*beats: tuple[float, str]) -> list[can.Message]:
    messages = [frame(0x751, bytes.fromhex(said)) for _, said in beats]
    for message, (at_s, _) in zip(messages, beats, strict=True):
        message.timestamp = at_s
    return messages


def beating(**settings: float) -> Link:
    return link_on(ScriptedBus(Node(0x51)), **settings)


@pytest.mark.parametrize(
    ("settings", "gap_s", "well"),
    [
        ({"period_tolerance": 0.25, "stamps_s": 0.0}, 1.25, True),
        ({"period_tolerance": 0.25, "stamps_s": 0.0}, 0.75, True),
        ({"period_tolerance": 0.25, "stamps_s": 0.0}, 1.251, False),
        ({"period_tolerance": 0.25, "stamps_s": 0.0}, 0.749, False),
        ({"period_tolerance": 0.0, "stamps_s": 0.125}, 1.125, True),
        ({"period_tolerance": 0.25, "stamps_s": 0.125}, 1.376, False),
        ({"period_tolerance": 0.0, "stamps_s": 0.125, "speed": 2.0}, 0.625, True),
        ({"period_tolerance": 0.0, "stamps_s": 0.125, "speed": 2.0}, 0.626, False),
    ],
)
def test_a_heartbeat_is_as_even_as_the_tolerance_and_the_stamps(
    settings: dict[str, float], gap_s: float, well: bool
) -> None:
    beats = heard((0.5, "00"), (8.0, "7f"), (8.0 + gap_s, "7f"))
    result = list(_heartbeat(beating(**settings), DISPLAY, beats))[2]
    gap = f"{gap_s * settings.get('speed', 1.0):.3f}"
    assert (result.passed, result.observed) == (well, gap)
    assert result.expected == "every 1.000 s, by 0x1017"


def test_one_beat_or_another_state_is_not_enough() -> None:
    lines = told(_heartbeat(beating(), DISPLAY, heard((0.0, "7f"), (1.0, ""))))
    assert lines == [
        "error boot-up: DISPLAY: 00 after NMT 82 | 7f -", "error state: DISPLAY: 7f from then on | 7f -",
        "error heartbeat: DISPLAY: every 1.000 s, by 0x1017 | nothing",
    ]  # fmt: skip
    lines = told(_heartbeat(beating(), DISPLAY, heard((0.0, "00"), (1.0, "05"), (2.0, "7f"))))
    assert lines[1] == "error state: DISPLAY: 7f from then on | 00 05 7f"


@pytest.mark.parametrize(("after_s", "well"), [(0.75, False), (0.8, True)])
def test_a_short_request_is_waited_upon_three_times_the_quiet(after_s: float, well: bool) -> None:
    bus = ScriptedBus(lambda m: [(after_s, frame(0x5D1))] if len(m.data) == 3 else Node(0x51)(m))
    assert list(_objects(link_on(bus, quiet_s=0.25), DISPLAY))[-1].passed is well
