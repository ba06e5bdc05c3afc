"""One attack per door: so many inputs from a seed, and what became of them.

    python -m tests.fuzz --inputs 1000000          every door, the long run (some hours; --door NAME for one)

An input is accepted or refused with an error the door declares; anything else is the exception it raised.
Now and then, and at the end, all boards must have ticked.
"""

import ast
import logging
import os
import socket
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from random import Random

import can

from bus.can import Frame
from bus.outside.door import Door as Fence
from scenarios.doors.can import CanDoor
from scenarios.doors.clients import Client
from scenarios.doors.control import ControlDoor
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.serial_tcp import TcpDoor
from scenarios.doors.snapshots import Snapshots
from scenarios.doors.steps import Steps
from scenarios.doors.usb import out_report
from scenarios.lab.prepare import chosen, load
from scenarios.language.document import ScenarioError
from scenarios.native.finder import compiled
from tests.fuzz import browser, chips, files, frozen, inputs, streams
from tests.fuzz.hosted import alpaca, lx200
from tests.fuzz.left import counted

MS = 1_000_000
ROOT = Path(__file__).parents[2]
_LOOK, _LOOKS = 1000, 100
"""Inputs between two looks at the boards, which take 1.1 s of their time; in a long run more, for so many."""


class Wedged(AssertionError):
    """A board that no longer ticks."""


def ticking(served: LiveNetwork) -> None:
    """Let 1.1 s go by; again where a reset was still on its way, as two boards tick once a second. Raises
    Wedged naming the boards whose timer routine did not run."""
    still = _still(served)
    for _ in range(2):
        still = still and _still(served)
    if still:
        raise Wedged(", ".join(still))


def _still(served: LiveNetwork) -> list[str]:
    boards = served.network.boards
    before = {name: board.ticks for name, board in boards.items()}  # type: ignore[attr-defined]
    served.entry.running = True
    served.run_until(served.now_ns + 1_100 * MS)
    served.entry.running = False
    return [name for name, board in boards.items() if board.ticks == before[name] and board.on]  # type: ignore[attr-defined]


def rounds(served: LiveNetwork, count: int, one: Callable[[int], None]) -> None:
    """So many inputs, time going on between them, and a look at the boards now and then."""
    look = max(_LOOK, count // _LOOKS)
    for number in counted(count):
        one(number)
        if number % 16 == 0:
            served.run_until(served.now_ns + 2 * MS)
        if number % look == look - 1:
            ticking(served)
    ticking(served)


class _Outside(can.BusABC):
    """A python-can bus that reads the way udp_multicast does, from a list of datagrams."""

    channel_info = "fuzz"

    def __init__(self) -> None:
        super().__init__("fuzz")
        self.into: deque[can.Message | bytes] = deque()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        pass

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        from can.interfaces.udp_multicast.utils import unpack_message

        if not self.into:
            return None, False
        item = self.into.popleft()
        if isinstance(item, can.Message):
            return item, False
        try:
            return unpack_message(item, replace={"timestamp": 0.0}, check=True), False
        except Exception as error:
            raise can.CanOperationError("could not unpack received message") from error


def _message(frame: Frame) -> can.Message:
    return can.Message(
        arbitration_id=frame.identifier, data=None if frame.remote else frame.data,
        dlc=len(frame.data), is_extended_id=frame.extended, is_remote_frame=frame.remote,
    )  # fmt: skip


def _can(served: LiveNetwork, count: int, make: Callable[[], can.Message | bytes]) -> dict[str, int]:
    door = CanDoor("virtual:fuzz", 0, served)
    with _Outside() as outside:
        door.fence = fence = Fence(served.network.queue, served.network.wire, outside, door.node, door._enter)

        def one(_number: int) -> None:
            outside.into.append(make())
            fence.poll()

        rounds(served, count, one)
        return {"accepted": fence.frames_in, "refused": fence.refused, "rejected": fence.rejected}


def frames(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """CAN frames."""
    return _can(served, count, lambda: _message(inputs.frame(random)))


def datagrams(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Datagrams on the multicast group."""
    return _can(served, count, lambda: inputs.datagram(random))


class _NoTraceback(logging.Handler):
    """Ends the attack where the package logs an exception instead of an answer."""

    def emit(self, record: logging.LogRecord) -> None:
        if record.exc_info:
            raise AssertionError(record.getMessage())


def canopen(count: int, random: Random) -> dict[str, int]:
    """NMT, SDO and other frames on a network whose boards speak CANopen."""
    scenario, model = chosen()
    served = LiveNetwork(replace(scenario, network={"name": "lab", "canopen": True}), model)
    nodes = [board.device_type for board in served.network.boards.values()]
    logger, handler = logging.getLogger("canopen"), _NoTraceback()
    logger.addHandler(handler)
    try:
        return _can(served, count, lambda: _message(inputs.canopen(random, nodes)))
    finally:
        logger.removeHandler(handler)


def hid(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """HID reports."""
    plug = served.usb.plug("fuzz")
    found = {"accepted": 0, "refused": 0}

    def one(_number: int) -> None:
        report = out_report(inputs.report(random))
        if report is None or not plug.ready:
            found["refused"] += 1
            return
        plug.write(served.now_ns, report)
        found["accepted"] += 1

    rounds(served, count, one)
    return found


def control(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Lines of the control plane."""
    door = ControlDoor("7411", "word", served)
    ours, theirs = socket.socketpair()
    client = Client(ours, "127.0.0.1")
    door._trusted.add(client)
    found = {"accepted": 0, "refused": 0}
    folder = tempfile.TemporaryDirectory(dir=inputs.MEMORY)
    Snapshots(Path(folder.name) / "taken", served)

    def one(number: int) -> None:
        answer = door._answer(client, inputs.line(random).rstrip(b"\n"))
        if not answer.startswith(("ok", "error: ")) or "\n" in answer:
            raise AssertionError(f"an answer of its own kind: {answer!r}")
        found["accepted" if answer.startswith("ok") else "refused"] += 1
        if number % 100 == 99:
            for name in served.network.boards:
                served.switch(name, True)

    rounds(served, count, one)
    if {each.name for each in Path(folder.name).iterdir()} > {"taken"}:
        raise AssertionError("a file beside the folder of snapshots")
    folder.cleanup()
    client.close()
    theirs.close()
    return found


def steps(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Lines of clients that step the time, and clients that hang up."""
    served.steps = stepping = Steps(served)
    door = ControlDoor("7411", None, served)
    found = {"accepted": 0, "refused": 0, "waited": 0, "hung up": 0}
    folder = tempfile.TemporaryDirectory(dir=inputs.MEMORY)
    Snapshots(Path(folder.name) / "taken", served)
    pairs = [socket.socketpair() for _ in range(3)]
    clients = [Client(ours, "127.0.0.1") for ours, _ in pairs]
    door._trusted.update(clients)
    for _, theirs in pairs:
        theirs.setblocking(False)

    def one(number: int) -> None:
        place = random.randrange(3)
        client = clients[place]
        if random.random() < 0.1:
            stepping.leave(client)  # as the door does when a client has gone
            found["hung up"] += 1
        elif not stepping.waits(client):
            answer = door._answer(client, inputs.stepped(random))
            if answer is not None and (not answer.startswith(("ok", "error: ")) or "\n" in answer):
                raise AssertionError(f"an answer of its own kind: {answer!r}")
            kind = "waited" if answer is None else "accepted" if answer.startswith("ok") else "refused"
            found[kind] += 1
        else:
            found["waited"] += 1  # a client whose step is not over: what it sends is read afterwards
        looks = iter((False, False, False))
        stepping.run(lambda: next(looks, True), lambda _timeout_s: True)
        with suppress(BlockingIOError):
            pairs[place][1].recv(1 << 16)
        if number % 100 == 99:
            for name in served.network.boards:
                served.switch(name, True)

    rounds(served, count, one)
    folder.cleanup()
    for client, (_, theirs) in zip(clients, pairs, strict=True):
        client.close()
        theirs.close()
    return found


def serial(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Raw TCP of a serial line: bytes, clients that hang up, that reset, that never read."""
    for base in range(20_000 + 10 * random.randrange(1000), 32_000, 10):  # below the ports of clients
        door = TcpDoor(str(base), served)
        with suppress(OSError):
            door.open()
            break
    found = {"accepted": 0, "hung up": 0}
    clients: list[socket.socket] = []

    def one(_number: int) -> None:
        while len(clients) < 8:
            clients.append(socket.create_connection(("127.0.0.1", base + random.randrange(5)), 10))
        client = random.choice(clients)
        try:
            client.sendall(inputs.data(random, 64))
            found["accepted"] += 1
        except OSError:
            found["hung up"] += 1
        if random.random() < 0.02:
            if random.random() < 0.5:  # a reset instead of a farewell
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
            clients.remove(client)
            client.close()
        door.poll(served.now_ns)

    rounds(served, count, one)
    for client in clients:
        client.close()
    door.close()
    return found


def scenarios(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Scenario files."""
    found = {"accepted": 0, "refused": 0}
    with tempfile.TemporaryDirectory(dir=inputs.MEMORY) as folder:
        file = Path(folder) / "x.yaml"
        for _ in counted(count):
            file.write_bytes(inputs.scenario(random).encode("utf-8", "surrogatepass"))
            try:
                load(file)
                found["accepted"] += 1
            except ScenarioError:
                found["refused"] += 1
    return found


DOORS: dict[str, Callable[[LiveNetwork, int, Random], dict[str, int]]] = {
    "frames": frames, "datagrams": datagrams, "hid": hid, "control": control, "steps": steps,
    "serial": serial, "scenarios": scenarios, "lx200": lx200, "alpaca": alpaca,
}  # fmt: skip


ALONE: dict[str, Callable[[int, Random], dict[str, int]]] = {
    "packets": streams.packets, "debug": streams.debug, "slcan": streams.slcan, "spi": chips.spi,
    "endat": chips.endat, "endat-edges": chips.edges, "endat-bits": chips.bits,
    "candump": files.candump, "axis-logs": files.axis_logs, "guide-logs": files.guide_logs,
    "snapshots": frozen.snapshots, "websocket": browser.websocket,
    "canopen": canopen,
}  # fmt: skip
"""What is attacked without a network around it, or with one of its own."""


def attack_apart(door: str, count: int, seed: int = 1) -> dict[str, int]:
    """The same in a process of its own, plain: NiceGUI starts once in a process, and only in a quiet one."""
    words = ["--door", door, "--inputs", str(count), "--seed", str(seed)]
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz", *words], cwd=ROOT, env={**os.environ, "SCHMIDT_PURE": "1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    found: dict[str, int] = ast.literal_eval(done.stdout.rpartition("; ")[2])
    return found


def attack(door: str, count: int, seed: int = 1) -> dict[str, int]:
    """`count` inputs at one door, of a fresh network where it needs one; what became of them."""
    if door == "snapshots" and compiled():  # which none can be taken of
        return attack_apart(door, count, seed)
    if door in ALONE:
        return ALONE[door](count, Random(seed))
    return DOORS[door](LiveNetwork(*chosen()), count, Random(seed))
