"""Edges of what is left: the first rate, short totals, a terminal's bar, the tick of stages."""

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace

import pytest

from scenarios import progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: now[0]))
    return now


def test_a_rate_needs_one_percent_of_the_total_and_some_time() -> None:
    assert progress.left(1.0, 100.0, 0.0, 1.0) == pytest.approx(99.0)
    assert progress.left(50.5, 100.0, 50.0, 1.0) is None
    assert progress.left(50.0, 100.0, 0.0, 0.0) is None


def test_time_above_twenty_seconds_has_steps_of_five() -> None:
    assert progress.spoken(20.7) == "20 s left"
    assert progress.spoken(19.4) == "19 s left"


def test_starting_is_no_rate(clock: list[float]) -> None:
    log = io.StringIO()
    with progress.shown("runs", 100.0, stream=log) as show:
        for clock[0], done in ((101.0, 0.0), (102.0, 20.0), (112.0, 30.0)):
            show(done, "")
    assert log.getvalue() == "schmidt: runs: 30 %, 1 min 10 s left\n"  # 10 in 10 s, 70 are left


def test_a_total_below_one_is_shared_out_and_no_line_ends_it(clock: list[float]) -> None:
    log = io.StringIO()
    with progress.shown("search", 0.5, stream=log) as show:
        clock[0] += 10.0
        show(0.5, "")
        show(0.1, "step")
    assert log.getvalue() == "schmidt: search: 20 %, step, time left not known yet\n"


def test_a_line_does_not_wait_in_a_buffer(clock: list[float]) -> None:
    raw = io.BytesIO()
    log = io.TextIOWrapper(raw)
    with progress.shown("runs", 2.0, stream=log) as show:
        clock[0] += 10.0
        show(1.0, "")
        assert raw.getvalue().startswith(b"schmidt: runs: 50 %")


def test_a_terminal_has_a_bar_that_goes_when_it_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("NO_COLOR", "1")
    out = Terminal()
    with progress.shown("runs", 100.0, stream=out) as show:
        show(50.0, "first")
        at_once = out.getvalue()
        show(60.0, "first")
        assert out.getvalue().count("first") == at_once.count("first")  # no new step, no new picture yet
        show(200.0, "")
        last = out.getvalue().splitlines()[-1]
    before, percent, after = at_once.splitlines()[-1].partition("50%")
    assert "runs: first" in before and percent and "time left not known yet" in after
    assert "100%" in last and "runs:" not in last
    assert not out.getvalue().rstrip("\x1b[?25hl").endswith("\n") and "\x1b[2K" in out.getvalue()[-12:]


def test_a_stage_before_which_no_time_went_is_as_usual() -> None:
    assert progress.paced(5.0, 20.0, 0.0, 5.0) == 10.0
    assert progress.paced(0.0, 20.0, 10.0, 5.0) == 5.0
    assert progress.paced(1.0, 20.0, 0.5, 5.0) == 11.0


def test_a_tick_shows_the_stage_from_its_first_beginning(
    monkeypatch: pytest.MonkeyPatch, clock: list[float]
) -> None:
    ticks: list[Callable[[], None]] = []
    waits: list[float] = []
    did: list[str] = []
    seen: list[tuple[float | None, str]] = []

    def thread(target: Callable[[], None], daemon: bool) -> SimpleNamespace:
        assert daemon
        ticks.append(target)
        return SimpleNamespace(start=lambda: did.append("start"), join=lambda: did.append("join"))

    def wait(seconds: float) -> bool:
        waits.append(seconds)
        return len(waits) % 2 == 0

    @contextmanager
    def shown(_: str, total: float) -> Iterator[progress.Show]:
        assert total == 30.0
        yield lambda done, step: seen.append((done, step))

    monkeypatch.setattr(progress, "Thread", thread)
    monkeypatch.setattr(progress, "Event", lambda: SimpleNamespace(wait=wait, set=lambda: did.append("set")))
    monkeypatch.setattr(progress, "shown", shown)
    with progress.stages("calibrating", {"a": 10.0, "b": 20.0}) as enter:
        for at_s, name in ((4.0, ""), (5.0, "b"), (7.0, ""), (8.0, "b"), (9.0, ""), (20.0, "")):
            clock[0] = 100.0 + at_s
            if name:
                enter(name)
            else:
                ticks[0]()
    assert seen == [(4.0, "a"), (14.0, "b"), (18.0, "b"), (None, "b, longer than usual")]
    assert set(waits) == {1.0} and did == ["start", "set", "join"]
