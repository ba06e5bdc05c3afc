"""Alpaca discovery: the answer to `alpacadiscovery1` on UDP port 32227."""

import asyncio
import json
import socket
from contextlib import suppress

PORT = 32227
QUESTION = b"alpacadiscovery1"
_LONGEST = 1024
"""Bytes of a question that are looked at."""


async def serve(http_port: int, local_only: bool, port: int = PORT) -> None:
    """Tell the HTTP port to whoever may use it, until cancelled; on loopback that is this machine only.

    Bound to all interfaces, since questions come to broadcast addresses, `lo`'s included; several servers on
    a machine share the port. Raises OSError.
    """
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    answer = json.dumps({"AlpacaPort": http_port}).encode()
    try:
        listener.bind(("0.0.0.0", port))
        listener.setblocking(False)
        loop = asyncio.get_running_loop()
        while True:
            data, address = await loop.sock_recvfrom(listener, _LONGEST)
            if data.startswith(QUESTION) and not (local_only and not address[0].startswith("127.")):
                with suppress(OSError):  # nobody there, or no way
                    await loop.sock_sendto(listener, answer, address)
    finally:
        listener.close()
