"""The web server under the consoles and under Alpaca: answers on a listening socket until it is cancelled."""

import asyncio
import logging
import socket
from typing import Any

import uvicorn

_ERRORS = logging.getLogger("uvicorn.error")
_ERRORS.propagate = False
_ERRORS.addHandler(logging.NullHandler())  # or what is cancelled last is a traceback on the screen


class _FirstError(logging.Handler):
    """Keeps the last line of uvicorn's first error, instead of a traceback on the screen."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.line = ""
        _ERRORS.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """An error; those behind it only say that it ends."""
        if self.line:
            return
        text = record.getMessage()
        if record.exc_info and record.exc_info[1] is not None:
            text = f"{type(record.exc_info[1]).__name__}: {record.exc_info[1]}"
        self.line = (text.strip().splitlines() or [""])[-1]

    def forget(self) -> None:
        """Listen no longer."""
        _ERRORS.removeHandler(self)


async def answer(app: Any, listener: socket.socket) -> None:
    """Serve an ASGI application; when cancelled, hang up on everybody at once and close the listener."""
    # uvicorn writes head and body apart; without this, Nagle and delayed acknowledges make that 40 ms
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    # no logging of its own: whoever builds an application says what goes wrong in it, on one line
    quiet: dict[str, Any] = {"log_config": None, "log_level": "error", "access_log": False}
    config = uvicorn.Config(app, timeout_graceful_shutdown=0, **quiet)
    server = uvicorn.Server(config)
    said = _FirstError()
    try:
        await server.serve(sockets=[listener])
    except SystemExit:  # uvicorn's way of saying that the application does not start; it would end the thread
        raise OSError(f"the web application does not start: {said.line or 'no reason given'}") from None
    finally:  # cancelled, uvicorn leaves its sockets open
        for accepting in server.servers if server.started else []:
            accepting.close()
        for task in list(server.server_state.tasks):
            task.cancel()
        for connection in list(server.server_state.connections):
            connection.transport.abort()
        listener.close()
        said.forget()
        await asyncio.sleep(0)
