"""The plant's kernel compiled before it is needed, into a library beside this file (`make compiled`).

Numba's just-in-time compiler is the other way to the same machine code, to the bit. It takes seven seconds
once per user, and loading what it has kept takes 0.8 s and 100 MiB in every process. The library needs
neither. Its name holds a hash of every compiled source, so a library never stands in for an edited file: the
compiler does then.

plant/builder.py makes it. Without one nothing else changes.
"""

import hashlib
import importlib.util
import sysconfig
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

ROOM = Path(__file__).parent
LIBRARY = ROOM / "library"
SIGNATURES = {"advance": "void(float64[:, ::1], int64)"}
"""What is compiled beforehand: what a running network calls. Calibration's kernels come when needed."""
NAME = "kernels"


def fingerprint(room: Path = ROOM) -> str:
    """A hash of every file below `room` that compiled code may come from."""
    digest = hashlib.sha256()
    for path in sorted(room.rglob("*.py")):
        text = path.read_bytes()
        if (
            b"plant.compiled" in text
            or b"plant.kernels" in text
            or path.parent.name in ("kernels", "effects")
        ):
            digest.update(path.relative_to(room).as_posix().encode() + b"\0" + text)
    return digest.hexdigest()[:16]


def file() -> Path:
    """Where the library of these sources is, or would be, for this Python."""
    return LIBRARY / f"{NAME}-{fingerprint()}{sysconfig.get_config_var('EXT_SUFFIX')}"


def find(name: str) -> Callable[..., Any] | None:
    """A kernel of the library; None: it is compiled just in time."""
    library = _library() if name in SIGNATURES else None
    return None if library is None else getattr(library, name)


@cache
def _library() -> ModuleType | None:
    path = file()
    if not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(NAME, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
