"""A file of C made into a library, and the memory of each board that runs it.

The library is compiled once for each text of file, header and host, and kept below `~/.cache/schmidt`.
"""

import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from hashlib import sha256
from importlib.util import module_from_spec, spec_from_file_location
from os import environ
from pathlib import Path
from signal import SIGVTALRM, Signals
from typing import Any, Final, NamedTuple

ROUTINES: Final = ("reset", "timer", "frame", "can", "sent", "init")
"""What firmware provides, by the names without `board_`."""
CALLS: Final = (
    "crystal_100us", "read_encoder", "read_current", "read_endat", "write_pwm_q16", "can_filter",
    "can_send", "can_withdraw", "can_free", "can_state", "can_tec", "request_can", "can_notify", "uart_send",
    "book_cycles", "lost_interrupts", "count_dropped", "debug_line",
)  # fmt: skip
"""What it may call; the two times come with every routine."""
_HERE: Final = Path(__file__).parent
_FLAGS: Final = (
    "-std=gnu11", "-g", "-O2", "-fPIC", "-fvisibility=hidden", "-Werror=implicit-function-declaration",
)  # fmt: skip
_WRITABLE: Final = re.compile(r" [bBdDC] (\S+)$", re.MULTILINE)
_WORST_S: Final = 60
"""A compiler that takes longer hangs. ASSUMPTION."""
_DECLARED: Final = """
struct interrupt { uint8_t priority; uint16_t latency_cycles; uint16_t cost_cycles; };
struct firmware {
    uint16_t memory_bytes; uint32_t fcy_hz; uint32_t period_us; struct interrupt timer, can; ...;
};
extern const struct firmware firmware;
int64_t firmware_run(void **, int, int64_t, int64_t, uint32_t, int, const uint8_t *);
int64_t firmware_frame(void **, int64_t, uint32_t, int, int, int, const uint8_t *);
extern "Python" int64_t firmware_ask(void *, int64_t, int64_t, int64_t, void *, int);
"""

DUTIES_FROM: Final = 8
"""Bits of a signal, or of a call's place in CALLS. Above them are the duties of write_pwm(), 16 bits each,
and a bit that says so. They come with the next call or the routine's end, whatever is first."""

Ask = Callable[[int, int, int, bytes], int]
"""(call by its place in CALLS, + duties, two numbers, bytes) -> what firmware gets."""


class FirmwareError(ValueError):
    """Firmware that cannot be used here; one line."""


class Row(NamedTuple):
    """`struct firmware`: an interrupt is (priority, latency cycles, cost cycles)."""

    memory_bytes: int
    fcy_hz: int
    period_us: int
    timer: tuple[int, int, int]
    can: tuple[int, int, int]


class Memory:
    """One board's `struct board` with the library that works on it. ask: whoever answers its calls.

    run(block, routine by its place in ROUTINES, now, its end (ns), number, size, bytes) returns 0 or the
    signal that ended it, + duties. For `timer`: the encoder's counter and 1, if there is one. For `init`:
    device type, size, settings. frame(block, now, identifier, extended, remote, size, bytes): board_frame().
    Whoever calls them asks for `error` next: what `ask` has raised meanwhile. They are the library's own, as
    a function of Python between would cost as much as the firmware does.
    """

    def __init__(self, file: Path, flags: Sequence[str] = (), ask: Ask | None = None) -> None:
        self.file, self.flags = file, tuple(flags)
        self.ask = ask
        self._module, self.digest = load(file, self.flags)
        ffi, lib = self._module.ffi, self._module.lib
        row = lib.firmware
        lines = [(each.priority, each.latency_cycles, each.cost_cycles) for each in (row.timer, row.can)]
        self.row = Row(row.memory_bytes, row.fcy_hz, row.period_us, *lines)
        self._handle = ffi.new_handle(self)
        self.block = ffi.new("void *[]", row.memory_bytes // ffi.sizeof("void *") + 2)
        self.block[0] = self._handle
        self.run: Callable[[Any, int, int, int, int, int, bytes], int] = lib.firmware_run
        self.frame: Callable[[Any, int, int, bool, bool, int, bytes], int] = lib.firmware_frame
        self.error: BaseException | None = None

    def raise_error(self) -> None:
        """Raise what `ask` has raised meanwhile."""
        if self.error is not None:
            error, self.error = self.error, None
            raise error

    @property
    def bytes(self) -> bytes:
        """All of the board's memory."""
        return bytes(self._module.ffi.buffer(self.block + 1, self.row.memory_bytes))

    @bytes.setter
    def bytes(self, data: bytes) -> None:
        self._module.ffi.buffer(self.block + 1, self.row.memory_bytes)[:] = data

    def __reduce__(self) -> tuple[Callable[[bool], "Memory"], tuple[bool], dict[str, Any]]:
        from boards.c.isolated import IsolatedMemory, unbuilt

        # a snapshot does not name the class: called with flags, it would run the compiler with them
        state = {"file": self.file, "flags": self.flags, "ask": self.ask}
        state |= {"digest": self.digest, "bytes": self.bytes}
        return unbuilt, (isinstance(self, IsolatedMemory),), state

    def __setstate__(self, state: dict[str, Any]) -> None:
        # a restored library is loaded anew: its block and callbacks are the C compiler's, not pickle's
        if state["flags"]:  # those are a program's words, and a snapshot is data
            raise FirmwareError(f"{state['file']}: a snapshot has no flags for the compiler")
        # the same object, for whoever holds it: a checker wants a new one
        self.__init__(state["file"], (), state["ask"])  # type: ignore[misc]
        if self.digest != state["digest"]:
            raise FirmwareError(f"{self.file} has changed")
        self.bytes = state["bytes"]


@cache
def load(file: Path, flags: tuple[str, ...] = ()) -> tuple[Any, str]:
    """The module of a file of C, and the digest of what it is made of; raises FirmwareError with one line.

    flags: further ones for the compiler.
    """
    from cffi import FFI

    parts = [_HERE / "host.c", _HERE / "firmware.h", file]
    if file.exists() and not (file.is_file() or file.is_dir()):  # a pipe may never begin, a device never end
        raise FirmwareError(f"{file}: no regular file")
    try:
        texts = [part.read_bytes() for part in parts]
    except OSError as error:
        raise FirmwareError(f"{error.filename}: {error.strerror}") from None
    compiler = compiler_for(file)
    said = repr((compiler, sys.version, _FLAGS, flags, CALLS, _DECLARED, *texts))
    digest = sha256(said.encode()).hexdigest()
    name = f"_schmidt_firmware_{digest[:16]}"
    folder = Path(environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "schmidt" / "firmware"
    library = folder / f"{name}.so"
    if not library.exists():
        ffi = FFI()
        ffi.cdef(_DECLARED)
        numbers = f"enum {{ {', '.join(CALLS).upper()} }};\n"
        ffi.set_source(name, numbers + texts[0].decode(), compiler_verbose=0)
        _build(ffi, name, file, compiler, flags, library)
    spec = spec_from_file_location(name, library)
    if spec is None or spec.loader is None:
        raise FirmwareError(f"{library}: no library")
    try:
        module = module_from_spec(spec)
    except ImportError as error:
        raise FirmwareError(f"{file}: {error.msg}") from None
    spec.loader.exec_module(module)
    made: Any = module
    memory_of, contents = made.ffi.from_handle, made.ffi.buffer

    def ask(handle: Any, call: int, a: int, b: int, data: Any, length: int) -> int:
        memory: Memory = memory_of(handle)
        if memory.error is None and memory.ask is not None:
            try:
                return memory.ask(call, a, b, contents(data, length)[:] if length else b"")
            except BaseException as error:  # waits until the routine has come to its end
                memory.error = error
        return 0

    made.ffi.def_extern("firmware_ask")(ask)
    return made, digest


def _build(
    ffi: Any, name: str, file: Path, compiler: list[str], flags: tuple[str, ...], library: Path
) -> None:
    """Compile file and host, link them, and put the library in its place in one step."""
    library.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=library.parent) as made:
        source, own, whole = (Path(made) / each for each in ("host.c", "firmware.o", "library.so"))
        ffi.emit_c_code(str(source))
        run_tool([*compiler, *_FLAGS, *flags, f"-I{_HERE}", "-c", str(file), "-o", str(own)], file)
        symbols = run_tool(["nm", str(own)], file)
        if found := _WRITABLE.findall(symbols):
            raise FirmwareError(f"{file}: {found[0].partition('.')[0]} is writable: put it into struct board")
        needed = ["R firmware", *(f"T board_{routine}" for routine in ROUTINES)]
        if missing := [each for each in needed if f" {each}\n" not in symbols]:
            raise FirmwareError(f"{file}: there is no {missing[0][2:]} in it, which firmware.h declares")
        include = [f"-I{_HERE}", f"-I{sysconfig.get_path('include')}"]
        run_tool([*compiler, *_FLAGS, *include, "-shared", str(source), str(own), "-o", str(whole)], file)
        whole.rename(library)


def compiler_for(file: Path) -> list[str]:
    """The machine's compiler of C; raises FirmwareError without one."""
    command = (environ.get("CC") or str(sysconfig.get_config_var("CC") or "cc")).split()
    if shutil.which(command[0]) is None:
        raise FirmwareError(f"{file}: firmware in C needs a compiler, and there is no {command[0]} here")
    return command


def run_tool(command: list[str], file: Path) -> str:
    """A tool's output; raises FirmwareError with the first of what it complains of."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=_WORST_S)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise FirmwareError(f"{file}: {command[0]}: {error}") from None
    if done.returncode:
        lines = done.stderr.splitlines() or [f"{command[0]} fails"]
        line = next((each for each in lines if "error" in each or "undefined" in each), lines[-1])
        raise FirmwareError(line if str(file) in line else f"{file}: {line}")
    return done.stdout


def told(signal: int) -> str:
    """A signal in words."""
    return "hangs: no end after two seconds" if signal == SIGVTALRM else f"ends with {Signals(signal).name}"
