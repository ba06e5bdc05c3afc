"""Other people's MCP2515 library, compiled by avr-g++ as it is: alone on the wire, and as a node of the lab.

It is the driver of ESPHome, which makes firmware with the Arduino framework; from its last wheel in C++11.
"""

import time
from pathlib import Path

import pytest

from boards.chips.mcp2515.registers import EFLG, RX0OVR, RX1OVR
from bus.can import Frame
from bus.protocol import Opcode, pack_command, unpack_reply
from tests.boards.avr.rig import DEVICE, SECOND, Rig, built, in_the_lab
from tests.boards.esphome import unpacked

WHEEL = "esphome==2021.12.3 --hash=sha256:d96d1d3303183e9f45532ea93986b119605240dcfb2d1ae2ef0c0ba63ff40bf0"
READ = 0x03
SHIM = Path(__file__).parent / "cpp"
PING = Frame(0x080 + DEVICE, pack_command(DEVICE, Opcode.PING))
pytestmark = pytest.mark.timeout(300)


@pytest.fixture(scope="module")
def elf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("public")
    unpacked(folder, WHEEL, ("mcp2515",))
    driver = folder / "esphome/components/mcp2515/mcp2515.cpp"
    flags = ("-std=gnu++11", "-fno-threadsafe-statics", f"-I{SHIM}", f"-I{folder}")
    return built(folder, SHIM / "public.cpp", driver, compiler="avr-g++", flags=flags)


def test_its_frames_come_and_every_command_is_answered(elf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = Rig(elf)
    begun = time.process_time()
    for k in range(50):
        rig.queue.run_until(100_000_000 + k * 37_300_000)  # at any time within its 10 ms
        rig.partner.send(PING, rig.queue.now_ns)
    rig.queue.run_until(2 * SECOND)
    factor = 2 / (time.process_time() - begun)
    replies = [unpack_reply(frame.data) for _, frame in rig.of(0x100)]
    assert [reply.result for reply in replies] == [0] * 50
    counts = [int.from_bytes(frame.data[3:5], "little") for _, frame in rig.of(0x200)]
    assert counts == list(range(len(counts)))
    assert 195 <= len(counts) <= 200
    assert [frame.data[3] for _, frame in rig.of(0x700)] == [0, 1]
    with capsys.disabled():
        print(f"\nan AVR with other people's driver: {factor:.1f} times real time")


def test_more_than_its_two_buffers_hold_is_lost_and_flagged_and_it_goes_on(elf: Path) -> None:
    rig = Rig(elf)
    rig.queue.run_until(SECOND)
    for _ in range(30):
        rig.partner.send(PING, rig.queue.now_ns)
    rig.queue.run_until(SECOND + 100_000_000)
    assert 2 <= len(rig.of(0x100)) < 30
    rig.board.chip.spi.select()
    flags = [rig.board.chip.spi.exchange(byte) for byte in (READ, EFLG, 0)][-1]
    rig.board.chip.spi.deselect()
    assert flags & (RX0OVR | RX1OVR)
    answered = len(rig.of(0x100))
    rig.partner.send(PING, rig.queue.now_ns)
    rig.queue.run_until(2 * SECOND)
    assert len(rig.of(0x100)) == answered + 1


@pytest.mark.slow
def test_it_is_a_node_of_the_lab(elf: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, factor = in_the_lab(elf, tmp_path)
    assert log.count(" 231#") > 490
    assert log.count(" 131#") >= 1
    with capsys.disabled():
        print(f"\nlab with other people's driver: {factor:.1f} times real time")
