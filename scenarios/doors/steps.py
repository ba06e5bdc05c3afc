"""`--clock steps`: simulated time stands until every client that has joined has stepped it.

On the control door, one line each way:

    join N [NAME]     `ok` when N clients have joined; names put their frames in order, whoever came first.
    listen            from now on every frame of the bus comes before a step's `ok`, as candump -L has it.
    send 011#1105     a frame in candump's form; it enters with the next step.
    step 5ms          `ok 5000000`: the time, ns, when all that was due by then is out at every door.

Input comes in when everybody has stepped, so a run depends on what was said and not on when.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

from bus.can import Frame
from bus.can.candump import line
from host.client import TICK_NS
from scenarios.doors.clients import LIMIT, Client
from scenarios.doors.livenetwork import LiveNetwork, frame_of
from scenarios.language.units import parse

_LOOK_S = 0.05  # Wall time after which a signal is noticed while time stands.
NODE = 99
"""Of the clients' frames on the wire; beyond any number of `--can` doors."""


@lru_cache(maxsize=64)  # a host steps by the same span for hours
def _span_ns(text: str) -> int:
    span_ns = round(parse(text, "time") * 1e9)
    if span_ns < 0:
        raise ValueError("time does not go back")
    return span_ns


@dataclass
class _Member:
    """A client. wanted: clients it waits for; goal_ns: time it waits for; heard: None: it does not listen."""

    name: str
    wanted: int = 0
    goal_ns: int | None = None
    sent: list[Frame] = field(default_factory=list)
    heard: list[str] | None = None


class Steps:
    """Who has joined, and how far time may go."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._members: dict[Client, _Member] = {}
        self._tapped = False
        served.node(NODE)
        served.pacer.paused = True
        served.punctual.counting = False

    def waits(self, client: Client) -> bool:
        """Whether a client's answer is still to come: its next line is not looked at before."""
        member = self._members.get(client)
        return member is not None and (member.goal_ns is not None or member.wanted > 0)

    def take(self, client: Client, words: list[str]) -> str | None:
        """A line; its answer, None: later. Raises ValueError with one line."""
        match words:
            case ["join", number, *name] if number.isdecimal() and len(name) <= 1:
                if not 1 <= int(number) <= LIMIT:  # nobody would ever be answered
                    raise ValueError(f"join N: 1 to {LIMIT} clients")
                self._member(client, *name).wanted = int(number)
                return None
            case ["listen"]:
                self._member(client).heard = []
                if not self._tapped:
                    self._served.network.wire.tap(self._hear)
                    self._tapped = True
                return "ok"
            case ["send", text]:
                self._member(client).sent.append(frame_of(text))
                return "ok"
            case ["step", *span] if span:
                self._member(client).goal_ns = self._served.now_ns + _span_ns(" ".join(span))
                return None
        raise ValueError("join N [NAME] | listen | send ID#DATA | step 5ms")

    def _member(self, client: Client, name: str = "") -> _Member:
        member = self._members.get(client)
        if name and any(each.name == name for each in self._members.values() if each is not member):
            raise ValueError(f"there is a client {name} already")
        if member is None:
            member = self._members[client] = _Member(name)
        member.name = name or member.name or f"~{len(self._members):04}"  # those without a name come last
        return member

    def leave(self, client: Client) -> None:
        """It waits for nothing any more, and nobody waits for it."""
        self._members.pop(client, None)

    def goal_ns(self) -> int | None:
        """How far time may go; None: somebody has not stepped yet. Answers those who waited for others."""
        for client, member in self._members.items():
            if 0 < member.wanted <= len(self._members):
                member.wanted = 0
                client.deliver(b"ok\n")
        goals = [member.goal_ns for member in self._members.values()]
        known = [goal for goal in goals if goal is not None]
        return min(known) if known and len(known) == len(goals) else None

    def run(self, look: Callable[[], bool], wait: Callable[[float], bool]) -> None:
        """Until somebody ends it. look: at all other doors, takes what is there and hands out what happened;
        wait: for words at the control door, wall time s. Both return True when it is over."""
        served = self._served
        while True:
            goal_ns = self.goal_ns()
            if goal_ns is None:
                if wait(_LOOK_S):
                    return
                continue
            over = self._settle(look)
            while served.now_ns < goal_ns and not over:
                served.entry.running = True
                served.run_until(min(goal_ns, served.now_ns // TICK_NS * TICK_NS + TICK_NS))
                over = self._settle(look) or (served.now_ns < goal_ns and wait(0.0))
            if over:
                return
            self._answer()

    def _settle(self, look: Callable[[], bool]) -> bool:
        """Everything that was sent by now has come in, doors first."""
        served, before = self._served, -1
        over = False
        while before != served.entry.count and not over:
            before = served.entry.count
            over = look()
        served.entry.running = False
        for member in sorted(self._members.values(), key=lambda each: each.name):
            for frame in member.sent:
                served.frame(NODE, frame)
            member.sent.clear()
        return over

    def _answer(self) -> None:
        now_ns = self._served.now_ns
        for client, member in self._members.items():
            if member.goal_ns is not None and member.goal_ns <= now_ns:
                member.goal_ns = None
                client.deliver("".join([*(member.heard or ()), f"ok {now_ns}\n"]).encode())
                if member.heard:
                    member.heard.clear()

    def _hear(self, t_ns: int, frame: Frame, _sender: str) -> None:
        text = line(t_ns, frame) + "\n"
        for member in self._members.values():
            if member.heard is not None:
                member.heard.append(text)
