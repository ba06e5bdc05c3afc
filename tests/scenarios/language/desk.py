"""A host without a telescope: it notes what it is asked, and time is what the test says."""

from collections.abc import Generator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from bus.protocol import Device, Focus, Motion, Opcode, Reply
from host.client import Client, ClientError
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.model import Scenario
from scenarios.language.programme import Programme

HEAD = "name: x\nstart_utc: 2026-02-10T14:00:00Z\nsteps:\n"


def scenario(*steps: str) -> Scenario:
    """These steps, one a line."""
    return convert(parse(HEAD + "".join(f"  - {{{each}}}\n" for each in steps), Path("night.yaml")))


class Notes:
    """Logs that are kept in lists."""

    def __init__(self) -> None:
        self.said: list[str] = []
        self.errors: list[str] = []

    def status(self, t_ns: int, source: str, text: str) -> None:
        self.said.append(f"{t_ns * 1e-9:g} {source} {text}")

    def error(self, t_ns: int, source: str, text: str) -> None:
        self.errors.append(f"{t_ns * 1e-9:g} {source} {text}")


class Desk(Client):
    """Every command is taken at once; boards say what the test has put there."""

    def __init__(self, *devices: Device) -> None:
        link: Any = SimpleNamespace(on_reply=None)
        notes: Any = Notes()
        super().__init__(link, notes, devices or tuple(Device))
        self.asked: list[tuple[Any, ...]] = []
        self.motions: dict[Device, Any] = {}
        self.place: Any = None
        self.refuses = False

    def ask(self, device: Device, opcode: Opcode, *arguments: int) -> Generator[None, None, Reply]:
        self.asked.append((device, opcode, *arguments))
        if self.refuses:
            raise ClientError("no")
        yield
        answer: Any = SimpleNamespace(value=arguments[-1] if arguments else 0)
        return answer  # type: ignore[no-any-return]

    def motion(self, device: Device) -> Motion | None:
        return self.motions.get(device)

    def focus(self) -> Focus | None:
        return self.place  # type: ignore[no-any-return]


class Night:
    """A programme and its desk, a second a tick."""

    def __init__(self, *steps: str, desk: Desk | None = None) -> None:
        self.desk = desk or Desk()
        logs: Any = self.desk.logs
        eye: Any = object()
        self.logs: Any = logs
        self.eye: Any = eye
        self.programme = Programme(scenario(*steps), self.desk, logs, eye)
        self.second = -1

    def run(self, until_s: int) -> "Night":
        """Tick up to this second and with it."""
        for second in range(self.second + 1, until_s + 1):
            self.desk.now_ns = second * 10**9
            self.programme.tick(self.desk.now_ns)
        self.second = until_s
        return self

    @property
    def times(self) -> list[Any]:
        """When each step has started and ended, whole seconds."""
        return [
            tuple(None if each is None else round(each, 6) for each in (record.start_s, record.end_s))
            for record in self.programme.records
        ]
