"""What every page has: the way to the others, the state in one line, the lock, the stop, the space bar."""

from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui
from nicegui.events import GenericEventArguments, KeyEventArguments

from host.console.figures import summary
from host.console.live import PERIOD_S, Live
from host.console.views import CSS
from host.procedures.pointing import ENCODERS
from host.telescope import AsyncDesk, Refused, Telescope
from host.telescope.alarms import Alarm

PAGES = (
    ("/", "Main"),
    ("/focus", "Focus"),
    ("/alignment", "Alignment"),
    ("/maintenance", "Maintenance"),
    ("/dome", "Dome and weather"),
    ("/bus", "Bus"),
    ("/calibrate", "Calibrate"),
)
_COOKIE = "schmidt-day"
"""A browser keeps its mode from page to page."""
_SCRIPT = Path(__file__).with_name("shell.html").read_text(encoding="utf-8")


class Shell:
    """One open page of one browser. `control` registers what the lock greys; `each` what is refreshed."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.desk = AsyncDesk(live.telescope, console=True)
        self.day = ui.context.client.request.cookies.get(_COOKIE) == "1"
        self._controls: list[Any] = []
        self._refresh: list[Callable[[], object]] = []
        self._locked: bool | None = None
        self._said: ui.label
        self._keys: list[Callable[[KeyEventArguments], None]] = []

    @property
    def telescope(self) -> Telescope:
        """The telescope itself, for reading."""
        return self.live.telescope

    def control(self, element: Any) -> Any:
        """An element that is greyed while the consoles are locked."""
        self._controls.append(element)
        return element

    def field(self, element: Any, wide: bool = False) -> Any:
        """A field to fill in, as all of them look; wide: over the whole box."""
        return self.control(element.props("outlined dense").classes("w-full" if wide else None))

    def each(self, refresh: Callable[[], object]) -> Callable[[], object]:
        """Call this four times a second, while the page is open."""
        self._refresh.append(refresh)
        return refresh

    def key(self, act: Callable[[KeyEventArguments], None]) -> None:
        """Keys that this page takes beside the space bar; not while the consoles are locked."""
        self._keys.append(act)

    async def attempt(self, work: Awaitable[Any]) -> Any:
        """Wait for a command; what is refused is told, not raised. Returns its value or None."""
        try:
            return await work
        except Refused as refusal:
            self.say(str(refusal), bad=True)
            return None

    def say(self, text: str, bad: bool = False) -> None:
        """A line in the head of the page that stays until the next one: whoever looks up late still reads
        it. bad: something was refused."""
        self._said.set_text(f"{self.desk.now.t_s:.1f} s: {text}")
        self._said.classes(add="bad" if bad else None, remove=None if bad else "bad")

    def doing(self, act: Callable[[Telescope], Any]) -> Callable[[], Awaitable[None]]:
        """A handler that has a command carried out."""

        async def handler() -> None:
            await self.attempt(self.desk.do(act))

        return handler

    async def stop(self) -> None:
        """The emergency stop."""
        await self.attempt(self.desk.emergency_stop())

    async def _lock(self) -> None:
        await self.attempt(self.desk.lock(not self.desk.now.locked))
        self._tick()

    async def _pressed(self, event: KeyEventArguments) -> None:
        if event.key == " " and event.action.keydown and not event.action.repeat:
            await self.stop()
        elif not self.desk.now.locked:
            for act in self._keys:
                act(event)

    def _mode_button(self) -> None:
        """The browser itself turns to day and remembers it: at once, and with the connection lost."""

        def follow(event: GenericEventArguments) -> None:
            self.day = bool(event.args)
            self._show_mode()  # what the server knows of the page must agree with it; the plots follow

        button("Night / day").on("click", follow, js_handler="() => emit(toggleDay())")

    def _show_mode(self) -> None:
        ui.query("body").classes(add="day" if self.day else None, remove=None if self.day else "day")

    @contextmanager
    def page(self, path: str, title: str) -> Iterator[None]:
        """The frame of a page; its boxes go inside."""
        ui.add_css(CSS)
        ui.add_body_html(_SCRIPT)
        ui.colors(primary="#ff6a5a")
        self._show_mode()
        ui.page_title(f"{title} – Schmidt telescope")
        ui.keyboard(on_key=self._pressed, ignore=["input", "textarea"])
        with ui.element("header").classes("top w-full"):
            ui.html(f"<h1>{title}</h1>", sanitize=False)
            with ui.element("nav").props('aria-label="Consoles"').classes("flex flex-wrap"):
                for where, name in PAGES:
                    link = ui.link(name, where)
                    if where == path:
                        link.props('aria-current="page"')
            state = ui.label().classes("mid grow").props('role="status"')
            self._mode_button()
            lock = button("Lock", on_click=self._lock)
            self._stop_button()
            self._clocks()
            self._alarms()
            self._said = ui.label().classes("said").props('role="log" aria-label="Last answer"')
        with ui.element("div").classes("w-full"):
            yield
        self.each(lambda: state.set_text(summary(self.desk.now)))
        self.each(lambda: lock.set_text("Unlock" if self.desk.now.locked else "Lock"))
        ui.timer(PERIOD_S, self._tick)

    def _clocks(self) -> None:
        """The times of the night, on every page."""
        with ui.element("div").classes("clocks").props('role="group" aria-label="Clock"'):
            labels = []
            for name in ("UTC", "sidereal", "airmass", "meridian", "limit in"):
                with ui.element("span"):
                    ui.label(name).classes("small")
                    labels.append(ui.label("–").classes("mid"))

        @self.each
        def refresh() -> None:
            for label, text in zip(labels, self.live.clocks, strict=True):
                label.set_text(text)
            for label in labels[2:]:
                stale(label, not self.desk.now.stale.isdisjoint(ENCODERS))

    def _alarms(self) -> None:
        """What is wrong, on every page, until somebody acknowledges it; with a sound if wanted."""
        with ui.element("div").classes("alarms") as bar:
            lines = ui.html(sanitize=False).props('role="alert" aria-label="Alarms"')
            alarms = self.live.alarms
            self.control(button("Acknowledge", on_click=alarms.acknowledge))
            sound = ui.switch("sound").props('aria-label="Sound at a new alarm"')
        heard = [0]

        @self.each
        def refresh() -> None:
            standing = alarms.standing
            bar.set_visibility(bool(standing))
            clock = self.telescope.observatory.clock
            text = "".join(alarm_line(alarm, clock.iso(alarm.since_s)) for alarm in standing)
            if text != lines.content:
                lines.set_content(text)
            new = sum(not alarm.acknowledged for alarm in standing)
            if new > heard[0] and sound.value:
                ui.run_javascript("beep()")
            heard[0] = new

    def _stop_button(self) -> None:
        """In force at the press already, as of any such button: the click comes only with the release."""
        stop = button("STOP  (space)").classes("stop")
        stop.on("pointerdown", self.stop, js_handler="event => { if (event.button === 0) emit(); }")
        stop.on("click", self.stop, js_handler="event => { if (!event.detail) emit(); }")  # Enter: no press

    def _tick(self) -> None:
        for refresh in self._refresh:
            refresh()
        locked = self.desk.now.locked
        if locked != self._locked:
            self._locked = locked
            for element in self._controls:
                element.set_enabled(not locked)


def alarm_line(alarm: Alarm, since: str) -> str:
    """One alarm for the bar: how bad, what, since when (ISO 8601, UTC), whether it is over or seen."""
    state = " (over)" if alarm.until_s is not None else " (acknowledged)" if alarm.acknowledged else ""
    kind = alarm.severity.name.lower()
    new = "" if alarm.acknowledged else " new"
    words = f"<b>{kind.upper()}</b> {escape(alarm.what)}, since {since[11:19]} UTC{state}"
    return f'<div class="{kind}{new}">{words}</div>'


OLD = " (stale)"
"""The same within a table."""


def stale(element: Any, old: bool) -> None:
    """Mark a value that is older than it may be."""
    element.classes(add="stale" if old else None, remove=None if old else "stale")


def button(text: str, on_click: Any = None) -> ui.button:
    """A button in the consoles' colours."""
    return ui.button(text, on_click=on_click, color=None).props("no-caps")


@contextmanager
def box(title: str, wide: bool = False) -> Iterator[None]:
    """A group with a heading; wide: across all columns."""
    with ui.element("section").classes("box wide" if wide else "box"):
        ui.html(f"<h2>{title}</h2>", sanitize=False)
        yield


def table(columns: tuple[str, ...]) -> Callable[[Sequence[tuple[str, ...]]], None]:
    """A plain table; the returned function fills its rows, and sends nothing when they are the same."""
    element = ui.html(sanitize=False).classes("w-full")
    last: list[Sequence[tuple[str, ...]]] = [[]]

    def fill(rows: Sequence[tuple[str, ...]]) -> None:
        if rows == last[0] and element.content:
            return
        last[0] = rows
        head = "".join(f'<th scope="col">{escape(c)}</th>' for c in columns)
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
        element.set_content(
            f'<table class="plain"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
        )

    return fill


def seldom(refresh: Any, every: int = 4) -> Any:
    """Once in so many ticks."""
    count = 0

    def now_and_then() -> None:
        nonlocal count
        if count % every == 0:
            refresh()
        count += 1

    return now_and_then


def log_of(shell: Shell, name: str, lines: Callable[[], Sequence[tuple[float, str]]]) -> None:
    """A window of (t_s, words), the newest on top, with UTC."""
    element = ui.html(sanitize=False).props(f'role="log" aria-label="{name}"')

    @shell.each
    def refresh() -> None:
        utc = shell.telescope.observatory.clock.iso
        text = escape("\n".join(f"{utc(t_s)[11:19]}  {words}" for t_s, words in reversed(lines())))
        if (made := f'<pre class="lines">{text}</pre>') != element.content:
            element.set_content(made)
