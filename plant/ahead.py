"""The plant's kernel compiled before it is needed, into a library beside this file (`make compiled`).

Numba's just-in-time compiler is the other way to the same machine code, to the bit. It takes seven seconds
once per user, and loading what it has kept takes 0.8 s and 100 MiB in every process; the library needs
neither. Its name holds a hash of every compiled source, so a library never stands in for an edited file: the
compiler does then.

numba.pycc, which makes it, is to move out of numba some day; without it, or without a C compiler, there is no
library, and nothing else changes.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import shutil
import sysconfig
import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

ROOM = Path(__file__).parent
LIBRARY = ROOM / "library"
SIGNATURES = {"advance": "void(float64[:, ::1], int64)"}
"""What is compiled beforehand: what a running network calls. Calibration's kernels come when needed."""
_NAME = "kernels"


class AheadError(ValueError):
    """The library cannot be built here; the message says why."""


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
    return LIBRARY / f"{_NAME}-{fingerprint()}{sysconfig.get_config_var('EXT_SUFFIX')}"


def find(name: str) -> Callable[..., Any] | None:
    """A kernel of the library; None: it is compiled just in time."""
    library = _library() if name in SIGNATURES else None
    return None if library is None else getattr(library, name)


def build() -> bool:
    """Build the library unless it is there; returns whether there was anything to do. Raises AheadError."""
    target = file()
    if target.exists():
        return False
    for need in ("numba.pycc", "setuptools"):
        try:
            found = importlib.util.find_spec(need)
        except ModuleNotFoundError:
            found = None
        if found is None:
            raise AheadError(f"{need} is not installed")
    with tempfile.TemporaryDirectory(prefix="schmidt-ahead-") as folder:
        try:
            made = _compile(Path(folder))
        except Exception as error:  # numba's, LLVM's and distutils' own kinds
            raise AheadError(" ".join(f"{type(error).__name__}: {error}".split())) from None
        LIBRARY.mkdir(parents=True, exist_ok=True)
        half = target.with_suffix(".new")
        shutil.copy(made, half)
        half.replace(target)  # at once: others may be looking for it
        for old in LIBRARY.glob(f"{_NAME}-*"):
            if old != target:
                old.unlink(missing_ok=True)
    return True


def _compile(folder: Path) -> Path:
    """Compile into `folder`; for any processor of this kind, as the library may travel."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        compiler = importlib.import_module("numba.pycc").CC
    from plant import compiled
    from plant.kernels import advance

    made = compiler(_NAME, advance.__name__)
    made.use_nrt = False
    made.output_dir = str(folder)
    for name, signature in SIGNATURES.items():
        made.export(name, signature)(compiled.KERNELS[name])
    made.compile()
    return folder / str(made.output_file)


@cache
def _library() -> ModuleType | None:
    path = file()
    if not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(_NAME, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
