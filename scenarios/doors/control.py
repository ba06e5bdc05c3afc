"""`--control [HOST:]PORT`: speed, pause, state and end of a served network, one line of text each.

    status | speed X | pause | resume | power BOARD on|off | stop | help

    fault list | fault kinds | fault start NAME argument=value ... | fault clear NUMBER
    snapshot [NAME]

With `--clock steps` also the lines of `scenarios.doors.steps`, in the place of speed, pause and resume.

A client of this machine just asks; any other must say `token WORD` first. Answers begin with `ok` or `error`.
"""

import hmac
import json
import os
import secrets

from bus.outside.pacer import Punctuality
from scenarios.doors.clients import Client, Clients, address, is_local, listen
from scenarios.doors.door import counted
from scenarios.doors.livenetwork import USAGE, LiveNetwork

_LINE_LIMIT = 1000  # Longer lines are nobody's command.
_LINES_PER_POLL = 8
STEPPING, _PACING = ("join", "listen", "send", "step"), ("speed", "pause", "resume")
TOKEN_VARIABLE = "SCHMIDT_TOKEN"
_USAGE = {
    "status": "status", "speed": "speed X, a number, for example speed 2", "pause": "pause",
    "resume": "resume", **USAGE, "late": "late", "snapshot": "snapshot [NAME]", "stop": "stop",
    "help": "help",
}  # fmt: skip


def _ticks(punctual: Punctuality) -> dict[str, float | None]:
    """Of the 5 ms ticks so far: share within 1 ms of due, and how late 99.9 % and all were at most."""
    if not punctual.ticks:
        return {"ticks": 0, "on_time": None, "late_999_ms": None, "worst_ms": None}
    return {
        "ticks": punctual.ticks,
        "on_time": punctual.on_time,
        "late_999_ms": punctual.quantile_s(0.999) * 1e3,
        "worst_ms": punctual.worst_s * 1e3,
    }


class ControlDoor:
    """The control plane. token: for clients of other machines; made up when none is given."""

    def __init__(self, where: str, token: str | None, served: LiveNetwork) -> None:
        self.host, self.port = address(where, "--control")
        self._served = served
        self.token = token or os.environ.get(TOKEN_VARIABLE) or secrets.token_urlsafe(16)
        self.name = f"--control {where}"
        if not is_local(self.host):
            self.name += f" (token {self.token})" if token is None else " (with your token)"
        self._clients = Clients()
        self._rest: dict[Client, bytes] = {}
        self._trusted: set[Client] = set()
        self.refused = 0

    def open(self) -> None:
        """Listen; raises OSError."""
        self._clients.listen(listen(self.host, self.port))

    def poll(self, _now_ns: int) -> None:
        """Take commands and answer them."""
        for client in self._clients.accept():
            self._rest[client] = b""
            if is_local(client.peer):
                self._trusted.add(client)
        for client in self._clients.all:
            self._listen_to(client)
            if client.gone:
                self._forget(client)
        self._clients.sweep()

    def _listen_to(self, client: Client) -> None:
        *lines, rest = (self._rest[client] + client.receive()).split(b"\n")
        if len(rest) > _LINE_LIMIT or any(len(line) > _LINE_LIMIT for line in lines):
            client.send(b"error: a command is one short line\n")
            client.gone = True
            return
        taken = 0
        while taken < min(len(lines), _LINES_PER_POLL) and not self._waits(client):
            answer = self._answer(client, lines[taken])
            taken += 1
            if answer is not None:
                client.send((answer + "\n").encode())
        self._rest[client] = b"".join(each + b"\n" for each in lines[taken:]) + rest

    def _waits(self, client: Client) -> bool:
        steps = self._served.steps
        return steps is not None and steps.waits(client)

    def wait(self, timeout_s: float) -> None:
        """Until there is something to do, or wall time is over."""
        more = any(b"\n" in rest and not self._waits(client) for client, rest in self._rest.items())
        if not more:
            self._clients.wait(timeout_s)

    def _answer(self, client: Client, line: bytes) -> str | None:
        words = line.decode("utf-8", "replace").split()
        if not words:
            return "error: nothing said; try help"
        if words[0] == "token":
            return self._check(client, words[1:])
        if client not in self._trusted:
            self.refused += 1
            return "error: this needs a token: token WORD"
        steps = self._served.steps
        try:
            if words[0] in STEPPING or (steps is not None and words[0] in _PACING):
                if steps is None or words[0] in _PACING:
                    how = "paced" if steps is None else "stepped"
                    raise ValueError(f"{words[0]}: time is {how} here (schmidt serve --clock)")
                return steps.take(client, words)
            return "ok " + self._done(words)
        except ValueError as error:
            return f"error: {' '.join(str(error).split())}"

    def _check(self, client: Client, words: list[str]) -> str:
        if len(words) == 1 and hmac.compare_digest(words[0].encode(), self.token.encode()):
            self._trusted.add(client)
            return "ok"
        self.refused += 1
        client.gone = True
        return "error: wrong token"

    def _done(self, words: list[str]) -> str:
        """Carry a command out; its answer. Raises ValueError with one line."""
        served = self._served
        match words:
            case ["status"]:
                return self._status()
            case ["speed", text]:
                try:
                    speed = float(text)
                except ValueError:
                    raise ValueError(_USAGE["speed"]) from None
                served.pacer.speed = speed
                return f"speed {speed:g}"
            case ["pause" | "resume"]:
                served.pacer.paused = words[0] == "pause"
                return "paused" if served.pacer.paused else "running"
            case ["fault", "list"]:
                return json.dumps([vars(each) for each in served.faults.running])
            case ["fault", "kinds"]:
                return ", ".join(kind.name for kind in served.faults.kinds())
            case ["power" | "fault", *_]:
                return served.command(words)
            case ["late"]:  # when the last late ticks were due, s on the monotonic clock, and how late, ms
                return json.dumps([(due_s, late_s * 1e3) for due_s, late_s in served.punctual.late])
            case ["snapshot", *name] if len(name) < 2:
                if served.snapshot is None:
                    raise ValueError("this session takes no snapshots: schmidt serve --snapshots DIR does")
                return served.snapshot(*name or [""])
            case ["stop"]:
                served.stop()
                return "ending"
            case ["help"]:
                steps = "with --clock steps: join N [NAME] | listen | send ID#DATA | step 5ms"
                return f"{' | '.join(_USAGE.values())}; {steps}"
        if words[0] in _USAGE:
            raise ValueError(_USAGE[words[0]])
        raise ValueError(f"no command {words[0][:40]!r}; use one of {', '.join(_USAGE)}")

    def _status(self) -> str:
        served = self._served
        pacer, wire = served.pacer, served.network.wire
        return json.dumps(
            {
                "simulated_s": served.now_ns * 1e-9,
                "speed": pacer.speed,
                "paused": pacer.paused,
                "late_ms": pacer.lateness_s * 1e3,
                "slips": pacer.slips,
                **_ticks(served.punctual),
                "bus_load": wire.load,
                "frames": wire.frames,
                "boards": {name: board.on for name, board in served.network.boards.items()},
            }
        )

    def _forget(self, client: Client) -> None:
        if self._served.steps is not None:
            self._served.steps.leave(client)
        self._rest.pop(client, None)
        self._trusted.discard(client)

    def close(self) -> None:
        """Hang up and stop listening."""
        self._clients.close()
        self._rest.clear()
        self._trusted.clear()

    def state(self) -> str:
        """How many came."""
        return counted((self._clients.came, "clients"), (self.refused, "refused for want of a token"))
