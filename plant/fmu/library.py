"""The library inside an FMU: the plant's kernels as machine code that needs no Python, and the C around them.

Numba compiles the kernels to LLVM's language, which becomes an object file here. The machine's C compiler
links it with wrapper.c and refuses whatever is not in the C library: nothing of Python gets in.
"""

import os
import shutil
import subprocess
import sysconfig
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from plant.compiled import Floats, cache_folder
from plant.kernels.advance import advance_axis
from plant.world import Numbers, prepare

_HERE: Final = Path(__file__).parent
_FLAGS: Final = (
    "-std=gnu11", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off", "-Wl,-z,defs",
    "-Wl,-z,noexecstack",
)  # fmt: skip
"""No contraction: a fused multiplication rounds once less than the emulator does."""


class FmuError(ValueError):
    """An axis cannot be exported here; the message says why."""


def build(header: str, fmi: int) -> bytes:
    """Return the library of an axis for this machine. Raises FmuError."""
    compiler = (os.environ.get("CC") or str(sysconfig.get_config_var("CC") or "cc")).split()
    if shutil.which(compiler[0]) is None:
        raise FmuError(f"an FMU needs a C compiler, and there is no {compiler[0]} here")
    objects = [str(path) for path in _kernels()]
    with tempfile.TemporaryDirectory(prefix="schmidt-fmu-") as folder:
        (Path(folder) / "model.h").write_text(header, encoding="utf-8")
        made, wrapper = Path(folder) / "axis.so", str(_HERE / "wrapper.c")
        parts = [f"-DFMI={fmi}", f"-I{folder}", wrapper, *objects, "-o", str(made), "-lm"]
        command = [*compiler, *_FLAGS, *parts]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise FmuError(f"{compiler[0]}: {' '.join(done.stderr.split())[:300]}")
        return made.read_bytes()


def _kernels() -> list[Path]:
    """Object files of both kernels, kept with the compiler's other results."""
    from numba import types

    row = types.Array(types.float64, 1, "C")
    given = {
        "prepare": (_from_array(), types.void(row, row)),
        "advance": (_advance, types.void(row, types.int64)),
    }
    folder = cache_folder()
    found = []
    for name, (function, signature) in given.items():
        path = folder / f"fmu-{name}.o"
        if not path.exists():
            half = path.with_suffix(f".{os.getpid()}")
            half.write_bytes(_object(f"kernel_{name}", function, signature))
            half.replace(path)
        found.append(path)
    return found


def _advance(w: Floats, steps: int) -> None:
    advance_axis(w, steps)


def _from_array() -> Callable[..., None]:
    """`prepare` with its numbers in an array: compiled code takes a tuple apart only by name."""
    numbers = ", ".join(f"p[{k}]" for k in range(len(Numbers._fields)))
    names: dict[str, Any] = {"prepare": prepare, "Numbers": Numbers}
    exec(f"def of_array(w, p):\n    prepare(w, Numbers({numbers}))", names)
    made: Callable[..., None] = names["of_array"]
    return made


def _object(name: str, function: Callable[..., None], signature: Any) -> bytes:
    """Compile a function to an object file for any processor of this kind, called `name`."""
    import llvmlite.binding as llvm
    import numba

    wrappers = dict.fromkeys(("no_cpython_wrapper", "no_cfunc_wrapper"), True)
    options: Any = {"error_model": "numpy", "_nrt": False, **wrappers}
    compiled: Any = numba.njit(signature, **options)(function)
    made = compiled.overloads[compiled.signatures[0]]
    text = made.library.get_llvm_str().replace(made.fndesc.llvm_func_name, name)
    module = llvm.parse_assembly(text)
    module.verify()
    target = llvm.Target.from_default_triple()
    machine = target.create_target_machine(opt=2, reloc="pic", codemodel="default")
    return bytes(machine.emit_object(module))
