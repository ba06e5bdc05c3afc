"""`[HOST:]PORT` as users write it."""

import socket

LOCAL = "127.0.0.1"


class AddressError(ValueError):
    """Text that is no address."""


def address(text: str, option: str, ports: int = 1) -> tuple[str, int]:
    """(host, port) of `PORT`, `HOST:PORT` or `[IPv6]:PORT`; localhost when no host is given.

    ports: how many in a row are needed. Raises AddressError.
    """
    host, colon, number = text.rpartition(":")
    host = host.strip("[]") if colon else LOCAL
    if not number.isdecimal() or not number.isascii() or len(number) > 5 or "\0" in host or not host:
        raise AddressError(f'{option} "{text[:80]!s}": expected [HOST:]PORT, for example 7411')
    port = int(number)
    if not 1 <= port <= 65536 - ports:
        raise AddressError(f"{option} {port}: a port lies within 1..{65536 - ports}")
    return host, port


def is_local(host: str) -> bool:
    """Whether an address is this machine's own loopback."""
    return host in ("::1", "localhost") or host.startswith(("127.", "::ffff:127."))


def listen(host: str, port: int) -> socket.socket:
    """A listening TCP socket that never blocks; raises OSError naming the address."""
    try:
        family, _, _, _, where = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        raise OSError(f"{host}:{port} cannot be used: {error}") from None
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(where)
        listener.listen(16)
    except OSError as error:
        listener.close()
        raise OSError(f"{host}:{port} cannot be listened on: {error.strerror or error}") from None
    listener.setblocking(False)
    return listener
