"""Who may look: this machine always, others only with the token, once in the address, then by a cookie.

A request that names a foreign host, or comes from a page of one, is refused. A name server can point any name
at this machine, and a browser lets any page open a websocket. Any page may also send a request to a port that
speaks no HTTP.
"""

import hmac
import os
import re
import socket
from collections.abc import Awaitable, Callable, Collection, MutableMapping, Sequence
from http.cookies import SimpleCookie
from ipaddress import ip_address
from typing import Any
from urllib.parse import parse_qs, urlsplit

Scope = MutableMapping[str, Any]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]
COOKIE = "schmidt-token"


class Guard:
    """An ASGI application around another. token: the word that other machines must know; None: there is none.

    A protocol like Alpaca has no place for one.
    """

    def __init__(self, app: App, token: str | None) -> None:
        self._app = app
        self._open, self._token = token is None, token or ""
        self._names, self._more = own_names(), more_names()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse with 403."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
        elif not self._addressed(scope):
            await _refuse(scope, send, f"foreign Host or Origin; {HOSTS_VARIABLE}=NAME,NAME allows more\n")
        elif self._open or self._local(scope):
            await self._app(scope, receive, send)
        elif self._knows(scope):
            await self._app(scope, receive, self._with_cookie(scope, send))
        else:
            await _refuse(scope, send, "open this page with ?token=WORD\n")

    def _addressed(self, scope: Scope) -> bool:
        headers = {name: value.decode("latin-1") for name, value in scope.get("headers", [])}
        host, origin = headers.get(b"host", ""), headers.get(b"origin")
        if host and not is_own(host, self._names):
            return False
        return origin is None or is_same(origin, host, self._more)

    def _local(self, scope: Scope) -> bool:
        client: Sequence[Any] = scope.get("client") or ("",)
        return str(client[0]) in ("127.0.0.1", "::1", "localhost")

    def _knows(self, scope: Scope) -> bool:
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        said = query.get("token", [""])[0]
        for name, value in scope.get("headers", []):
            if name == b"cookie":
                cookie = SimpleCookie(value.decode("latin-1")).get(COOKIE)
                said = said or (cookie.value if cookie else "")
        return hmac.compare_digest(said.encode(), self._token.encode())

    def _with_cookie(self, scope: Scope, send: Send) -> Send:
        async def passing(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start" and b"token=" in scope.get("query_string", b""):
                cookie = f"{COOKIE}={self._token}; Path=/; HttpOnly; SameSite=Strict"
                message.setdefault("headers", []).append((b"set-cookie", cookie.encode()))
            await send(message)

        return passing


async def _refuse(scope: Scope, send: Send, why: str) -> None:
    """403, or for a websocket the code that ends in it."""
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008})
        return
    await send({"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain")]})
    await send({"type": "http.response.body", "body": why.encode()})


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
