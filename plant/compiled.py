"""The one way to compile in this project: numba, cached under a key made of the sources.

Numba's own cache only notices a change in the file of the compiled function, not in the files of what it
calls. The cache directory is therefore named by a hash of every compiled source of the plant: a stale cache
is never used.

`kernel` and `entry` are for functions that Python calls (cached on disk). `inner` is for those that only
compiled code calls. They are compiled into their caller, so they cost nothing when it comes from the cache.
`kernel` and `inner` work in the arrays they are given and allocate none. Numba then leaves out the atomic
reference counts of every row and slice, which were 62 % of the plant's time. `entry` may allocate.
SCHMIDT_CACHE_DIR moves the cache.

Numba itself is loaded when the first function needs it. A network whose kernel was compiled beforehand
(`ahead.py`) never does, which saves most of a second and half of the memory.
"""

import atexit
import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable
from functools import cached_property, update_wrapper
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from plant import ahead

Floats = NDArray[np.float64]
F = TypeVar("F", bound=Callable[..., Any])

ROOM = Path(__file__).parent
BASE = "SCHMIDT_CACHE_DIR"
KERNELS: dict[str, Callable[..., Any]] = {}
"""Kernels as they were written, by name."""


def _fingerprint() -> str:
    """Return a hash of the compiled sources and of the compiler's version."""
    return hashlib.sha256((version("numba") + ahead.fingerprint(ROOM)).encode()).hexdigest()[:16]


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def cache_folder() -> Path:
    """Return the folder of compiled code: the user's cache, or a temporary one if that is read-only."""
    home = os.environ.get(BASE) or os.environ.get("NUMBA_CACHE_DIR")
    bases = [Path(home)] if home else []
    cache = os.environ.get("XDG_CACHE_HOME")
    if cache or os.environ.get("HOME"):
        bases.append((Path(cache) if cache else Path.home() / ".cache") / "schmidt")
    for base in bases:
        folder = base / f"compiled-{_fingerprint()}"
        if _writable(folder):
            return folder
    folder = Path(tempfile.mkdtemp(prefix="schmidt-compiled-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


class Inner:
    """A function that is compiled into its callers, once there is one: numba takes it for what it is by
    `_numba_type_`. py_func: the function as it was written."""

    def __init__(self, function: Callable[..., Any]) -> None:
        update_wrapper(self, function)
        self.py_func = function

    @cached_property
    def compiled(self) -> Any:
        """The function as numba has it."""
        options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": True, "_nrt": False}
        return _njit(self.py_func, **options)

    @property
    def _numba_type_(self) -> Any:
        return self.compiled._numba_type_

    def __call__(self, *arguments: Any) -> Any:
        """Run as Python; for tests, nothing else does."""
        return self.py_func(*arguments)


def kernel(function: F) -> F:
    """Compile for calls from Python; works in the arrays it is given. The machine code is kept on disk, or
    was made beforehand."""
    KERNELS[function.__name__] = function
    ready = ahead.find(function.__name__)
    return cast(F, ready) if ready is not None else _njit(function, cache=True, _nrt=False)


def entry(function: F) -> F:
    """Compile for calls from Python; may allocate. The machine code is kept on disk."""
    return _njit(function, cache=True)


def inner(function: F) -> F:
    """Compile into its callers, compiled code only; works in the arrays it is given."""
    return cast(F, Inner(function))


def _njit(function: F, **options: bool) -> F:
    """Compile. `_nrt` is private to numba: tests/plant/test_compiled.py tells when it changes its meaning."""
    import numba

    folder = str(cache_folder()) if options.get("cache") else ""
    if folder:
        numba.config.CACHE_DIR = folder  # type: ignore[attr-defined]
    compile_with: Any = numba.njit  # its stubs do not know all options
    compiled: F = compile_with(error_model="numpy", **options)(function)
    return compiled
