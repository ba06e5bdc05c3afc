"""The cache of compiled code: never stale, and never in the way."""

from pathlib import Path

import pytest

from plant import compiled


def test_cache_folder_is_named_after_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(compiled.BASE, str(tmp_path))
    before = compiled.cache_folder()
    assert before.parent == tmp_path
    assert compiled.cache_folder() == before
    room = tmp_path / "room"
    room.mkdir()
    (room / "kernel.py").write_text("from plant.compiled import entry\n")
    monkeypatch.setattr(compiled, "ROOM", room)
    first = compiled.cache_folder()
    (room / "kernel.py").write_text("from plant.compiled import entry  # changed\n")
    assert len({before, first, compiled.cache_folder()}) == 3


def test_cache_folder_falls_back_to_a_temporary_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    for word in (compiled.BASE, "XDG_CACHE_HOME"):
        monkeypatch.setenv(word, str(blocked / word))
    folder = compiled.cache_folder()
    assert folder.is_dir()
    assert tmp_path not in folder.parents
    folder.rmdir()
