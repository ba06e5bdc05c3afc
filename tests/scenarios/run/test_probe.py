"""The probe: one digest wherever and however it is run."""

import importlib
import sys
from pathlib import Path

import pytest

from scenarios.lab.recorder import Recorder
from scenarios.lab.session import Session
from scenarios.run import probe


@pytest.fixture
def sessions(monkeypatch: pytest.MonkeyPatch) -> list[Session]:
    """Sessions that the probe makes."""
    made: list[Session] = []
    begin = Session.__init__

    def noting(self: Session, *given: object) -> None:
        made.append(self)
        begin(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(Session, "__init__", noting)
    probe.digest.cache_clear()
    return made


def test_a_probe_is_three_seconds_of_the_network_and_is_run_once(
    sessions: list[Session], monkeypatch: pytest.MonkeyPatch
) -> None:
    closed: list[bool] = []
    close = Recorder.close

    def noting(self: Recorder) -> list[str]:
        closed.append(True)
        return close(self)

    monkeypatch.setattr(Recorder, "close", noting)
    first = probe.digest()
    assert (len(first), int(first, 16) > 0) == (64, True)  # SHA-256
    (session,) = sessions
    assert session.network.queue.now_ns == 3_000_000_000
    assert session.programme.records[0].end_s is not None, "the network came up"
    assert closed == [True]
    assert not session.recorder.folder.exists()
    assert probe.digest() == first and len(sessions) == 1


def test_a_probe_is_the_same_again(sessions: list[Session]) -> None:
    first = probe.digest()
    probe.digest.cache_clear()
    assert probe.digest() == first and len(sessions) == 2


@pytest.mark.parametrize("words", [[], ["some.so"]])
def test_the_command_prints_it_and_may_be_given_a_library(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    used: list[Path] = []
    monkeypatch.setattr("scenarios.native.finder.use", used.append)
    probe.main(words)
    assert capsys.readouterr().out == f"{probe.digest()}\n"
    assert used == [Path(word) for word in words]


def test_importing_it_runs_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["probe"])
    importlib.reload(probe)
    assert capsys.readouterr().out == ""
