"""Programs for an ATmega328P: compiled, alone on a wire, and as a node of the lab."""

import shutil
import subprocess
from pathlib import Path

import pytest

from boards.avr import AvrBoard
from boards.avr.core import library
from boards.c.library import FirmwareError
from boards.core.place import Place
from bus.can import Frame, Wire
from bus.time import EventQueue, Oscillator
from scenarios.lab.prepare import prepare
from scenarios.run import run as runner

DEVICE = 0x31
SECOND = 1_000_000_000
STRICT = ("-Wall", "-Wextra", "-Werror", "-std=gnu11")


def built(folder: Path, *sources: Path, compiler: str = "avr-gcc", flags: tuple[str, ...] = STRICT) -> Path:
    """An ELF file; skips the test where the packages are missing."""
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}: apt install gcc-avr avr-libc")
    try:
        library(Path("node.elf"))
    except FirmwareError as error:
        if "not installed" not in str(error):
            raise
        pytest.skip(str(error))
    made = folder / "node.elf"
    command = [compiler, "-mmcu=atmega328p", "-Os", *flags, *map(str, sources), "-o", str(made)]
    done = subprocess.run(command, capture_output=True, text=True)
    if "avr/io.h: No such file" in done.stderr:
        pytest.skip("no avr-libc: apt install avr-libc")
    assert done.returncode == 0, done.stderr
    return made


class Rig:
    """The board on a wire, and a partner that hears all."""

    def __init__(self, elf: Path, ppm: float = 0.0) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue, 1_000_000)
        place = Place(
            name="AVR", device_type=DEVICE, queue=self.queue, wire=self.wire, oscillator=Oscillator(ppm, 0)
        )
        self.board = AvrBoard(place, elf)
        self.partner = self.wire.attach("partner")
        self.heard: list[tuple[int, Frame]] = []
        self.partner.on_receive = lambda t, frame: self.heard.append((t, frame))
        self.board.begin()

    def of(self, base: int) -> list[tuple[int, Frame]]:
        return [(t, frame) for t, frame in self.heard if frame.identifier == base + DEVICE]


def in_the_lab(elf: Path, folder: Path) -> tuple[str, float]:
    """Two runs of 5 s with equal digests: the log, and times real time."""
    shutil.copy(elf, folder / "tach.elf")
    (folder / "avr.yaml").write_text(
        "name: avr\nstart_utc: 2026-02-10T14:00:00Z\n"
        "network: {nodes: {MOTOR_RA_A: {firmware: tach.elf}}}\nsteps: [power_on: {}, wait: {for: 5 s}]\n"
    )
    digests = []
    for _ in range(2):
        made = prepare(folder / "avr.yaml")
        result = runner.run(*made, folder / "out", lambda *_: None, runner.Way(report=False))
        assert result.passed
        digests.append(result.summary["trace_digest"])
    assert digests[0] == digests[1]
    factor = result.summary["simulated_s"] / result.summary["wall_s"]
    return (folder / "out" / "can.log").read_text(), factor
