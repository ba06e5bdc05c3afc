"""A page on paper: built without a server, over a telescope that only writes down what it is told."""

import asyncio
import datetime as dt
import math
from collections import deque
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from types import SimpleNamespace as Some
from typing import Any

from nicegui import Client, background_tasks, core, ui
from nicegui.app.app import State
from starlette.requests import Request

from bus.protocol import AxisMode
from host.console.live import Live
from host.console.shell import Shell
from host.console.views import BusState, FaultKind
from host.logs.journal import Journal
from host.sky.mount import limits_mount
from host.sky.observed import Clock
from host.sky.site import NAINITAL
from host.sky.visibility import Observatory
from host.telescope.state import AxisState, Snapshot

NIGHT = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))
ZERO_STEPS = 1 << 28
"""Of both encoders at hour angle and declination nought."""


def axis(**fields: Any) -> AxisState:
    """An axis that stands still at its encoder's zero."""
    usual: dict[str, Any] = {
        "steps": ZERO_STEPS, "latched_s": 10.0, "mode": AxisMode.OFF, "powered": False, "moving": False,
        "soft_limit": False, "fault": False, "rate_arcsec_s": 0.0, "effort": 0.0, "currents_a": (0.0, 0.0),
        "motor_turns_s": (None, None), "to_go_arcsec": 0.0,
    }  # fmt: skip
    return AxisState(**usual | fields)


def snapshot(**fields: Any) -> Snapshot:
    """A telescope that rests with its motors off."""
    usual: dict[str, Any] = {
        "t_s": 10.0, "ra": axis(), "dec": axis(), "focus": None, "boards": (), "activity": "idle",
        "powered": False, "slewing": False, "tracking": False, "parked": False, "pulse_guiding": False,
        "target": "", "errors_arcsec": None, "locked": False, "stale": frozenset(),
    }  # fmt: skip
    return Snapshot(**usual | fields)


class Hand:
    """Whatever is called on it is written down by its dotted name; answers: what a name gives back."""

    def __init__(self, told: list[tuple[Any, ...]], answers: dict[str, Any], name: str) -> None:
        self._told, self._answers, self._name = told, answers, name

    def __getattr__(self, name: str) -> "Hand":
        return Hand(self._told, self._answers, f"{self._name}.{name}")

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        self._told.append((self._name, *arguments, *named.items()))
        answer = self._answers.get(self._name)
        if isinstance(answer, Exception):
            raise answer
        return answer


class House:
    """Dome, weather and power as a test wants them. said: readings by board."""

    def __init__(self, told: list[tuple[Any, ...]]) -> None:
        self.said: dict[str, dict[str, float]] = {}
        self.old: set[str] = set()
        self.causes: list[str] = []
        self.slaved = False
        self.hand = Hand(told, {}, "house")

    def boards(self, kind: Any) -> list[str]:
        return [name for name in self.said if name in kind.nodes]

    expected = boards

    def reading(self, board: str) -> dict[str, float] | None:
        return self.said.get(board)

    def stale(self, board: str) -> bool:
        return board in self.old

    def unsafe(self) -> list[str]:
        return self.causes

    def __getattr__(self, name: str) -> Any:
        return getattr(self.hand, name)


class PaperTelescope:
    """It takes commands at once. told: (dotted name, arguments)."""

    def __init__(self) -> None:
        self.told: list[tuple[Any, ...]] = []
        self.answers: dict[str, Any] = {}
        self.snapshot = snapshot()
        mount = limits_mount(math.radians(80), math.radians(-45), math.radians(85), NAINITAL.latitude_rad)
        self.observatory = Observatory(NAINITAL, NIGHT, mount)
        self.journal = Journal(None)
        self.house = House(self.told)
        self.client = Some(link=Some(measurements={}))
        self.aimed: Any = None
        self.goal: Any = None
        self.locked = False
        for name in ("drive", "paddle", "focuser", "boards", "emergency_stop"):
            setattr(self, name, Hand(self.told, self.answers, name))

    def aim(self) -> Any:
        return self.aimed

    def target(self) -> Any:
        return self.goal

    def call(self, act: Callable[[Any], Any], urgent: bool = False) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(act(self))
        except Exception as error:
            future.set_exception(error)
        self.snapshot = self.snapshot._replace(locked=self.locked)
        return future


class PaperBus:
    """A bus view that writes wishes down."""

    def __init__(self) -> None:
        self.boards: tuple[str, ...] = ()
        self.kinds: list[FaultKind] = []
        self.state = BusState([], 0.0, {}, [], [])
        self.wishes: list[str] = []
        self.answer: str | Exception | None = "done"

    def look(self) -> BusState:
        return self.state

    def wish(self, command: str) -> Future[str]:
        self.wishes.append(command)
        future: Future[str] = Future()
        if isinstance(self.answer, Exception):
            future.set_exception(self.answer)
        elif self.answer is not None:
            future.set_result(self.answer)
        return future


class Page:
    """One page of one browser; everything within `on_paper`."""

    def __init__(self, telescope: PaperTelescope, bus: PaperBus, cookie: str) -> None:
        self.telescope, self.bus = telescope, bus
        self.live = Live(telescope, bus)  # type: ignore[arg-type]
        asked = {
            "type": "http",
            "path": "/paper",
            "query_string": b"",
            "headers": [(b"cookie", cookie.encode())],
        }
        self.client = Client(ui.page("/paper"), request=Request(asked))
        self.shell: Shell
        self.scripts: list[str] = []

    def build(self, builder: Callable[..., object], *more: Any) -> "Page":
        with self.client:
            self.shell = Shell(self.live)
            builder(self.shell, *more)
        return self

    def every(self, kind: type[Any]) -> list[Any]:
        return [each for each in self.client.elements.values() if isinstance(each, kind)]

    def texts(self) -> list[str]:
        return [each.text for each in self.every(ui.label)]

    def tables(self) -> list[list[list[str]]]:
        """Rows of every plain table, its head first."""
        return [rows(each.content) for each in self.every(ui.html) if "<table" in each.content]

    def labelled(self, label: str) -> Any:
        """A field by its label, or what has it as aria-label."""
        found = [
            each
            for each in self.client.elements.values()
            if label in (each.props.get("label"), each.props.get("aria-label"))
        ]
        assert len(found) == 1, (label, found)
        return found[0]

    def button(self, text: str) -> Any:
        found = [each for each in self.every(ui.button) if each.text == text]
        assert len(found) == 1, (text, [each.text for each in self.every(ui.button)])
        return found[0]

    def tick(self, times: int = 1) -> None:
        """What a browser sees four times a second."""
        with self.client:
            for _ in range(times):
                self.shell._tick()

    async def fire(self, element: Any, kind: str, argument: Any = None) -> None:
        """An event of a browser, and what it sets off."""
        listeners = [each for each in element._event_listeners.values() if each.type == kind]
        assert listeners, (kind, [each.type for each in element._event_listeners.values()])
        for each in listeners:
            element._handle_event({"listener_id": each.id, "args": argument})
        await self.settle()

    async def press(self, text: str) -> None:
        await self.fire(self.button(text), "click", {})

    async def settle(self) -> None:
        for _ in range(20):
            await asyncio.sleep(0)

    async def later(self) -> None:
        """Also what a timer of no time sets off."""
        await self.settle()
        await asyncio.sleep(0.002)
        await self.settle()

    @property
    def said(self) -> str:
        """The last answer, without the time before it."""
        return str(self.shell._said.text.partition(" s: ")[2])


def rows(content: str) -> list[list[str]]:
    """Cells of a plain table."""
    found = []
    for row in content.split("<tr>")[1:]:
        cells = row.replace('<th scope="col">', "<td>").replace("</th>", "</td>").split("<td>")[1:]
        found.append([cell.partition("</td>")[0] for cell in cells])
    return found


def on_paper(work: Callable[[Page], Coroutine[Any, Any, None]], cookie: str = "") -> None:
    """Do this with a page in a loop of its own; NiceGUI's own is as it was after it."""

    async def body() -> None:
        before, core.loop = (core.loop, core.app._state), asyncio.get_running_loop()
        core.app._state = State.STARTED
        page = Page(PaperTelescope(), PaperBus(), cookie)
        try:
            await work(page)
        finally:
            for task in list(background_tasks.running_tasks):
                task.cancel()
            page.client.delete()
            core.loop, core.app._state = before

    asyncio.run(body())


def samples(*taken: Any) -> "deque[Any]":
    """Of a live telescope."""
    return deque(taken, maxlen=480)
