"""The processor: host.c made into a library with the machine's compiler, and called from here."""

import ctypes
import tempfile
from functools import cache
from hashlib import sha256
from os import environ
from pathlib import Path
from typing import Final

from boards.c.library import FirmwareError, compiler_for, run_tool

_HERE: Final = Path(__file__).parent
_FLAGS: Final = (
    "-std=gnu11",
    "-O2",
    "-fPIC",
    "-shared",
    "-I/usr/include/simavr",
    "-I/usr/local/include/simavr",
)
_HALTED: Final = {-1: "halts: it sleeps with interrupts off", -2: "crashes"}
NOTHING, LOW, HIGH = -1, 256, 257
"""Events: none, chip select falls, rises. 0 to 255: this byte is through."""


class Core:
    """An ATmega328P with a program. select: pin of port B that selects the chip. interrupt: pin of port D
    that its INT is on."""

    def __init__(self, file: Path, hz: int, select: int, interrupt: int) -> None:
        self._library = library(file)
        self._file = file
        if not file.is_file():
            raise FirmwareError(f"{file}: no such file")
        self._core = ctypes.c_void_p(self._library.core_open(str(file).encode(), hz, select, interrupt))
        if not self._core:
            raise FirmwareError(f"{file}: no ELF file for an AVR")

    def __getstate__(self) -> object:
        raise FirmwareError(f"{self._file}: a processor under simavr cannot be put into a snapshot")

    def run(self, until: int) -> tuple[int, int]:
        """Run to this cycle or to an event; returns the cycle and the event."""
        what = ctypes.c_int(-1)
        cycle: int = self._library.core_run(self._core, until, ctypes.byref(what))
        if cycle < 0:
            raise FirmwareError(f"{self._file}: {_HALTED[cycle]}")
        return cycle, what.value

    def asleep(self) -> int:
        """The cycle at which it wakes up by itself; 0: it is awake."""
        return int(self._library.core_asleep(self._core))

    def answer(self, byte: int) -> None:
        """What comes back with the byte that is through."""
        self._library.core_answer(self._core, byte)

    def interrupt(self, level: bool) -> None:
        """Level of the pin that INT is on."""
        self._library.core_interrupt(self._core, int(level))

    def reset(self) -> int:
        """As after power-up, memory aside; returns the cycle."""
        self._library.core_reset(self._core)
        return int(self._library.core_cycle(self._core))


@cache
def library(file: Path) -> ctypes.CDLL:
    """host.c as a library, kept below `~/.cache/schmidt`. Raises FirmwareError, which names `file`."""
    compiler = compiler_for(file)
    source = _HERE / "host.c"
    digest = sha256(repr((compiler, _FLAGS)).encode() + source.read_bytes()).hexdigest()[:16]
    folder = Path(environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "schmidt" / "avr"
    made = folder / f"avr-{digest}.so"
    if not made.exists():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as work:
            half = Path(work) / "avr.so"
            try:
                run_tool([*compiler, *_FLAGS, str(source), "-o", str(half), "-lsimavr"], file)
            except FirmwareError as error:
                what = "libsimavr is not installed: apt install libsimavr-dev"
                raise FirmwareError(f"{file}: {what}" if "sim_avr.h" in str(error) else str(error)) from None
            half.rename(made)
    try:
        found = ctypes.CDLL(str(made))
    except OSError as error:
        raise FirmwareError(f"{file}: {error}") from None
    found.core_open.restype = ctypes.c_void_p
    found.core_run.restype = found.core_cycle.restype = found.core_asleep.restype = ctypes.c_int64
    found.core_run.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.POINTER(ctypes.c_int)]
    return found
