"""The web server under the consoles and under Alpaca: answers on a listening socket until it is cancelled."""

from __future__ import annotations

import asyncio
import socket
from typing import Any

import uvicorn


async def answer(app: Any, listener: socket.socket) -> None:
    """Serve an ASGI application; when cancelled, hang up on everybody at once and close the listener."""
    # uvicorn writes head and body apart; without this, Nagle and delayed acknowledges make that 40 ms
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    # no logging of its own: whoever builds an application says what goes wrong in it, on one line
    quiet: dict[str, Any] = {"log_config": None, "log_level": "critical", "access_log": False}
    config = uvicorn.Config(app, timeout_graceful_shutdown=0, **quiet)
    server = uvicorn.Server(config)
    try:
        await server.serve(sockets=[listener])
    finally:  # cancelled, uvicorn leaves its sockets open
        for accepting in server.servers if server.started else []:
            accepting.close()
        for task in list(server.server_state.tasks):
            task.cancel()
        for connection in list(server.server_state.connections):
            connection.transport.abort()
        listener.close()
        await asyncio.sleep(0)
