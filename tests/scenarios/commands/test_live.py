"""Commands with real time and cables: extras, what does not go together, and what is told of a repetition."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result

from scenarios.commands import live


def call(command: Any, *words: object) -> Result:
    return CliRunner().invoke(command, [str(each) for each in words])


@pytest.fixture
def needed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Extras, and `plain` where compiled code is not used."""
    found: list[str] = []
    monkeypatch.setattr(live, "need", lambda *extras: found.extend(extras))
    monkeypatch.setattr("scenarios.native.finder.plain", lambda: found.append("plain"))
    return found


def instead(monkeypatch: pytest.MonkeyPatch, module: str, **names: Any) -> None:
    """A module that a command imports when it is called."""
    monkeypatch.setitem(sys.modules, f"scenarios.doors.{module}", SimpleNamespace(**names))


@pytest.mark.parametrize(("words", "extras"), [
    ((), []), (("--record", "f"), ["parquet"]), (("--frames", "f"), ["camera"]), (("--lx200", "4030"), []),
    (("--alpaca", "0"), ["alpaca"]), (("--console", "0"), ["consoles"]),
    (("--snapshots", "f"), ["plain"]), (("--from", "f"), ["plain"]),
])  # fmt: skip
def test_serve_needs_what_its_doors_need(
    words: tuple[str, ...], extras: list[str], needed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    instead(monkeypatch, "serving", serve=lambda options: 7)
    assert call(live.serve, *words).exit_code == 7 and needed == extras


@pytest.mark.parametrize("words", [
    ("scenario.yaml",), ("--seed", 0), ("--plant", "p"), ("--network", "lab"),
    ("--mute", "DISPLAY", "--feed", "can.log"),
])  # fmt: skip
def test_what_is_in_a_snapshot_is_not_told_again(
    words: tuple[object, ...], needed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    instead(monkeypatch, "serving", serve=lambda options: 7)
    assert call(live.serve, *words).exit_code == 7
    done = call(live.serve, *words, "--from", "kept")
    assert done.exit_code == 2 and "--from goes on with what is in the snapshot, nothing else" in done.output


def test_a_host_alone_runs_for_as_long_as_told(needed: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def host(options: Any, _console: object) -> Any:
        asked.append(options.usb)
        return SimpleNamespace(run=asked.append)

    instead(monkeypatch, "cabled_host", CabledHost=host)
    done = call(live.host, "--usb", "unix:usb.sock", "--alpaca", "0", "--duration", "2.5")
    assert (done.exit_code, asked, needed) == (0, ["unix:usb.sock", 2.5], ["alpaca"])


A, B = "a" * 16 + "1", "b" * 16 + "2"


@pytest.mark.parametrize(("again", "before", "told", "status"), [
    (A, None, f"digest {A[:16]}\n", 0), (A, A, f"digest {A[:16]} as recorded\n", 0),
    (A, B, f"digest {A[:16]}, recorded was {B[:16]}\n", 1),
])  # fmt: skip
def test_a_session_is_repeated_into_a_folder_beside_it(
    again: str, before: str | None, told: str, status: int, tmp_path: Path, needed: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    asked: list[Path] = []

    def replay(*folders: Path) -> tuple[str, str | None]:
        asked.extend(folders)
        return again, before

    instead(monkeypatch, "replay", replay=replay, replay_rest=None)
    folder = tmp_path / "session"
    done = call(live.replay, folder)
    assert (done.exit_code, done.output) == (status, told)
    assert asked == [folder, tmp_path / "session-replayed"] and needed == []
    call(live.replay, folder, "--out", tmp_path / "there")
    assert asked[2:] == [folder, tmp_path / "there"]


def test_the_rest_after_a_snapshot_is_repeated_plain(
    tmp_path: Path, needed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Path] = []

    def rest(*given: Path) -> tuple[str, None]:
        asked.extend(given)
        return A, None

    instead(monkeypatch, "replay", replay=lambda *_: (A, None), replay_rest=rest)
    assert call(live.replay, tmp_path, "--from", tmp_path / "kept").exit_code == 0
    assert asked == [tmp_path, tmp_path / "kept"] and needed == ["plain"]
    needed.clear()
    (tmp_path / "begun.snapshot").touch()
    assert call(live.replay, tmp_path).exit_code == 0
    assert len(asked) == 2 and needed == ["plain"]


def test_control_tells_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    instead(monkeypatch, "stepped", tell=lambda line, at, token: f"{line}|{at}|{token}")
    assert call(live.control, "speed", 2).output == "speed 2|127.0.0.1:7411|None\n"
    assert call(live.control, "pause", "--at", "7412", "--token", "w").output == "pause|7412|w\n"


def test_control_has_to_be_told_something() -> None:
    done = call(live.control)
    assert done.exit_code == 2 and "Missing argument 'COMMAND...'" in done.output
