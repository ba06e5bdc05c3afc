"""Commands that take longer than five seconds say how far they are, in a log as well."""

import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from bus.conformance.result import judged
from calibration import command as calibration
from scenarios import progress
from scenarios.cli import cli
from scenarios.commands import checking


@pytest.fixture(autouse=True)
def often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "FIRST_S", 0.0)
    monkeypatch.setattr(progress, "EVERY_S", 0.0)
    monkeypatch.setattr(progress, "_TICK_S", 0.02)


def test_calibrate_says_what_is_left(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def slow(*_: Any, **_more: Any) -> int:
        progress.time.sleep(0.3)
        return 0

    monkeypatch.setattr(calibration, "calibrate", slow)
    log = tmp_path / "log.csv"
    log.write_bytes(b"0" * 2_000_000)
    done = CliRunner().invoke(cli, ["calibrate", str(log), "--out", str(tmp_path)])
    assert done.exit_code == 0
    assert (
        re.search(r"^schmidt: calibrating: \d+ %, reading", done.stderr, re.MULTILINE)
        and " s left" in done.stderr
    )


def test_conformance_counts_boards(monkeypatch: pytest.MonkeyPatch) -> None:
    def check(_bus: Any, _json: Any, settings: Any, boards: Any, _dbc: Any) -> int:
        settings.each(judged("period", "AXIS_RA_MOTION", True, "", ""))
        for board in boards:
            progress.time.sleep(0.02)
            settings.each(judged("command", f"{board.name} PING", True, "", ""))
        return 0

    monkeypatch.setattr(checking, "check", check)
    done = CliRunner().invoke(cli, ["conformance"])
    assert done.exit_code == 0
    lines = done.stderr.splitlines()
    assert lines[0].startswith("schmidt: conformance: 0 %, period: AXIS_RA_MOTION")
    assert lines[-1].startswith("schmidt: conformance: 92 %, command: DISPLAY PING, ")
