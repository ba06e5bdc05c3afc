"""Alpaca discovery: the answer to `alpacadiscovery1` on UDP port 32227."""

import asyncio
import json
import socket
from typing import cast

PORT = 32227
QUESTION = b"alpacadiscovery1"


class Discovery(asyncio.DatagramProtocol):
    """Tells the HTTP port to whoever may use it. A server on loopback answers this machine only."""

    def __init__(self, http_port: int, local_only: bool) -> None:
        self._answer = json.dumps({"AlpacaPort": http_port}).encode()
        self._local_only = local_only
        self._transport: asyncio.DatagramTransport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The socket is there."""
        self._transport = cast(asyncio.DatagramTransport, transport)

    def datagram_received(self, data: bytes, address: tuple[str, int]) -> None:
        """Anything but the question is not answered."""
        allowed = not self._local_only or address[0].startswith("127.")
        if data.startswith(QUESTION) and allowed and self._transport is not None:
            self._transport.sendto(self._answer, address)


async def serve(http_port: int, local_only: bool, port: int = PORT) -> None:
    """Answer until cancelled. Bound to all interfaces, since questions come to broadcast addresses, `lo`'s
    included; several servers on a machine share the port. Raises OSError."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    try:
        listener.bind(("0.0.0.0", port))
    except OSError:
        listener.close()
        raise
    loop = asyncio.get_running_loop()
    transport, _ = await loop.create_datagram_endpoint(
        lambda: Discovery(http_port, local_only), sock=listener
    )
    try:
        await asyncio.Event().wait()
    finally:
        transport.close()
