"""A snapshot's file: its head, its digest, what is refused of it, and what it does not write over."""

import zlib
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from host.logs.files import LogError
from scenarios.lab.snapshot import file as files
from scenarios.lab.snapshot.file import check_place, read, write
from scenarios.lab.snapshot.freeze import SnapshotError

HEAD = b"schmidt snapshot file 1\n"
WHOLE: dict[str, Any] = {"network": "n", "scenario": "s", "model": "m"}


@pytest.fixture(autouse=True)
def board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """One board of one's own, which is looked up again; plain values stand for a network."""
    path = tmp_path / "mine.py"
    path.write_text("X = 1")
    monkeypatch.setattr(files, "board_files", lambda scenario: [path])
    monkeypatch.setattr(files, "load_board", loaded.append)
    loaded.clear()
    return path


loaded: list[Path] = []


def packed(plain: bytes) -> bytes:
    body = zlib.compress(plain, 1)
    return HEAD + sha256(body).hexdigest().encode() + b"\n" + body


def said(path: Path) -> str:
    with pytest.raises(SnapshotError) as caught:
        read(path)
    return str(caught.value)


def test_what_is_written_is_read_again(tmp_path: Path, board: Path) -> None:
    path = tmp_path / "new" / "kept"
    size = write(WHOLE, path)
    data = path.read_bytes()
    assert size == len(data) and data.startswith(HEAD)
    assert data[len(HEAD) : len(HEAD) + 65] == sha256(data[len(HEAD) + 65 :]).hexdigest().encode() + b"\n"
    assert read(path) == {**WHOLE, "files": {board: sha256(b"X = 1").hexdigest()}} and loaded == [board]
    assert [each.name for each in path.parent.iterdir()] == ["kept"]
    write({**WHOLE, "model": "other"}, path)
    assert read(path)["model"] == "other"


def test_a_board_that_has_changed_is_not_gone_on_with(tmp_path: Path, board: Path) -> None:
    path = tmp_path / "kept"
    write(WHOLE, path)
    board.write_text("X = 2")
    assert said(path) == f"{path}: snapshot: {board} has changed, or is another file seen from here"
    board.unlink()
    assert "has changed" in said(path) and loaded == []


@pytest.mark.parametrize(("change", "words"), [
    (lambda data: b"x" + data, "this is no snapshot of schmidt's"),
    (lambda data: data[:-1], "snapshot: damaged: its bytes have another digest than its head says"),
    (lambda data: HEAD + sha256(b"xyz").hexdigest().encode() + b"\nxyz", "this is no snapshot of schmidt's"),
    (lambda data: packed(b"x"), "this is no snapshot of schmidt's"),
])  # fmt: skip
def test_what_is_no_snapshot_is_one_line(change: Any, words: str, tmp_path: Path) -> None:
    path = tmp_path / "kept"
    write(WHOLE, path)
    path.write_bytes(change(path.read_bytes()))
    assert said(path) == f"{path}: {words}"


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    assert said(tmp_path / "none").startswith(f"{tmp_path / 'none'}: ")
    assert said(tmp_path).startswith(f"{tmp_path}: ")


@pytest.mark.parametrize("whole", [[1], {"network": 1}, {"network": 1, "scenario": 1, "model": 1}])
def test_what_holds_no_network_is_said(whole: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "kept"
    write(WHOLE, path)
    monkeypatch.setattr(files, "restore", lambda plain: whole)
    assert said(path) == f"{path}: snapshot: holds no network"


def test_what_is_cut_off_or_too_long_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "kept"
    cut = zlib.compress(bytes(1000))[:-1]
    path.write_bytes(HEAD + sha256(cut).hexdigest().encode() + b"\n" + cut)
    words = f"{path}: snapshot: cut off, or longer than 256 MB when unpacked"
    assert said(path) == words
    write(WHOLE, path)
    monkeypatch.setattr(files, "_MOST", 1 << 20)
    path.write_bytes(packed(bytes((1 << 20) + 1)))
    assert said(path) == words.replace("256", "1")


def test_more_than_can_be_read_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "_MOST", 1 << 20)
    monkeypatch.setattr(files, "take", lambda whole: bytes(lengths.pop()))
    lengths[:] = [1 << 20, (1 << 20) + 1]
    with pytest.raises(SnapshotError, match=r"^snapshot: longer than 1 MB$"):
        write(WHOLE, tmp_path / "kept")
    assert not (tmp_path / "kept").exists()
    assert write(WHOLE, tmp_path / "kept") > 0


lengths: list[int] = []


def test_only_a_file_is_written_over(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(LogError, match="folder: cannot be written: it is no regular file"):
        write(WHOLE, tmp_path / "folder")
    check_place(tmp_path / "none")
    (tmp_path / "file").touch()
    check_place(tmp_path / "file")
    with pytest.raises(LogError, match="cannot be written: "):
        write(WHOLE, tmp_path / "file" / "kept")


def test_a_disk_that_refuses_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "os", SimpleNamespace(replace=full))
    with pytest.raises(LogError, match=r"kept: cannot be written: No space left on device$"):
        write(WHOLE, tmp_path / "kept")
