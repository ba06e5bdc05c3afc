"""A snapshot's file: a head line, the SHA-256 of what follows, and that, compressed."""

import os
import zlib
from hashlib import sha256
from pathlib import Path
from typing import Any

from host.logs.files import LogError
from plant.yamltext import check_regular
from scenarios.lab.nodes import board_files, load_board
from scenarios.lab.snapshot.freeze import SnapshotError, restore, take

_HEAD = b"schmidt snapshot file 1\n"
_MOST = 1 << 28
"""Bytes when unpacked; a network has some millions, a recorded run's graph as much again. ASSUMPTION."""


def write(whole: dict[str, Any], file: Path) -> int:
    """Write it whole or not at all; returns its bytes. Raises SnapshotError, or LogError for the disk."""
    files = {path: _digest(path) for path in board_files(whole["scenario"])}
    plain = take(whole | {"files": files})
    if len(plain) > _MOST:  # nobody could read it
        raise SnapshotError(f"snapshot: longer than {_MOST >> 20} MB")
    body = zlib.compress(plain, 1)
    data = _HEAD + sha256(body).hexdigest().encode() + b"\n" + body
    part = file.parent / f"{file.name}.part"
    try:
        check_place(file)
        file.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(data)
        os.replace(part, file)
    except OSError as error:
        raise LogError(f"{file}: cannot be written: {error.strerror}") from None
    return len(data)


def check_place(file: Path) -> None:
    """Raise LogError where something is that a file must not replace: a folder, a pipe, a device."""
    if file.exists() and not file.is_file():
        raise LogError(f"{file}: cannot be written: it is no regular file")


def read(file: Path) -> dict[str, Any]:
    """What stands in a file; raises SnapshotError with one line.

    The digest tells damage, not malice: a snapshot is as much to be trusted as a program.
    """
    try:
        check_regular(file)
        data = file.read_bytes()
    except (OSError, ValueError) as error:
        raise SnapshotError(f"{file}: {getattr(error, 'strerror', None) or error}") from None
    if not data.startswith(_HEAD):
        raise SnapshotError(f"{file}: this is no snapshot of schmidt's")
    told, _, body = data[len(_HEAD) :].partition(b"\n")
    if sha256(body).hexdigest().encode() != told:
        raise SnapshotError(f"{file}: snapshot: damaged: its bytes have another digest than its head says")
    try:
        unpacking = zlib.decompressobj()
        plain = unpacking.decompress(body, _MOST)
        if not unpacking.eof:
            raise SnapshotError(f"snapshot: cut off, or longer than {_MOST >> 20} MB when unpacked")
        whole: dict[str, Any] = restore(plain)
        if not isinstance(whole, dict) or not {"files", "network", "scenario", "model"} <= set(whole):
            raise SnapshotError("snapshot: holds no network")
        for path, digest in whole["files"].items():
            if _digest(path) != digest:
                raise SnapshotError(f"snapshot: {path} has changed, or is another file seen from here")
            load_board(path)
    except zlib.error:
        raise SnapshotError(f"{file}: this is no snapshot of schmidt's") from None
    except ValueError as error:
        raise SnapshotError(f"{file}: {error}") from None
    return whole


def _digest(path: Path) -> str:
    """SHA-256 of a user's board; "" for a file that is not there."""
    try:
        return sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""
