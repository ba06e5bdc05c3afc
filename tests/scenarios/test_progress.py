"""What is left of something long, on a terminal and in a log."""

import io
import re
import time

import pytest

from scenarios import progress


def test_the_rate_so_far_gives_what_is_left() -> None:
    assert progress.left(25.0, 100.0, 0.0, 10.0) == pytest.approx(30.0)
    assert progress.left(60.0, 100.0, 50.0, 10.0) == pytest.approx(40.0)  # 50 were done before the clock
    assert progress.left(0.0, 100.0, 0.0, 10.0) is None
    assert progress.left(120.0, 100.0, 0.0, 10.0) == 0.0


def test_time_is_spoken() -> None:
    assert progress.spoken(7.4) == "7 s left"
    assert progress.spoken(83.0) == "1 min 25 s left"
    assert progress.spoken(None) == "time left not known yet"


def test_a_log_gets_a_line_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: clock[0])
    log = io.StringIO()
    with progress.shown("runs", 100, stream=log) as show:
        for second in range(1, 41):
            clock[0] = float(second)
            show(2.0 * second, f"run {second}")
    assert log.getvalue().splitlines() == [
        "schmidt: runs: 10 %, run 5, 45 s left",
        "schmidt: runs: 40 %, run 20, 30 s left",
        "schmidt: runs: 70 %, run 35, 15 s left",
    ]


def test_a_stage_goes_at_the_pace_of_those_before_it() -> None:
    assert progress.paced(0.0, 20.0, 0.0, 5.0) == 5.0  # the first: as usual
    assert progress.paced(20.0, 80.0, 40.0, 30.0) == 35.0  # twice as slow as usual
    assert progress.paced(20.0, 80.0, 20.0, 500.0) == pytest.approx(20.0 + 0.97 * 80.0)


def test_stages_are_shown_while_they_block(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "FIRST_S", 0.0)
    monkeypatch.setattr(progress, "EVERY_S", 0.0)
    monkeypatch.setattr(progress, "_TICK_S", 0.02)
    with progress.stages("compiling", {"first": 1.0, "second": 3.0}) as stage:
        time.sleep(0.1)
        stage("second")
        time.sleep(0.1)
    lines = capsys.readouterr().err.splitlines()
    assert any(re.fullmatch(r"schmidt: compiling: \d+ %, first, .* left", line) for line in lines)
    assert re.fullmatch(r"schmidt: compiling: \d+ %, second, .* left", lines[-1])


def test_a_last_stage_that_takes_longer_than_usual_has_no_time_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "FIRST_S", 0.0)
    monkeypatch.setattr(progress, "EVERY_S", 0.0)
    monkeypatch.setattr(progress, "_TICK_S", 0.02)
    with progress.stages("calibrating", {"1.0 MB of logs": 0.05}):
        time.sleep(0.2)
    last = capsys.readouterr().err.splitlines()[-1]
    assert last == "schmidt: calibrating: 1.0 MB of logs, longer than usual, time left not known yet"


def test_a_stage_is_begun_once(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(progress, "FIRST_S", 0.0)
    monkeypatch.setattr(progress, "EVERY_S", 0.0)
    monkeypatch.setattr(progress, "_TICK_S", 0.02)
    with progress.stages("calibrating", {"reading": 0.01, "searching": 10.0, "writing": 1.0}) as stage:
        for name in ("searching", "searching", "reading"):  # a step of a stage that is gone is none
            stage(name)
            time.sleep(0.06)
    last = capsys.readouterr().err.splitlines()[-1]
    assert "searching" in last
