"""The kit's options, its items and how each of them ends."""

import warnings
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import pytest

import bus.kit as kit
from bus.conformance import Board, CheckResult, Settings
from bus.conformance.result import doubted, judged, told
from tests.conformance.scripted import AXIS, DISPLAY, ScriptedBus

GOOD = judged("length", "DISPLAY_HEARTBEAT", True, "8 bytes", "8 bytes")
INFO = told("length", "DISPLAY_HEARTBEAT", "as ever")
ISSUE = doubted("length", "A", False, "8 bytes", "7 bytes")
ERROR = judged("length", "B", False, "8 bytes", "6 bytes")
ELSEWHERE = judged("health", "DISPLAY", False, "0", "0x4")


def config(*words: str) -> Any:
    """A command line as pytest's own parser takes it."""
    parser = pytest.Parser(_ispytest=True)
    kit.pytest_addoption(parser)
    found = parser.parse(list(words))

    class Config:
        def getoption(self, name: str) -> Any:
            return getattr(found, name.removeprefix("--").replace("-", "_"))

    return Config()


def skipped(run: Callable[[], object]) -> str | None:
    """Why it is skipped, and not this test with it."""
    try:
        run()
    except pytest.skip.Exception as reason:
        return str(reason)
    return None


def test_by_default_no_bus_is_checked_and_nothing_moves() -> None:
    usual = config()
    names = ("--can", "--board", "--can-motion", "--can-canopen", "--can-stamps", "--can-speed")
    assert [usual.getoption(name) for name in names] == [None, [], False, False, 0.001, 1.0]
    words = (
        "--can a:b --board axis:1 --board axis:2 --can-motion --can-canopen --can-stamps 1e-2 --can-speed 2"
    )
    asked = config(*words.split())
    assert [asked.getoption(name) for name in names] == ["a:b", ["axis:1", "axis:2"], True, True, 0.01, 2.0]


@pytest.mark.parametrize(
    ("words", "collected"),
    [
        ("", 0),
        ("--can a:b", 0),
        ("--board display:0x51", 0),
        ("--can a:b --board display:0x51", 28),
        ("--can a:b --board display:0x51 --board axis:0x13", 56),
        ("--can a:b --board display:0x51 --can-canopen", 12),
    ],
)
def test_each_check_of_each_board_is_a_test(
    words: str, collected: int, request: pytest.FixtureRequest
) -> None:
    items: list[Any] = []
    kit.pytest_collection_modifyitems(request.session, config(*words.split()), items)
    assert len(items) == len({item.name for item in items}) == collected
    if items:
        first, last = ("pre-operational", "event again") if collected == 12 else ("answers", "still there")
        assert items[0].name == f"conformance[DISPLAY-{first}]"
        name = "AXIS:0x13" if collected == 56 else "DISPLAY"
        assert (items[-1].name, items[-1].board.name) == (f"conformance[{name}-{last}]", name)
        assert (items[-1].check, items[-1].found) == (last, items[0].found)
        assert items[0].reportinfo() == ("conformance", None, items[0].name)


def test_a_board_or_a_bus_that_cannot_be_is_a_usage_error(request: pytest.FixtureRequest) -> None:
    with pytest.raises(pytest.UsageError) as error:
        kit.pytest_collection_modifyitems(request.session, config("--board", "axis"), [])
    assert str(error.value) == '--board "axis": expected TYPE:ID, such as axis:0x11'
    with pytest.raises(pytest.UsageError) as error:
        kit._open(config("--can", "vcan0"))
    assert str(error.value) == '"vcan0": expected INTERFACE:CHANNEL, for example socketcan:vcan0'


def test_a_test_that_wants_a_board_runs_for_each() -> None:
    asked: list[Any] = []

    class Metafunc:
        fixturenames = ("tmp_path",)
        config = config("--board", "display:0x51", "--board", "axis:0x13")

        def parametrize(self, *arguments: Any, **more: Any) -> None:
            asked.append((*arguments, more))

    wanted: Any = Metafunc()
    kit.pytest_generate_tests(wanted)
    assert asked == []
    wanted.fixturenames = ("tmp_path", "board")
    kit.pytest_generate_tests(wanted)
    boards = [DISPLAY, Board("AXIS:0x13", "AXIS", 0x13, AXIS.model)]
    assert asked == [("board", boards, {"ids": ["DISPLAY", "AXIS:0x13"], "scope": "session"})]


def test_a_test_that_wants_a_bus_is_skipped_without_one(monkeypatch: pytest.MonkeyPatch) -> None:
    made = ScriptedBus()
    monkeypatch.setattr(kit, "_open", lambda _: nullcontext(made))
    fixture: Any = kit.conformance_bus
    request: Any = type("Request", (), {"config": config("--can", "a:b")})
    opened: list[object] = []
    assert skipped(lambda: opened.extend(fixture.__wrapped__(request))) is None
    assert opened == [made]
    request.config = config()
    assert skipped(lambda: next(fixture.__wrapped__(request))) == "no bus: --can INTERFACE:CHANNEL"


def test_a_board_is_checked_once_as_the_options_say(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    made = ScriptedBus()

    def run(bus: object, **more: Any) -> list[CheckResult]:
        asked.append((bus, more))
        return [GOOD]

    monkeypatch.setattr(kit, "_open", lambda _: nullcontext(made))
    monkeypatch.setattr("bus.conformance.run", run)
    words = "--can a:b --can-motion --can-canopen --can-stamps 0.5 --can-speed 2"
    found = kit._Found(config(*words.split()), [DISPLAY, AXIS])
    assert found.of(DISPLAY) == found.of(DISPLAY) == found.of(AXIS) == [GOOD]
    settings = Settings(motion=True, canopen=True, stamps_s=0.5, speed=2.0)
    assert asked == [(made, {"devices": [each], "settings": settings}) for each in (DISPLAY, AXIS)]


def item(request: pytest.FixtureRequest, *results: CheckResult) -> kit.ConformanceItem:
    """The check of lengths, of a board with these results."""
    found: Any = type("Found", (), {"of": lambda _, board: [*results] if board is DISPLAY else []})()
    made: kit.ConformanceItem = kit.ConformanceItem.from_parent(
        request.session, name="conformance[DISPLAY-length]", found=found, board=DISPLAY, check="length"
    )
    return made


def test_what_is_well_passes_and_what_does_not_apply_is_skipped(request: pytest.FixtureRequest) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert skipped(item(request, GOOD, INFO, ELSEWHERE).runtest) is None
    for results in ([], [ELSEWHERE]):
        assert skipped(item(request, *results).runtest) == "does not apply"


def test_an_issue_warns_and_an_error_fails(request: pytest.FixtureRequest) -> None:
    said = "issue: A: expected 8 bytes, observed 7 bytes", "error: B: expected 8 bytes, observed 6 bytes"
    with pytest.warns(pytest.PytestWarning) as told_of:
        item(request, GOOD, ISSUE, ISSUE).runtest()
    assert [str(each.message) for each in told_of] == [said[0]] * 2
    assert told_of[0].filename == kit.__file__
    with pytest.raises(pytest.fail.Exception) as error:
        item(request, ISSUE, GOOD, ERROR).runtest()
    assert str(error.value) == "\n".join(said)
    assert not error.value.pytrace
