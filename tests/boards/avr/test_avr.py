"""A program for an ATmega328P under simavr, its pins on our MCP2515: alone, and as a node of the lab."""

from itertools import pairwise
from pathlib import Path

import pytest

from boards.avr import core
from boards.c.library import FirmwareError
from boards.core.declared import BoardError
from bus.can import Frame
from bus.protocol import Opcode, pack_command, unpack_reply
from tests.boards.avr.rig import DEVICE, SECOND, Rig, built, in_the_lab

NODE = Path(__file__).parent / "node.c"


@pytest.fixture(scope="module")
def elf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(tmp_path_factory.mktemp("avr"), NODE)


def test_frames_come_by_the_processors_own_timer(elf: Path) -> None:
    rig = Rig(elf)
    rig.queue.run_until(2 * SECOND)
    tach = rig.of(0x200)
    assert len(tach) == 199
    assert [int.from_bytes(frame.data[2:6], "little") for _, frame in tach] == list(range(199))
    gaps = [b - a for (a, _), (b, _) in pairwise(tach)]
    # a bit is 1 us; the heartbeat of every hundredth tick does not delay the TACH that goes before it
    assert all(abs(gap - 10_000_000) < 10_000 for gap in gaps)
    assert [frame.data[1:4] for _, frame in rig.of(0x700)] == [b"\xf7\x01\x00", b"\xf7\x01\x01"]


def test_its_crystal_is_its_own(elf: Path) -> None:
    fast = Rig(elf, ppm=1000.0)
    fast.queue.run_until(2 * SECOND)
    first, last = fast.of(0x200)[0][0], fast.of(0x200)[-1][0]
    assert len(fast.of(0x200)) == 200
    assert abs((last - first) / 199 - 10_000_000 / 1.001) < 100


def test_a_command_raises_int_and_is_answered(elf: Path) -> None:
    rig = Rig(elf)
    waits = []
    for k in range(50):
        rig.queue.run_until(100_000_000 + k * 7_300_000)  # at any time within its 10 ms
        asked = rig.queue.now_ns
        rig.partner.send(Frame(0x080 + DEVICE, pack_command(DEVICE, Opcode.PING)), asked)
        rig.partner.send(Frame(0x080 + DEVICE + 1, pack_command(DEVICE + 1, Opcode.PING)), asked)
        rig.queue.run_until(asked + 5_000_000)
        t, frame = rig.of(0x100)[-1]
        waits.append(t - asked)
        assert unpack_reply(frame.data).result == 0
    assert len(rig.of(0x100)) == 50
    assert max(waits) < 1_000_000  # two frames and three transactions, or a TACH before


def test_without_supply_it_is_silent_and_boots_again(elf: Path) -> None:
    rig = Rig(elf)
    rig.queue.run_until(SECOND)
    rig.board.power_off(rig.queue.now_ns)
    before = len(rig.heard)
    rig.queue.run_until(2 * SECOND)
    assert len(rig.heard) == before
    rig.board.power_on(rig.queue.now_ns)
    rig.queue.run_until(3 * SECOND)
    again = rig.of(0x200)[len([t for t, _ in rig.of(0x200) if t <= SECOND])]
    assert again[1].data[2:6] == bytes(4)
    assert again[0] > 2_300_000_000


def test_two_runs_are_the_same(elf: Path) -> None:
    heard = []
    for _ in range(2):
        rig = Rig(elf, ppm=20.0)
        rig.queue.run_until(SECOND)
        heard.append(rig.heard)
    assert heard[0] == heard[1]


def test_a_program_that_ends_is_one_line(tmp_path: Path) -> None:
    source = tmp_path / "node.c"
    source.write_text("#include <avr/sleep.h>\nint main(void) { sleep_enable(); sleep_cpu(); return 0; }\n")
    with pytest.raises(BoardError, match=r"node\.elf: halts: it sleeps with interrupts off: board AVR at 0"):
        Rig(built(tmp_path, source)).queue.run_until(SECOND)
    (tmp_path / "no.elf").write_text("none")
    for name, what in (("no.elf", "no ELF file for an AVR"), ("gone.elf", "no such file")):
        with pytest.raises(FirmwareError, match=what):
            Rig(tmp_path / name)


def test_it_is_a_node_of_the_lab(elf: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, factor = in_the_lab(elf, tmp_path)
    assert log.count(" 231#") > 500
    assert log.count(" 131#") >= 1
    with capsys.disabled():
        print(f"\nlab with an AVR: {factor:.1f} times real time")


def test_without_simavr_one_line_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(core, "_FLAGS", ("-std=gnu11", "-fPIC", "-shared"))  # no folder has its headers
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with pytest.raises(FirmwareError, match=r"a\.elf: libsimavr is not installed: apt install libsimavr-dev"):
        core.library.__wrapped__(Path("a.elf"))
