"""A random client at a served network: `python -m tests.doors.soak [--minutes 30] [--speed 50]`.

It commands boards over the gateway's socket and the telescope over LX200, hangs up and comes back, pauses
and resumes. Afterwards the session's own logs are held against what it was told.
"""

import argparse
import os
import re
import socket
import tempfile
import time
from collections import Counter
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from queue import Empty, SimpleQueue
from random import Random
from threading import Thread

from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE, Device, Opcode, Result
from bus.protocol.heartbeat import Reply, unpack_reply
from bus.protocol.report import SLOTS, pack_report
from tests.doors.process import Serving
from tests.ports import free_ports

AXES = (Device.AXIS_RA, Device.AXIS_DEC)
TABLE = [16 + 3 * line + part for line in range(8) for part in (1, 2)]
"""Efforts of the compensation table: parameters that do nothing while the compensation is off."""
WARM_SHARE = 0.2
"""Of the whole time, before the memory is held against: buffers and row groups fill."""
_ANSWER_S = 20.0
"""Wall time without any reply at all until one counts as missing."""


class Gateway:
    """The host's end of the USB cable. A thread reads: who does not loses reports, as from a real device."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.connect()

    def connect(self) -> None:
        """A new program on the socket."""
        self._replies: SimpleQueue[bytes] = SimpleQueue()
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.connect(str(self._path))
        self._thread = Thread(target=self._read, args=(self._socket, self._replies), daemon=True)
        self._thread.start()

    @staticmethod
    def _read(connection: socket.socket, replies: SimpleQueue[bytes]) -> None:
        while report := connection.recv(64):
            for at in range(0, SLOTS * 8, 8):
                if report[at] > 0x80 and report[at + 1] < 0x80:
                    replies.put(bytes([report[at] & 0x7F]) + report[at + 1 : at + 8])

    def close(self) -> None:
        """The program ends."""
        self._socket.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._socket.close()

    def ask(self, commands: list[bytes]) -> list[Reply | None]:
        """Send them in one report; the answers in the same order, None where there was none."""
        while not self._replies.empty():
            self._replies.get()  # those of other programs
        self._socket.send(pack_report(commands))
        wanted = [data[:2] for data in commands]
        found: list[Reply | None] = [None] * len(commands)
        with suppress(Empty):
            while None in found:
                data = self._replies.get(timeout=_ANSWER_S)
                if data[:2] in wanted and found[wanted.index(data[:2])] is None:
                    found[wanted.index(data[:2])] = unpack_reply(data)
        return found


class Lx200:
    """One LX200 client over TCP."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), 60)

    def close(self) -> None:
        """Hang up."""
        self._socket.close()

    def say(self, command: str) -> None:
        """A command without an answer."""
        self._socket.sendall(f":{command}#".encode())

    def one(self, command: str) -> str:
        """A command answered by a character; the text after a refusal is read too."""
        self.say(command)
        first = self._socket.recv(1)
        if command == "MS" and first != b"0":
            while not first.endswith(b"#"):
                first += self._socket.recv(1)
        return first.decode("latin-1")

    def text(self, command: str) -> str:
        """A command answered up to `#`."""
        self.say(command)
        said = b""
        while not said.endswith(b"#"):
            got = self._socket.recv(1)
            assert got, "hung up"
            said += got
        return said.decode("latin-1")[:-1]


class Soak:
    """The client's side; what was acknowledged is kept."""

    def __init__(self, server: Serving, gateway: Gateway, lx200: Lx200, seed: int) -> None:
        self.server, self.gateway, self.lx200 = server, gateway, lx200
        self.random = Random(seed)
        self.acknowledged: Counter[bytes] = Counter()
        self.table: dict[tuple[int, int], int] = {}
        self.asked = self.unanswered = self.refused = self.slews = self.hang_ups = 0
        self.lost: list[str] = []
        self.memory: list[tuple[float, float]] = []
        """(simulated s, MiB) of the emulator with its host."""

    def command(self) -> bytes:
        """One for a random board."""
        from bus.protocol import pack_command

        random = self.random
        axis = random.choice(AXES)
        number = random.choice(TABLE)
        return random.choice((
            lambda: pack_command(axis, Opcode.SET_PARAMETER, number, random.randrange(-2000, 2001)),
            lambda: pack_command(axis, Opcode.GET_PARAMETER, number),
            lambda: pack_command(axis, Opcode.SET_PARAMETER, 1, random.randrange(60)),
            lambda: pack_command(random.choice(list(Device)), Opcode.PING),
            lambda: pack_command(Device.FOCUS, Opcode.FOCUS_STEP, random.randrange(-128, 128)),
            lambda: pack_command(Device.FOCUS, Opcode.FOCUS_MOVE_TO, random.randrange(-1000, 1000)),
            lambda: pack_command(Device.FOCUS, random.choice((Opcode.FOCUS_HOLD, Opcode.FOCUS_REFERENCE))),
            lambda: pack_command(Device.DISPLAY, Opcode.BRIGHTNESS, random.randrange(120)),
        ))()  # fmt: skip

    def boards(self) -> None:
        """A report of commands, no two with the same answer."""
        commands: dict[tuple[int, int], bytes] = {}
        for _ in range(self.random.randrange(1, SLOTS + 1)):
            made = self.command()
            commands.setdefault((made[0], made[1]), made)
        sent = list(commands.values())
        self.asked += len(sent)
        for data, reply in zip(sent, self.gateway.ask(sent), strict=True):
            if reply is None:
                self.unanswered += 1
                self.lost.append(f"no answer to {data.hex()}")
                continue
            if data[0] != Device.GATEWAY:  # answers over USB, its commands are not on the wire
                self.acknowledged[data] += 1
            self._remember(data, reply)

    def _remember(self, data: bytes, reply: Reply) -> None:
        key, value = (data[0], data[2]), int.from_bytes(data[3:7], "little", signed=True)
        if reply.result != Result.OK:
            self.refused += 1
        elif data[1] == Opcode.SET_PARAMETER:
            self.table[key] = value
        elif data[1] == Opcode.GET_PARAMETER and reply.value != self.table.get(key, reply.value):
            self.lost.append(f"{key}: set to {self.table[key]}, read {reply.value}")

    def telescope(self) -> None:
        """A word to LX200; what was set is read back, a slew that was taken is counted."""
        random, lx200 = self.random, self.lx200
        act = random.randrange(6)
        if act == 0:
            hours, minutes, seconds = map(int, lx200.text("GS").split(":"))
            ra = (hours * 3600 + minutes * 60 + seconds + random.randrange(-7200, 7200)) % 86400
            text = f"{ra // 3600:02d}:{ra // 60 % 60:02d}:{ra % 60:02d}"
            dec = f"{random.randrange(5, 50):+03d}*{random.randrange(60):02d}:00"
            taken = lx200.one(f"Sr{text}") + lx200.one(f"Sd{dec}")
            if taken != "11" or lx200.text("Gr") != text:
                self.lost.append(f"target {text} {dec}: {taken}, read {lx200.text('Gr')}")
            self.slews += lx200.one("MS") == "0"
        elif act == 1:
            direction = random.choice("nsew")
            lx200.say("R" + random.choice("GCMS"))
            lx200.say("M" + direction)
            lx200.say("Q" + direction)
        elif act == 2:
            lx200.say("Q")
        else:
            lx200.text(random.choice(("GR", "GD", "GA", "GZ", "D")))

    def trouble(self, number: int) -> None:
        """Programs that end and come back; a pause."""
        if number % 40 == 13:
            self.gateway.close()
            self.gateway.connect()
            self.hang_ups += 1
        if number % 100 == 57:
            self.server.ask("pause")
            self.server.ask("resume")

    def run(self, until_s: float) -> None:
        """Until this simulated time; the memory is looked at a hundred times on the way."""
        number, next_s = 0, 0.0
        while True:
            self.boards()
            self.telescope()
            self.trouble(number)
            number += 1
            if number % 5 == 0:
                now_s = self.server.status()["simulated_s"]
                if now_s >= next_s:
                    self.memory.append((now_s, resident_mib(self.server.process.pid)))
                    next_s = now_s + until_s / 100
                if now_s >= until_s:
                    return


def resident_mib(pid: int) -> float:
    """Resident sets of a process and of those it has started, MiB: the host has a process of its own."""
    return sum(_pages(each) for each in (pid, *_children(pid))) * os.sysconf("SC_PAGE_SIZE") / 2**20


def _pages(pid: int) -> int:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1])


def _children(pid: int) -> list[int]:
    found = []
    for each in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has just ended
            if int(each.read_text().rpartition(")")[2].split()[1]) == pid:
                found.append(int(each.parent.name))
    return found


def growth(memory: list[tuple[float, float]]) -> float:
    """Largest over smallest resident set after the warm-up, less one."""
    end_s = memory[-1][0]
    warm = [mib for t_s, mib in memory if t_s >= WARM_SHARE * end_s]
    return max(warm) / min(warm) - 1


def check_logs(folder: Path, soak: Soak) -> dict[str, float]:
    """Holds the session's logs against what was acknowledged; raises AssertionError. Returns figures."""
    commands: Counter[bytes] = Counter()
    counts: Counter[int] = Counter()
    last: dict[int, int] = {}
    lines, gaps, t_s = 0, 0, 0.0
    positions = (MEASUREMENT_BASE + Device.POSITION_RA, MEASUREMENT_BASE + Device.POSITION_DEC)
    with (folder / "record" / "can.log").open() as file:
        for line in file:
            stamp, _, said = line.split()
            number, _, text = said.partition("#")
            identifier = int(number, 16)
            before_s, t_s = t_s, float(stamp[1:-1])
            assert t_s > before_s, "frames end one after the other"
            lines += 1
            counts[identifier] += 1
            if COMMAND_BASE <= identifier < REPLY_BASE:
                commands[bytes.fromhex(text)] += 1
            elif identifier in positions:
                sequence = int(text[-2:], 16)
                gaps += identifier in last and sequence != (last[identifier] + 1) % 256
                last[identifier] = sequence
    missing = soak.acknowledged - commands
    assert not missing, f"acknowledged, and never on the wire: {missing}"
    for device in Device:
        asked, answers = counts[COMMAND_BASE + device], counts[REPLY_BASE + device]
        if device is not Device.GATEWAY:  # its own commands come over USB, not over the wire
            assert asked == answers, f"{device.name}: {asked} commands, {answers} replies"
    assert gaps == 0, f"{gaps} position frames are missing"
    rows = _axis_rows(folder / "record")
    slews = (folder / "logs" / "status.log").read_text().count("  slew to ")
    assert slews == soak.slews, f"{soak.slews} slews were taken, {slews} are in the log"
    return {"frames": lines, "axis rows": rows, "slews": slews, "end_s": t_s}


def _axis_rows(folder: Path) -> int:
    """Rows of both axis logs, one every 10 ms without a gap."""
    count = 0
    for name in ("ra", "dec"):
        with (folder / f"axis-{name}.csv").open() as file:
            times = [float(line.split(",", 1)[0]) for line in file if line[0].isdigit()]
        worst = max(b - a for a, b in pairwise(times))
        assert worst < 0.0101, f"{name}: a gap of {worst} s"
        count += len(times)
    return count


def soak(folder: Path, minutes: float, speed: float, seed: int = 1) -> tuple[Soak, str]:
    """Serve, command, end, check; the client and a line of figures."""
    port = free_ports()
    words = ("--hid", f"unix:{folder}/gateway", "--lx200", str(port), "--speed", str(speed),
             "--record", str(folder / "record"), "--logs", str(folder / "logs"))  # fmt: skip
    start_s = time.monotonic()
    with Serving(folder, "scenarios/observing-night.yaml", *words) as server:
        gateway, lx200 = Gateway(folder / "gateway"), Lx200(port)
        made = Soak(server, gateway, lx200, seed)
        try:
            made.run(minutes * 60)
        finally:
            gateway.close()
            lx200.close()
        wall_s = time.monotonic() - start_s
        said = server.end()
    assert server.process.returncode == 0, said
    found = check_logs(folder, made)
    assert re.search(r"digest [0-9a-f]{16}", said), said
    low, high = (pick(mib for _, mib in made.memory) for pick in (min, max))
    return made, (
        f"{found['end_s'] / 60:.1f} emulated minutes at {found['end_s'] / wall_s:.1f} times real time:"
        f" {made.asked} commands over USB, {made.asked - made.unanswered} acknowledged ({made.refused} of"
        f" them as wrong), {made.slews} slews over LX200, {made.hang_ups} hang-ups; lost: {len(made.lost)};"
        f" {found['frames']:.0f} frames and {found['axis rows']:.0f} rows logged without a gap;"
        f" {low:.0f} to {high:.0f} MiB with the host, {growth(made.memory):+.1%} after the first"
        f" {WARM_SHARE:.0%}; system load {os.getloadavg()[0]:.1f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--speed", type=float, default=50.0)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        made, text = soak(Path(folder), asked.minutes, asked.speed, asked.seed)
    for each in made.lost[:10]:
        print(each)
    print(text)


if __name__ == "__main__":
    main()
