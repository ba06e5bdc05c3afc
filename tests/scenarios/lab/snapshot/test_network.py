"""Restore-then-continue equals continue, at random instants; what is refused."""

import gc
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from boards.c.isolated import IsolatedMemory, unbuilt
from boards.c.library import Memory
from bus.can import Frame
from bus.can.candump import CandumpWriter
from bus.can.length import frame_bits
from bus.outside.node import OutsideNode
from bus.protocol import Device, Opcode
from plant.model import load
from plant.plant import Plant
from scenarios.lab.faults.table import KINDS
from scenarios.lab.network import Network, build
from scenarios.lab.networks import NetworkConfig
from scenarios.lab.snapshot.freeze import SnapshotError, restore, take
from tests.bus.can.test_wire import network as bare
from tests.scenarios.lab.faults.lab import EXAMPLES, Lab

AXIS_C = Path(__file__).parents[4] / "boards" / "axis" / "axis.c"
AHEAD_NS = 300_000_000
INSTANTS = st.integers(0, 700_000_000)


def fate(network: Network, ahead_ns: int = AHEAD_NS) -> tuple[Any, ...]:
    """All that can be seen of a network's future: bus, serial lines, USB, plant, counters."""
    log = CandumpWriter(None)
    others: list[tuple[Any, ...]] = []
    network.wire._taps[:] = [log.take]
    network.hid.to_host = lambda t_ns, report: others.append((t_ns, report))
    for name, uart in network.uarts.items():
        uart.sink = lambda t_ns, packet, name=name: others.append((t_ns, name, packet))  # type: ignore[misc]
    network.run_until(network.queue.now_ns + ahead_ns)
    network.plant.advance(network.queue.now_ns)
    ports = [(port.name, port.tec, port.rec, port.state, port.free_buffers) for port in network.wire.ports]
    return (
        log.hexdigest(), others, network.plant.world.tobytes(), network.wire.errors, ports, network.overruns,
        network.dropped, len(network.queue), network.queue.next_ns(),
    )  # fmt: skip


def both(lab: Lab, refused: tuple[str, ...] = ()) -> None:
    network = lab.network
    network.wire._taps.clear()
    network.hid.to_host = None
    again = restore(take(network), refused=refused)
    assert again is not network
    assert fate(again) == fate(network)


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(INSTANTS)
def test_restore_then_continue_equals_continue(t_ns: int) -> None:
    """Motors on, commands under way, the focus stepping, a node lost and booting: at any nanosecond."""
    lab = Lab().pull()
    lab.command(Device.FOCUS, Opcode.FOCUS_REFERENCE)
    lab.network.boards["DISPLAY"].power_off(lab.now_ns)
    lab.network.boards["DISPLAY"].power_on(lab.now_ns)
    for _ in range(6):
        lab.command(Device.AXIS_DEC, Opcode.PING)
    lab.network.run_until(lab.now_ns + t_ns)
    both(lab)


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(INSTANTS, st.sampled_from(("bit_errors", "duplicate_node", "babbler", "partition", "stuck_dominant")))
def test_a_bus_in_trouble_is_taken_with_its_trouble(t_ns: int, kind: str) -> None:
    """Error frames, collisions, counters, bus off: the fault is taken too and goes on."""
    lab = Lab().run(0.05)
    lab.faults.start(kind, **EXAMPLES[kind])
    lab.network.run_until(lab.now_ns + t_ns)
    both(lab)


@pytest.mark.parametrize("t_ns", range(0, 130_000, 3_000))
def test_a_frame_that_nobody_acknowledges_is_taken_with_its_error(t_ns: int) -> None:
    """A lone node: what ends the frame waits in the queue from its first bit on, and nobody saw it first."""
    fates = []
    queue, wire = bare(1)
    frame = Frame(0x123, bytes(8))
    wire.ports[0].send(frame, 0)
    queue.run_until(t_ns)
    for each in (wire, restore(take(wire))):
        each.queue.run_until(2_000_000)
        fates.append((each.ports[0].tec, each.errors, each.bits, each.queue.next_ns()))
    assert fates[0] == fates[1]
    # up to the slot (without 1 + 7 + 3 bits behind it), flag 6, delimiter 8, intermission 3
    assert fates[0][0] == 8 * (2_000_000 // (1000 * (frame_bits(frame) + 6)))


@pytest.mark.parametrize("t_ns", [0, 33_333_333, 710_000_001])
def test_boards_that_speak_canopen(t_ns: int) -> None:
    """A master that is half way: started, a block of SDO requests under way, heartbeats on their crystals."""
    network = build(NetworkConfig(canopen=True, name="final"), Plant(load(), 1), 1)
    master = OutsideNode(network.queue, network.wire)
    network.run_until(50_000_000)
    master.arrive(Frame(0x000, b"\x01\x00"))
    network.run_until(300_000_000)
    for device in (Device.AXIS_RA, Device.FOCUS, Device.DISPLAY):
        master.arrive(Frame(0x600 + device, b"\x40\x18\x10\x01" + bytes(4)))
    network.run_until(network.queue.now_ns + t_ns)
    again = restore(take(network))
    assert [voice.operational for voice in again.voices.values()] == [True] * 18
    assert fate(again, 1_100_000_000) == fate(network, 1_100_000_000)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_fault_that_is_over_leaves_nothing_of_its_machinery(kind: Any) -> None:
    """From the state at clearing, a network that has never heard of faults goes on alike, bit by bit."""
    lab = Lab().pull()
    number = lab.faults.start(kind.name, **EXAMPLES[kind.name])
    lab.run(0.0873)
    lab.faults.clear(number)
    lab.run(0.001)  # what a guest had on the bus is through
    both(lab, refused=("scenarios.lab.faults", "bus.can.stuck", "bus.can.partition", "boards.core.halt"))


NOTHING_LEFT = [kind.name for kind in KINDS if kind.cleared == "nothing"]


@pytest.mark.parametrize("name", NOTHING_LEFT)
def test_where_nothing_is_left_the_bus_is_that_of_an_undisturbed_run(name: str) -> None:
    """Motors off, so that nothing moves: soon the log is that of a run without the fault."""
    fates = []
    for faulty in (True, False):
        lab = Lab().run(0.1)
        if faulty:
            number = lab.faults.start(name, **EXAMPLES[name])
        lab.run(0.25)
        if faulty:
            lab.faults.clear(number)
        lab.run(0.35)  # a serial packet and a summary hold a quarter of a second
        fates.append(fate(lab.network))
    assert fates[0] == fates[1]


def test_a_snapshot_may_be_restored_often() -> None:
    lab = Lab().run(0.1)
    lab.network.wire._taps.clear()
    data = take(lab.network)
    assert fate(restore(data)) == fate(restore(data))
    gc.collect()
    assert take(restore(data)) is not None


def test_a_snapshot_of_what_was_restored() -> None:
    lab = Lab().pull()
    lab.network.wire._taps.clear()
    once = restore(take(lab.network))
    twice = restore(take(once))
    plant = twice.plant
    assert np.shares_memory(np.asarray(plant.view), plant.world)
    assert fate(once) == fate(twice) == fate(lab.network)


def test_what_is_no_snapshot_is_refused_in_one_line() -> None:
    class Evil:
        def __reduce__(self) -> Any:
            return print, ("run by a file",)

    lab = Lab()
    lab.network.wire._taps.clear()
    data = take(lab.network)
    head = data[: data.index(b"\n", 20) + 1]
    for wrong, reason in (
        (b"PK\x03\x04", "no snapshot"),
        (data.replace(b"1\n", b"2\n", 1), "no snapshot"),
        (data[:19] + b"0" * 64 + data[83:], "other sources"),
        (data[:5000], "damaged"),
        (head + pickle.dumps(Evil()), "no business"),
    ):
        with pytest.raises(SnapshotError, match=reason) as caught:
            restore(wrong)
        assert "\n" not in str(caught.value)


def test_what_no_snapshot_can_hold_is_said() -> None:
    lab = Lab()
    with pytest.raises(SnapshotError, match="outside the sources"):
        take(lambda: lab)


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("scenarios.lab.snapshot.file", "os.system"),
        ("scenarios.lab.snapshot.file", "os"),
        ("canopen.network", "threading.Thread"),
        ("numpy", "load"),
        ("os", "system"),
        ("numpy", "memmap"),
        ("subprocess", "Popen"),
        ("host.logs.files", "write_file"),
        ("scenarios.lab.nodes", "load_board"),
        ("scenarios.lab.recorder", "Recorder"),
        ("scenarios.native.build", "build"),
        ("boards.avr.core", "Core"),
        ("boards.c.library", "Memory"),
        ("boards.c.isolated", "IsolatedMemory"),
        ("plant.fmu.library", "build"),
        ("bus.protocol.page", "page"),
    ],
)
def test_what_a_module_imports_is_not_in_a_snapshot(module: str, name: str) -> None:
    body = b"\x80\x05" + b"".join(b"\x8c" + bytes([len(text)]) + text.encode() for text in (module, name))
    head, digest, _ = take(None).split(b"\n", 2)
    with pytest.raises(SnapshotError, match="no business"):
        restore(b"\n".join((head, digest, body + b"\x93.")))


@pytest.mark.parametrize("flags", [("-wrapper", "sh,-c,touch {file}"), ()])
@pytest.mark.parametrize("kind", [Memory, IsolatedMemory])
def test_a_compiler_is_not_told_to_run_a_program(kind: type, flags: tuple[str, ...], tmp_path: Path) -> None:
    """Neither by the constructor's arguments nor by the state that follows it."""
    file = tmp_path / "ran"
    words = tuple(word.format(file=file) for word in flags)

    class Constructed:
        def __reduce__(self) -> Any:
            return kind, (AXIS_C, words)

    class Filled:
        def __reduce__(self) -> Any:
            state = {"file": AXIS_C, "flags": words or ("-v",), "ask": None}
            return unbuilt, (kind is IsolatedMemory,), state

    head, digest, _ = take(None).split(b"\n", 2)
    for wrong, reason in ((Constructed, "no business"), (Filled, "no flags for the compiler")):
        with pytest.raises(SnapshotError, match=reason):
            restore(b"\n".join((head, digest, pickle.dumps(wrong()))))
    assert not file.exists()


def test_a_module_is_not_reached_through_a_method() -> None:
    """A function's globals hold the modules that its own imports."""
    head, digest, _ = take(None).split(b"\n", 2)
    body = b"cbuiltins\ngetattr\n(cboards.core.interrupts\n_no_routine\nV__globals__\ntR."
    with pytest.raises(SnapshotError, match="__globals__ has no business"):
        restore(b"\n".join((head, digest, body)))


def test_a_file_is_not_written_through_a_method(tmp_path: Path) -> None:
    head, digest, _ = take(None).split(b"\n", 2)
    file = tmp_path / "written"
    path = b"(cpathlib\nPosixPath\n(V" + str(file).encode() + b"\ntR"
    body = b"cbuiltins\ngetattr\n" + path + b"Vwrite_text\ntR(Vevil\ntR."
    with pytest.raises(SnapshotError, match="write_text has no business"):
        restore(b"\n".join((head, digest, body)))
    assert not file.exists()


def test_a_function_of_the_projects_files_is_none_of_a_snapshots() -> None:
    head, digest, _ = take(None).split(b"\n", 2)
    body = b"cscenarios.lab.snapshot.code\nfunction\n(Vscenarios.lab.nodes\nI3\n)tR."
    with pytest.raises(SnapshotError, match=r"a function of scenarios.lab.nodes has no business"):
        restore(b"\n".join((head, digest, body)))
