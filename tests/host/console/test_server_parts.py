"""The consoles' server without a socket: pages, patience, what is counted; and the frame of a page."""

import asyncio
import logging
from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import pytest
from nicegui import ui

from host.console import server
from host.console.server import Consoles
from tests.host.console.paper import Page, PaperBus, PaperTelescope, on_paper, snapshot
from tests.host.console.test_shell_page import empty


class App:
    """NiceGUI's, as far as it is told something."""

    def __init__(self) -> None:
        self.files: list[tuple[str, Path]] = []
        self.started: list[Any] = []
        self.connected: list[Any] = []

    def add_static_files(self, where: str, folder: Path) -> None:
        self.files.append((where, folder))

    def on_startup(self, act: Any) -> None:
        self.started.append(act)

    def on_connect(self, act: Any) -> None:
        self.connected.append(act)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    app, pages, ran = App(), dict[str, Any](), list[dict[str, Any]]()

    def page(path: str, reconnect_timeout: float) -> Any:
        return lambda build: pages.update({path: (build, reconnect_timeout)})

    fake = Some(page=page, run_with=lambda _web, **how: ran.append(how))
    monkeypatch.setattr(server, "nicegui_app", app)
    monkeypatch.setattr(server, "ui", fake)
    kept = [(each, each.handlers, each.propagate) for each in map(logging.getLogger, server._LOGGERS)]
    consoles = Consoles(PaperTelescope(), PaperBus(), Some(folder=tmp_path), "word")  # type: ignore[arg-type]
    yield Some(consoles=consoles, app=app, pages=pages, ran=ran, folder=tmp_path)
    for logger, handlers, propagate in kept:
        logger.handlers, logger.propagate = handlers, propagate


def test_seven_pages_stay_for_half_a_minute(made: Any) -> None:
    paths = ["/", "/focus", "/alignment", "/maintenance", "/dome", "/bus", "/calibrate"]
    assert list(made.pages) == paths and {each[1] for each in made.pages.values()} == {30.0}
    assert made.app.files == [("/reports", made.folder)]
    assert made.ran == [{
        "title": "Schmidt telescope", "dark": True, "language": "en-US", "binding_refresh_interval": 1.0,
    }]  # fmt: skip


def test_a_quiet_browser_is_waited_for(made: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    link = Some(ping_interval=0, ping_timeout=0)
    monkeypatch.setattr(server, "core", Some(sio=Some(eio=link)))
    for act in made.app.started:
        act()
    assert (link.ping_interval, link.ping_timeout) == (2, 5)


def test_browsers_and_refused_messages_are_counted(made: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert (made.consoles.pages, made.consoles.refused) == (0, 0)
    for _ in range(2):
        made.app.connected[0]()
    for name in ("engineio.server", "socketio.server", "nicegui"):
        logging.getLogger(name).warning("fine")
        logging.getLogger(name).error("odd")
        assert logging.getLogger(name).propagate is False
    assert (made.consoles.pages, made.consoles.refused) == (2, 3)
    assert capsys.readouterr().err == ""


def test_samples_are_taken_while_it_serves(made: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four a second of wall time, until it ends."""
    slept: list[float] = []
    real = asyncio.sleep

    async def sleep(seconds: float) -> None:
        slept.append(seconds)
        await real(0)

    async def answer(_app: Any, _listener: Any) -> None:
        for _ in range(5):
            await real(0)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    monkeypatch.setattr(server, "answer", answer)

    async def body() -> int:
        await made.consoles.serve(None)
        count = len(slept)
        for _ in range(5):
            await real(0)
        return count

    count = asyncio.run(body())
    assert count >= 2 and len(slept) <= count + 1 and set(slept) == {0.25}
    assert len(made.consoles.live.samples) == 1


def test_a_page_is_built_over_the_telescope(made: Any) -> None:
    async def work(page: Page) -> None:
        with page.client:
            made.pages["/bus"][0]()
        assert any(each.content == "<h1>Bus</h1>" for each in page.every(ui.html))

    on_paper(work)


def test_a_frame_listens_to_keys_and_ticks_four_times_a_second() -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        keyboard = page.every(ui.keyboard)[0]
        assert keyboard.props["ignore"] == ["input", "textarea"]
        assert [each.interval for each in page.every(ui.timer)] == [0.25]
        assert [each.content for each in page.every(ui.html) if "<h1>" in each.content] == ["<h1>Empty</h1>"]
        assert "beep" in page.client.body_html + page.client.shared_body_html
        stop = page.button("STOP  (space)")
        kinds = sorted(each.type for each in stop._event_listeners.values())
        assert kinds.count("click") >= 1 and "pointerdown" in kinds
        for kind in ("click", "pointerdown"):
            page.telescope.told.clear()
            await page.fire(stop, kind, {})
            assert page.telescope.told == [("emergency_stop",)]

    on_paper(work)


def test_a_lock_is_respected_before_the_page_shows_it() -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        page.telescope.locked = True
        await page.press("act")
        assert page.telescope.told == [] and page.said == "the console is locked; unlock it first"
        page.telescope.snapshot = snapshot(locked=True)
        await page.press("Unlock" if page.shell._locked else "Lock")
        assert not page.telescope.locked

    on_paper(work)


@pytest.mark.parametrize(("cookie", "day"), [("", False), ("schmidt-day=1", True)])
def test_a_page_begins_in_the_browsers_mode(cookie: str, day: bool) -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        body = [each for each in page.client.elements.values() if type(each).__name__ == "QueryElement"]
        assert any("day" in each.props["classes"] for each in body) == day

    on_paper(work, cookie)
