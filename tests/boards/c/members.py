"""The memory of firmware in C by the names of its members."""

import re
from pathlib import Path
from typing import Any

from cffi import FFI

from boards.c import library
from boards.c.library import compiler_for, run_tool

HEADERS = Path(library.__file__).parent
_STRUCTS = re.compile(r"^(?:enum|struct \w+) ?\{.*?^\};|^enum \{[^}]*\};", re.MULTILINE | re.DOTALL)


def members(file: Path, memory: bytes) -> dict[str, Any]:
    """The members of `struct board` by name, from the bytes of it; for who looks for a difference."""
    text = run_tool([*compiler_for(file), "-E", "-P", f"-I{HEADERS}", str(file)], file)
    ffi = FFI()
    ffi.cdef("\n".join(found for found in _STRUCTS.findall(text) if not found.startswith("struct firmware")))
    board = ffi.new("struct board *")
    ffi.buffer(board)[:] = memory
    return {name: _plain(ffi, getattr(board, name)) for name, _ in ffi.typeof("struct board").fields}


def _plain(ffi: Any, value: Any) -> Any:
    if isinstance(value, int):
        return value
    kind = ffi.typeof(value)
    if kind.kind == "array":
        return [_plain(ffi, each) for each in value]
    return {name: _plain(ffi, getattr(value, name)) for name, _ in kind.fields}
