"""Room on the disk, asked before it is needed, so that files with a footer can still be closed."""

import shutil
from pathlib import Path

from host.logs.files import LogError

RESERVE_BYTES = 8 << 20
"""Enough for the buffers of all logs, a row group of every trace and the summary."""


def check(folder: Path, reserve_bytes: int = RESERVE_BYTES) -> None:
    """Raise `LogError` when the disk under `folder` is about to be full."""
    free = shutil.disk_usage(folder).free
    if free < reserve_bytes:
        raise LogError(
            f"{folder}: no space left on the disk ({free >> 20} MiB free); logs end here, readable"
        )
