"""The consoles' web server: one per process, in the thread of the outside world."""

import asyncio
import logging
import socket
from typing import Any

from fastapi import FastAPI
from nicegui import app as nicegui_app
from nicegui import core, ui

from host.console.live import Live
from host.console.pages.alignment import alignment
from host.console.pages.bus import bus
from host.console.pages.calibrate import REPORTS, calibrate
from host.console.pages.dome import dome
from host.console.pages.focus import focus
from host.console.pages.main import main
from host.console.pages.maintenance import maintenance
from host.console.runs import RecordedRuns
from host.console.shell import Shell
from host.console.views import BusView
from host.guard import Guard
from host.telescope import Telescope
from host.web import answer

_LOGGERS = ("engineio.server", "socketio.server", "nicegui")
"""Where the libraries tell of messages that no page sends; by default as tracebacks on the screen."""


_COME_BACK_S = 30.0
"""How long the server keeps the page of a browser whose connection is gone. Within that it goes on as it was;
after it the page is loaded anew, and what was typed or pressed meanwhile is lost. (NiceGUI's own 3 s are less
than a busy laptop is silent, or the dome's wireless network.) Keys held down are let go at once."""
_PING_S, _SILENT_S = 2, 5
"""A page is asked this often, and is gone when it says nothing for so long. NiceGUI's own 4 s and 2 s notice
a dead link hardly sooner. They drop a browser that a busy machine holds up for two seconds, and its click."""


class _Counter(logging.Handler):
    """Counts instead of printing."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.count = 0

    def emit(self, record: logging.LogRecord) -> None:
        """One more."""
        self.count += 1


class Consoles:
    """Pages over one telescope, one bus and one folder of recorded runs. One object per process: NiceGUI
    keeps its pages in the module. pages: how many browsers have shown."""

    def __init__(self, telescope: Telescope, bus_view: BusView, runs: RecordedRuns, token: str) -> None:
        self.live = Live(telescope, bus_view)
        self.pages = 0
        nicegui_app.add_static_files(REPORTS, runs.folder)
        pages = {
            "/": main,
            "/focus": focus,
            "/alignment": alignment,
            "/maintenance": maintenance,
            "/dome": dome,
            "/bus": lambda shell: bus(shell, bus_view),
            "/calibrate": lambda shell: calibrate(shell, runs),
        }
        for path, build in pages.items():
            ui.page(path, reconnect_timeout=_COME_BACK_S)(_page(self.live, build))
        web = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
        ui.run_with(web, title="Schmidt telescope", dark=True, language="en-US", binding_refresh_interval=1.0)
        nicegui_app.on_startup(_patient)
        nicegui_app.on_connect(self._shown)
        self._app = Guard(web, token)
        self._refused = _Counter()
        for name in _LOGGERS:
            logger = logging.getLogger(name)
            logger.handlers, logger.propagate = [self._refused], False

    @property
    def refused(self) -> int:
        """Messages that no page sends, or that a page could do nothing with."""
        return self._refused.count

    def _shown(self) -> None:
        self.pages += 1

    async def serve(self, listener: socket.socket) -> None:
        """Answer browsers on a listening socket until cancelled."""
        sampling = asyncio.ensure_future(self.live.run())
        try:
            await answer(self._app, listener)
        finally:
            sampling.cancel()


def _patient() -> None:
    core.sio.eio.ping_interval, core.sio.eio.ping_timeout = _PING_S, _SILENT_S


def _page(live: Live, build: Any) -> Any:
    def page() -> None:
        build(Shell(live))

    return page
