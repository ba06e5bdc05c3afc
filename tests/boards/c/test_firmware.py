"""Firmware in C: what it is, what it does, and what becomes of a run when it fails."""

import dataclasses
import shutil
import subprocess
from pathlib import Path

import pytest

from boards.axis.commands import RATE_LIMIT
from boards.c import library
from boards.c.board import FirmwareBoard
from boards.c.isolated import IsolatedMemory
from boards.c.library import FirmwareError, Memory, load
from boards.core.declared import BoardError
from bus.can import Frame
from bus.protocol import COMMAND_BASE, AxisMode, AxisParameter, Device, Opcode, pack_command
from bus.protocol.scales import rate_q16
from plant.parts import EffectModel, Number
from plant.rows import write
from plant.world import constants
from scenarios.lab.network import Network
from scenarios.lab.prepare import Changes, prepare
from scenarios.lab.snapshot.freeze import restore, take
from scenarios.lab.wiring import wire
from scenarios.native import compiled
from scenarios.run.run import Way, run
from tests.boards.c import mutants
from tests.boards.c.duel import AXIS_C, Duel
from tests.boards.c.members import members

HEADER = AXIS_C.parents[1] / "c" / "firmware.h"
NIGHT = Path("observing-night")
SCENARIO = """\
name: in C
start_utc: 2026-02-10T14:00:00Z
network:
  nodes:
    AXIS_RA: {firmware: %s}
steps:
  - power_on: {}
  - wait: {for: 1 s}
"""
TIMER = "    b->ticks++;\n"
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Werror")
SMALL = {
    "avr-gcc": ("-mmcu=atmega2560", "-Os", *STRICT),
    "sdcc": ("-mstm8", "--std-c11", "--Werror", "--fsigned-char"),
}
"""Compilers with an int of 16 bits, as a dsPIC's has it."""


def network(folder: Path, wrong: str = "", isolated: bool = False) -> Network:
    """The lab with the axis board in C. wrong: a statement of its three hundredth tick."""
    text = AXIS_C.read_text(encoding="utf-8")
    assert TIMER in text
    (folder / "own.c").write_text(text.replace(TIMER, f"{TIMER}    if (b->ticks == 300) {wrong};\n"))
    (folder / "in-c.yaml").write_text(SCENARIO % "own.c")
    return wire(*prepare(folder / "in-c.yaml", Changes(isolated=isolated)))


def test_the_header_is_short() -> None:
    assert len(HEADER.read_text(encoding="utf-8").splitlines()) <= 150


@pytest.mark.parametrize(("parameter", "way"), [(4, -1), (5, 1)])
def test_both_heed_the_encoder_boards_limits(parameter: int, way: int) -> None:
    """Far inside their own: out they stop, at rest beyond it they say so, back they may."""
    duel = Duel(1)
    duel.both(0.1)
    duel.command(Opcode.POWER, 1)
    duel.command(Opcode.SET_RATE, way * RATE_LIMIT // 18)
    duel.both(1.0)
    here = duel.sides[0].network.boards["AXIS_RA"].motion.position
    for side in duel.sides:
        data = pack_command(Device.POSITION_RA, Opcode.SET_PARAMETER, parameter, here - way * 1000)
        side.node.arrive(Frame(COMMAND_BASE + Device.POSITION_RA, data))
    duel.both(3.0)
    assert duel.sides[1].state()["mode"] == AxisMode.STOP and duel.sides[1].state()["reached"]
    duel.command(Opcode.SET_RATE, -way * RATE_LIMIT // 18)
    duel.both(0.5)
    assert duel.sides[1].state()["mode"] == AxisMode.RATE


@pytest.mark.slow
@pytest.mark.parametrize("duel", ["lab:2", "final:4"])
def test_both_boards_say_the_same(duel: str) -> None:
    name, _, seed = duel.partition(":")
    both = Duel(int(seed), AXIS_C, name)
    both.run(120)
    assert both.compared > 2000


@pytest.mark.parametrize("compiler", ["avr-gcc", pytest.param("sdcc", marks=pytest.mark.slow)])
def test_it_compiles_where_an_int_has_16_bits(compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    command = [compiler, *SMALL[compiler], f"-I{HEADER.parent}", "-c", str(AXIS_C)]
    done = subprocess.run([*command, "-o", str(tmp_path / "axis.o")], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.slow
def test_no_statement_overflows_or_shifts_what_it_must_not() -> None:
    """Undefined behaviour ends the routine with SIGILL or SIGTRAP."""
    checks = "-fsanitize=signed-integer-overflow,shift,bounds,integer-divide-by-zero"
    flags = (checks, "-fsanitize-undefined-trap-on-error")
    duel = Duel(5, AXIS_C)
    board = duel.sides[1].network.boards["AXIS_RA"]
    assert isinstance(board, FirmwareBoard)
    checked = Memory(AXIS_C, flags, board.memory.ask)
    checked.bytes = board.memory.bytes
    board.memory = checked
    duel.run(150)


@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ("*(volatile int *)8 = 1", "ends with SIGSEGV"),
        ("__builtin_trap()", "ends with SIG"),
        ("board_timer((b->ticks--, b))", "ends with SIGSEGV"),
        ("for (;;)", "hangs: no end after two seconds"),
    ],
)
def test_a_crash_or_a_hang_is_one_line(tmp_path: Path, wrong: str, told: str, isolated: bool) -> None:
    made = network(tmp_path, wrong, isolated)
    with pytest.raises(
        BoardError, match=rf"own\.c: board AXIS_RA fails at 1\.\d+ s: board_timer {told}"
    ) as caught:
        made.run_until(2_000_000_000)
    assert "\n" not in str(caught.value)
    made.run_until(3_000_000_000)  # nobody else is lost
    assert made.boards["AXIS_DEC"].on and not made.boards["AXIS_RA"].on


def test_a_chip_has_six_acceptance_filters(tmp_path: Path) -> None:
    made = network(tmp_path, "can_filter(6, 0x7FF, 0)")
    with pytest.raises(BoardError, match="board AXIS_RA has no acceptance filter 6"):
        made.run_until(2_000_000_000)


def test_what_is_written_beyond_the_memory_is_nobodys_in_a_process_of_its_own(tmp_path: Path) -> None:
    made = network(tmp_path, "for (char *end = (char *)b; ; end += 4096) *end = 1", isolated=True)
    with pytest.raises(BoardError, match="board_timer ends with SIG"):
        made.run_until(2_000_000_000)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "static int count;\nvoid board_reset(struct board *b) { b->x = count++; }",
            "count is writable: put it into",
        ),
        ("void board_reset(struct board *b) { b->y = 0; }", r"own\.c:\d+:\d+: error: .*no member named .y"),
        ("", "there is no board_reset in it"),
    ],
)
def test_a_file_that_cannot_be_used_is_one_line(tmp_path: Path, text: str, told: str) -> None:
    rest = """
#include "firmware.h"
struct board { int x; };
const struct firmware firmware = {sizeof(struct board), 1, 1};
void board_init(struct board *b, uint8_t device, const int32_t *settings) {}
void board_timer(struct board *b) {}
void board_frame(struct board *b, const struct frame *frame) {}
void board_can(struct board *b) {}
void board_sent(struct board *b) {}
"""
    file = tmp_path / "own.c"
    file.write_text(rest + text)
    with pytest.raises(FirmwareError, match=told) as caught:
        load(file)
    assert "\n" not in str(caught.value) and "own.c" in str(caught.value)


def test_without_a_compiler_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(ValueError, match=r"nodes\.AXIS_RA\.firmware: .*needs a compiler, .*no-such-compiler"):
        network(tmp_path)


@pytest.mark.parametrize(
    ("was", "now", "told"),
    [
        ("own.c", "none.c", "none.c: No such file"),
        ("AXIS_RA", "GATEWAY", "GATEWAY.firmware: C runs on boards AXIS_"),
        ("  nodes", "  canopen: true\n  nodes", "no CANopen voice"),
        ("own.c}", "own.c, parameters: {99: 1}}", "parameter 99 does not exist"),
        ("own.c}", "own.c, parameters: {1: 99}}", "parameter 1 does not take 99"),
    ],
)
def test_what_a_scenario_cannot_have_is_one_line(tmp_path: Path, was: str, now: str, told: str) -> None:
    network(tmp_path)
    file = tmp_path / "in-c.yaml"
    file.write_text(file.read_text().replace(was, now))
    with pytest.raises(ValueError, match=told) as caught:
        wire(*prepare(file))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("isolated", [False, True])
def test_memory_is_taken_and_put_back(isolated: bool) -> None:
    memory = (IsolatedMemory if isolated else Memory)(AXIS_C)
    memory.bytes = pattern = (bytes(range(256)) * 8)[: memory.row.memory_bytes]
    assert memory.bytes == pattern
    assert members(AXIS_C, memory.bytes)["foreign_ns"] == int.from_bytes(bytes(range(8)), "little")


def test_a_loss_of_power_keeps_what_was_set(tmp_path: Path) -> None:
    made = network(tmp_path)
    board = made.board("AXIS_RA")
    made.run_until(500_000_000)
    assert board.parameters.set(1, 17).value == 17
    board.power_off(made.queue.now_ns)
    made.run_until(600_000_000)
    board.power_on(made.queue.now_ns)
    made.run_until(1_500_000_000)
    assert board.on and board.boots == 2
    assert board.parameters.get(1).value == 17
    state = members(AXIS_C, board.memory.bytes)
    assert state["mode"] == 0 and 0 < state["ticks"] < 200


@pytest.mark.skipif(compiled(), reason="snapshots are taken of the plain source")
@pytest.mark.parametrize("isolated", [False, True])
def test_a_snapshot_holds_the_firmwares_memory(tmp_path: Path, isolated: bool) -> None:
    made = network(tmp_path, isolated=isolated)
    made.run_until(700_000_000)
    whole = take(made)
    again = restore(whole)
    said: list[list[object]] = [[], []]
    for network_, heard in zip((made, again), said, strict=True):
        network_.wire.tap(lambda t_ns, frame, sender, heard=heard: heard.append((t_ns, frame, sender)))
        network_.run_until(1_500_000_000)
    assert said[0] == said[1] and said[0]
    (tmp_path / "own.c").write_text((tmp_path / "own.c").read_text() + "\n")
    load.cache_clear()
    with pytest.raises(ValueError, match=r"own\.c has changed"):
        restore(whole)


def test_what_it_says_for_whoever_debugs(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    network(tmp_path, 'debug_line("three hundred")').run_until(2_000_000_000)
    assert [record.getMessage().split(" ", 1)[1] for record in caplog.records] == ["s AXIS_RA: three hundred"]


def test_every_call_of_the_header_has_its_place() -> None:
    declared = HEADER.read_text(encoding="utf-8").partition("provided by the chips")[2]
    for name in library.CALLS:
        assert f" {name}(" in declared
    assert declared.count(");") == len(library.CALLS) + 3  # and two times, write_pwm()


def test_two_boards_of_one_file_have_their_own_memory(tmp_path: Path) -> None:
    network(tmp_path)
    file = tmp_path / "in-c.yaml"
    file.write_text(
        file.read_text().replace("own.c}", "own.c}\n    AXIS_DEC: {firmware: own.c, parameters: {1: 22}}")
    )
    made = wire(*prepare(file))
    answers = [made.boards[name].parameters.get(1).value for name in ("AXIS_RA", "AXIS_DEC")]
    assert answers == [10, 22]


@pytest.mark.slow
@pytest.mark.parametrize("firmware", ["paper", "fine"])
def test_the_night_is_byte_for_byte_that_of_the_python_boards(tmp_path: Path, firmware: str) -> None:
    found = []
    for way in ("python", "c"):
        scenario, model = prepare(NIGHT, Changes(firmware=firmware))
        if way == "c":
            nodes = {name: {"firmware": "axis.c"} for name in ("AXIS_RA", "AXIS_DEC")}
            scenario = dataclasses.replace(scenario, network={**scenario.network, "nodes": nodes})
        result = run(scenario, model, tmp_path / way, lambda *_: None, Way(report=False))
        found.append((result.summary["trace_digest"], (tmp_path / way / "can.log").read_bytes()))
    assert found[0] == found[1] and len(found[0][1]) > 10_000_000


@pytest.mark.long
def test_twenty_wrong_lines_of_twenty_are_found(tmp_path: Path) -> None:
    told = {mutant: mutants.found(mutant, tmp_path) for mutant in mutants.chosen(30, seed=1)}
    compiled_ones = [how for how in told.values() if how != mutants.UNCOMPILED]
    assert all(compiled_ones) and len(compiled_ones) >= 20, told


@pytest.mark.parametrize("opcode", [Opcode.TRACK_RATE, Opcode.SET_RATE])
def test_both_notice_wind(opcode: Opcode) -> None:
    """Shaken by 10 N m, then in still air; every frame is compared on the way."""
    duel = Duel(6)
    wind = EffectModel("wind_torque", parameters={"correlation_time": Number(0.3, "s", "a test")})
    duel.both(0.1)
    duel.command(Opcode.POWER, 1)
    duel.command(Opcode.SET_PARAMETER, AxisParameter.DUTY_FRACTION, 1)
    duel.command(Opcode.SET_PARAMETER, AxisParameter.RATE_LOCK, 1)
    duel.command(opcode, rate_q16(15.0))
    for effects, blowing in (((wind,), 1), ((), 0)):
        for side in duel.sides:
            plant = side.network.plant
            plant.advance(side.network.queue.now_ns)
            write(plant.world[0], effects, constants(plant.model.axes.ra), 1, "ra")
        duel.both(20.0)
        assert duel.sides[1].state()["blowing"] == blowing
        if not compiled():
            assert duel.sides[0].state()["motion.gusts.blowing"] == bool(blowing)


def test_the_watch_has_its_storage_before_a_signal_comes() -> None:
    """A thread's storage that is made at its first access is made by malloc, which a signal may interrupt."""
    module, _ = load(AXIS_C)
    symbols = subprocess.run(["nm", "-D", module.__file__], capture_output=True, text=True, check=True).stdout
    assert "siglongjmp" in symbols
    assert "__tls_get_addr" not in symbols
