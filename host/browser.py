"""What tells a web page's request from a client's: any page may send one to a port of this machine."""

import os
import re
import socket
from collections.abc import Collection
from ipaddress import ip_address
from urllib.parse import urlsplit

HEAD_BYTES = 8
"""The longest method word and the space behind it."""
HOSTS_VARIABLE = "SCHMIDT_HOSTS"
_METHOD = re.compile(rb"(GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH) ")


def is_http(head: bytes) -> bool:
    """Whether a stream that begins with `head` is an HTTP request. `head`: its first `HEAD_BYTES`."""
    return _METHOD.match(head) is not None


def more_names() -> frozenset[str]:
    """Names in SCHMIDT_HOSTS, by commas."""
    return frozenset(
        name.strip().lower() for name in os.environ.get(HOSTS_VARIABLE, "").split(",") if name.strip()
    )


def own_names() -> frozenset[str]:
    """Names that a browser may call this server by: this machine's, and those in SCHMIDT_HOSTS."""
    return frozenset(("localhost", socket.gethostname().lower())) | more_names()


def is_own(host: str, names: Collection[str]) -> bool:
    """Whether the `Host` of a request is ours: an address, which no foreign name server can redirect, or one
    of `names`."""
    name = _name(host)
    try:
        ip_address(name)
    except ValueError:
        return name in names
    return True


def is_same(origin: str, host: str, more: Collection[str]) -> bool:
    """Whether a page of `origin` may talk to `host`: it came from there, or from one of `more` hosts."""
    try:
        where = urlsplit(origin).netloc.lower()
    except ValueError:
        return False
    return bool(where) and (where == host.lower() or _name(where) in more)


def _name(host: str) -> str:
    """Without port and brackets."""
    try:
        return (urlsplit("//" + host).hostname or "").lower()
    except ValueError:
        return ""
