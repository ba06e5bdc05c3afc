"""A C++ driver of other people, compiled as it is and bound to a chip: the mcp2515 component of ESPHome."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from ctypes import c_bool, c_size_t, c_uint8, c_uint32
from pathlib import Path
from typing import Any

import pytest

from boards.chips.mcp2515 import Mcp2515
from bus.can import Frame, Wire
from bus.time import EventQueue
from tests.boards.esphome import unpacked

WHEEL = "esphome==2026.6.5 --hash=sha256:4edcebb876c160aea2376cf32453a9b32b64afbb65d49cb4bdd66e2538edba51"
PARTS = ("mcp2515", "canbus")
SHIM = Path(__file__).parent / "cpp"
BYTE_NS = 1_000
"""SPI at the driver's 8 MHz: simulated time goes on while it talks."""
SPEEDS = {50_000: 10, 125_000: 15, 250_000: 17, 500_000: 18, 1_000_000: 20}
"""Its enumeration of bit rates, those both crystals below can make."""
CLOCKS = {20_000_000: 0, 16_000_000: 1, 8_000_000: 3}
OK, ALL_BUSY = 0, 2
NORMAL, LOOPBACK, LISTEN = 0x00, 0x40, 0x60

_EXCHANGE = ctypes.CFUNCTYPE(c_uint8, c_uint8)
_SELECT = ctypes.CFUNCTYPE(None, c_bool)
_NOW = ctypes.CFUNCTYPE(c_uint32)
_WAIT = ctypes.CFUNCTYPE(None, c_uint32)
_HEARD = ctypes.CFUNCTYPE(None, c_uint32, c_bool, c_bool, ctypes.POINTER(c_uint8), c_size_t)


def built(folder: Path) -> ctypes.CDLL:
    """The driver as a library. Skips the test without a C++ compiler or a package index."""
    compiler = shutil.which("c++") or shutil.which("g++")
    if compiler is None:
        pytest.skip("no C++ compiler: the C++ driver cannot be built")
    unpacked(folder, WHEEL, PARTS)
    sources = [SHIM / "probe.cpp", *(folder / f"esphome/components/{part}/{part}.cpp" for part in PARTS)]
    made = folder / "driver.so"
    subprocess.run(
        [compiler, "-std=c++20", "-fPIC", "-shared", f"-I{SHIM}", f"-I{folder}", *sources, "-o", made],
        check=True,
    )
    return ctypes.CDLL(str(made))


class Rig:
    """The driver, its chip on a wire, and a partner there."""

    def __init__(
        self, driver: ctypes.CDLL, bitrate: int = 500_000, fosc_hz: int = 16_000_000, mode: int = NORMAL
    ) -> None:
        self.driver, self.queue = driver, EventQueue()
        self.wire = Wire(self.queue, bitrate)
        self.chip = Mcp2515(self.queue, self.wire.attach("chip"), fosc_hz)
        self.partner = self.wire.attach("partner")
        self.partner_heard: list[Frame] = []
        self.partner.on_receive = lambda _t, frame: self.partner_heard.append(frame)
        self.heard: list[Frame] = []
        self._held: list[Any] = []  # ctypes lets go of a function that nobody else holds
        driver.wire(
            self._hold(_EXCHANGE, self._exchange),
            self._hold(_SELECT, lambda on: (self.chip.spi.select if on else self.chip.spi.deselect)()),
            self._hold(_NOW, lambda: self.queue.now_ns // 1_000_000),
            self._hold(_WAIT, self.run),
        )
        driver.start.restype = c_bool
        self.up = driver.start(SPEEDS[bitrate], CLOCKS[fosc_hz], mode, self._hold(_HEARD, self._on_heard))

    def _hold(self, kind: Any, function: Callable[..., Any]) -> Any:
        self._held.append(kind(function))
        return self._held[-1]

    def _exchange(self, byte: int) -> int:
        self.queue.run_until(self.queue.now_ns + BYTE_NS)
        return self.chip.spi.exchange(byte)

    def _on_heard(self, identifier: int, extended: bool, remote: bool, data: Any, length: int) -> None:
        content = bytes(length) if remote else bytes(data[:length])
        self.heard.append(Frame(identifier, content, extended, remote))

    def run(self, milliseconds: float = 5) -> None:
        self.queue.run_until(self.queue.now_ns + round(milliseconds * 1e6))

    def send(self, frame: Frame) -> int:
        """Ask the driver to send; its error number."""
        data = (c_uint8 * len(frame.data))(*frame.data)
        return int(
            self.driver.send(
                c_uint32(frame.identifier), frame.extended, frame.remote, data, c_size_t(len(frame.data))
            )
        )

    def loop(self) -> list[Frame]:
        """The driver's turn in its program's loop; what it has heard until now."""
        self.driver.loop()
        return self.heard
