"""The control plane line by line, over clients and a network that only write down."""

import json
from types import SimpleNamespace

import pytest

from scenarios.doors.control import STEPPING
from tests.scenarios.doors.controldesk import Desk
from tests.scenarios.doors.served import StubClient


@pytest.fixture
def desk() -> Desk:
    return Desk()


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("speed 2.50", "ok speed 2.5"),
        ("speed fast", "error: speed X, a number, for example speed 2"),
        ("speed", "error: speed X, a number, for example speed 2"),
        ("pause", "ok paused"),
        ("resume", "ok running"),
        ("power FOCUS off", "ok power FOCUS off"),
        ("fault start hang node=FOCUS", "ok fault start hang node=FOCUS"),
        ("fault list", 'ok [{"number": 3, "name": "hang"}]'),
        ("fault kinds", "ok hang, reset"),
        ("late", "ok [[5.0, 2.0]]"),
        ("snapshot", "error: this session takes no snapshots: schmidt serve --snapshots DIR does"),
        ("snapshot a b", "error: snapshot [NAME]"),
        ("status now", "error: status"),
        ("stop", "ok ending"),
        ("", "error: nothing said; try help"),
        ("join 2", "error: join: time is paced here (schmidt serve --clock)"),
        ("dance", "error: no command 'dance'; use one of status, speed, pause, resume, power, fault, late, "
                  "snapshot, stop, help"),
    ],
)  # fmt: skip
def test_a_line_has_one_answer(desk: Desk, line: str, answer: str) -> None:
    assert desk(line) == answer + "\n"


def test_speed_pause_and_stop_are_the_network_s(desk: Desk) -> None:
    desk("speed 3")
    desk("pause")
    assert (desk.served.pacer.speed, desk.served.pacer.paused) == (3.0, True)
    desk("resume")
    assert not desk.served.pacer.paused and not desk.served.ending
    desk("stop")
    assert desk.served.ending


def test_a_long_unknown_word_is_cut(desk: Desk) -> None:
    assert desk("x" * 41).startswith("error: no command '" + "x" * 40 + "'; use")


def test_help_names_every_command_and_how_time_is_stepped(desk: Desk) -> None:
    answer = desk("help")
    for word in (
        "status",
        "speed X",
        "pause",
        "resume",
        "power BOARD on|off",
        "fault list",
        "snapshot [NAME]",
    ):
        assert word in answer
    assert answer.endswith("; with --clock steps: join N [NAME] | listen | send ID#DATA | step 5ms\n")
    assert answer.startswith("ok status | speed X")


def test_a_snapshot_goes_by_its_name_or_none(desk: Desk) -> None:
    desk.served.snapshot = lambda name: f"taken {name!r}"
    assert desk("snapshot") == "ok taken ''\n" and desk("snapshot one") == "ok taken 'one'\n"


def test_status_is_in_seconds_and_ms(desk: Desk) -> None:
    desk.served.now_ns = 2_500_000_000
    found = json.loads(desk("status").removeprefix("ok "))
    known: dict[str, object] = {
        "simulated_s": 2.5,
        "speed": 1.0,
        "paused": False,
        "late_ms": 4.0,
        "slips": 2,
        "bus_load": 0.25,
    }
    known |= {"frames": 7, "boards": {"FOCUS": True, "DISPLAY": False}}
    assert found == known | {"ticks": 0, "on_time": None, "late_999_ms": None, "worst_ms": None}
    desk.served.punctual.ticks = 1
    found = json.loads(desk("status").removeprefix("ok "))
    ticks = {"ticks": 1, "on_time": 0.75, "late_999_ms": pytest.approx(0.999), "worst_ms": pytest.approx(9.0)}
    assert found == known | ticks


def test_an_error_is_one_line(desk: Desk) -> None:
    def refuse(words: list[str]) -> str:
        raise ValueError("no\n  board")

    desk.served.command = refuse
    assert desk("power X on") == "error: no board\n"


@pytest.mark.parametrize(("size", "good"), [(1000, True), (1001, False)])
@pytest.mark.parametrize("end", [b"\n", b""])
def test_a_line_has_a_thousand_bytes_at_most(desk: Desk, size: int, good: bool, end: bytes) -> None:
    desk.client.says.append(b"x" * size + end)
    desk.door.poll(0)
    assert desk.client.gone is not good
    if not good:
        assert desk.client.heard == [b"error: a command is one short line\n"] and not desk.clients.all


def test_eight_lines_are_answered_in_a_poll_and_a_piece_waits_for_its_end(desk: Desk) -> None:
    desk.client.says.append(b"pause\n" * 9 + b"res")
    desk.door.poll(0)
    assert desk.client.heard == [b"ok paused\n"] * 8
    desk.door.wait(0.5)
    assert desk.clients.waited == []  # there is a line left
    desk.client.says.append(b"ume\n")
    desk.door.poll(0)
    assert desk.client.heard[8:] == [b"ok paused\n", b"ok running\n"]
    desk.door.wait(0.5)
    assert desk.clients.waited == [0.5]


def test_where_clients_step_time_pacing_is_refused_and_lines_wait() -> None:
    desk = Desk()
    taken: list[list[str]] = []
    left: list[StubClient] = []
    waits = {"now": False}

    def take(client: StubClient, words: list[str]) -> str | None:
        taken.append(words)
        waits["now"] = words[0] == "step"
        return None if waits["now"] else "ok"

    desk.served.steps = SimpleNamespace(take=take, waits=lambda client: waits["now"], leave=left.append)
    for word in ("speed", "pause", "resume"):
        assert desk(f"{word} 1") == f"error: {word}: time is stepped here (schmidt serve --clock)\n"
    for word in STEPPING[:3]:
        assert desk(f"{word} 1") == "ok\n"
    assert desk("step 5ms\nstatus") == ""
    desk.door.wait(0.25)
    assert desk.clients.waited == [0.25]
    waits["now"] = False
    desk.door.poll(0)
    assert desk.client.heard[0].startswith(b"ok {")
    desk.client.gone = True
    desk.door.poll(0)
    assert left == [desk.client] and taken[-1] == ["step", "5ms"]


def test_closed_it_knows_nobody(desk: Desk) -> None:
    desk.door.close()
    assert not desk.door._rest and not desk.door._trusted and not desk.clients.all
