"""Make the library of the plant's kernel (plant/ahead.py).

numba.pycc, which makes it, is to move out of numba some day. Without it, or without a C compiler, there is no
library, and nothing else changes.
"""

import importlib
import importlib.util
import shutil
import tempfile
import warnings
from pathlib import Path

from plant import ahead, compiled
from plant.kernels import advance


class AheadError(ValueError):
    """The library cannot be built here; the message says why."""


def build() -> bool:
    """Build the library unless it is there; returns whether there was anything to do. Raises AheadError."""
    target = ahead.file()
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
        ahead.LIBRARY.mkdir(parents=True, exist_ok=True)
        half = target.with_suffix(".new")
        shutil.copy(made, half)
        half.replace(target)  # at once: others may be looking for it
        for old in ahead.LIBRARY.glob(f"{ahead.NAME}-*"):
            if old != target:
                old.unlink(missing_ok=True)
    return True


def _compile(folder: Path) -> Path:
    """Compile into `folder`; for any processor of this kind, as the library may travel."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        compiler = importlib.import_module("numba.pycc").CC
    made = compiler(ahead.NAME, advance.__name__)
    made.use_nrt = False
    made.output_dir = str(folder)
    for name, signature in ahead.SIGNATURES.items():
        made.export(name, signature)(compiled.KERNELS[name])
    made.compile()
    return folder / str(made.output_file)
