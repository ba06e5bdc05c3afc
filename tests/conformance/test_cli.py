"""`schmidt conformance`: what is run, printed and written, and how it ends."""

import json
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import can
import pytest

from bus.conformance import CheckResult, Level, Settings
from bus.conformance.cli import check, conformance_command
from bus.conformance.result import doubted, judged, summary, told
from bus.outside.external import SpecError
from bus.protocol import Device
from tests.conformance.scripted import AXIS, ScriptedBus

GOOD = judged("length", "DISPLAY", True, "8 bytes", "8 bytes")
INFO = told("motion", "DISPLAY", "not sent")
ISSUE = doubted("health", "DISPLAY", False, "0", "0x4", 0.5)
ERROR = judged("identifier", "AXIS_RA", False, "frames", "none")
Asked = list[tuple[Any, ...]]


@pytest.fixture
def finding(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Asked]:
    """Lets a run find these results, and tells what runs were asked for."""

    def found(*results: CheckResult) -> Asked:
        asked: Asked = []

        def run(*arguments: Any) -> list[CheckResult]:
            asked.append(arguments)
            return list(results)

        monkeypatch.setattr("bus.conformance.cli.run", run)
        return asked

    return found


@pytest.mark.parametrize(
    ("results", "code", "counts"),
    [
        ((), 0, "0 checks: 0 ok, 0 info, 0 issues, 0 errors"),
        ((GOOD, INFO, GOOD), 0, "3 checks: 2 ok, 1 info, 0 issues, 0 errors"),
        ((GOOD, ISSUE), 0, "2 checks: 1 ok, 0 info, 1 issues, 0 errors"),
        ((ERROR, ISSUE, ERROR), 1, "3 checks: 0 ok, 0 info, 1 issues, 2 errors"),
    ],
)
def test_what_is_wrong_is_shown_and_only_an_error_fails(
    results: tuple[CheckResult, ...], code: int, counts: str, finding: Callable[..., Asked],
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    finding(*results)
    assert check(ScriptedBus(), None, Settings()) == code
    *table, last = capsys.readouterr().out.splitlines()
    assert last == counts
    wrong = [each for each in results if each.level in (Level.ISSUE, Level.ERROR)]
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in table if line.startswith("│")]
    assert rows == [[str(r.level), r.check, r.subject, r.expected, r.observed] for r in wrong]
    heads = [line for line in table if line.startswith("┃")]
    assert len(heads) == bool(wrong)
    if wrong:
        assert table[0].strip() == "not as it should be"
        assert heads[0].split()[1::2] == ["level", "check", "subject", "expected", "observed"]


def test_a_run_gets_what_was_asked_for(finding: Callable[..., Asked]) -> None:
    asked = finding()
    bus, settings, dbc = ScriptedBus(), Settings(motion=True), object()
    check(bus, None, settings)
    check(bus, None, settings, [AXIS], dbc)  # type: ignore[arg-type]
    assert asked == [(bus, None, tuple(Device), settings), (bus, dbc, [AXIS], settings)]


def test_results_are_written_as_they_are_counted(finding: Callable[..., Asked], tmp_path: Path) -> None:
    finding(GOOD, ISSUE, ERROR)
    path = tmp_path / "found.json"
    assert check(ScriptedBus(), path, Settings()) == 1
    text = path.read_text(encoding="utf-8")
    assert json.loads(text) == summary([GOOD, ISSUE, ERROR])
    assert text.startswith('{\n  "format": "schmidt-conformance 2",\n') and text.endswith("\n}\n")


def test_a_file_that_cannot_be_written_is_one_line(finding: Callable[..., Asked], tmp_path: Path) -> None:
    finding(GOOD)
    path = tmp_path / "nowhere" / "found.json"
    with pytest.raises(SpecError) as error:
        check(ScriptedBus(), path, Settings())
    assert str(error.value) == f"{path}: cannot be written: No such file or directory"


def test_the_command_opens_the_bus_that_is_named(
    finding: Callable[..., Asked], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, bus = finding(ERROR), ScriptedBus()
    monkeypatch.setattr("bus.conformance.cli.open_bus", {"virtual:x": nullcontext(bus)}.get)
    settings, dbc = Settings(motion=True), object()
    assert conformance_command("virtual:x") == 1
    assert conformance_command("virtual:x", None, [AXIS], settings, dbc) == 1  # type: ignore[arg-type]
    assert asked == [(bus, None, tuple(Device), Settings()), (bus, dbc, [AXIS], settings)]


def test_a_bus_that_breaks_down_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> list[CheckResult]:
        raise can.CanOperationError("the cable is off")

    monkeypatch.setattr("bus.conformance.cli.run", broken)
    monkeypatch.setattr("bus.conformance.cli.open_bus", lambda _: nullcontext(ScriptedBus()))
    with pytest.raises(SpecError) as error:
        conformance_command("virtual:x")
    assert str(error.value) == '"virtual:x": the bus broke down: the cable is off'
