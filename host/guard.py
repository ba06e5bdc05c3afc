"""Who may look: this machine always, others only with the token, once in the address, then by a cookie.

A request that names a foreign host, or comes from a page of one, is refused. A name server can point any name
at this machine, and a browser lets any page open a websocket.
"""

import hmac
import os
import socket
from ipaddress import ip_address
from urllib.parse import urlsplit

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

COOKIE = "schmidt-token"
_HERE = ("127.0.0.1", "::1", "localhost")
HOSTS_VARIABLE = "SCHMIDT_HOSTS"
"""Names by commas that browsers may call this machine by, beside its own, and whose pages may talk to it."""


class Guard:
    """An ASGI application around another. token: the word that other machines must know; None: there is none.

    A protocol like Alpaca has no place for one.
    """

    def __init__(self, app: ASGIApp, token: str | None) -> None:
        self._app, self._token = app, token
        words = (name.strip().lower() for name in os.environ.get(HOSTS_VARIABLE, "").split(","))
        self._more = frozenset(filter(None, words))
        self._names = self._more | {"localhost", socket.gethostname().lower()}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse with 403; a websocket with the code that ends in it."""
        why = ""
        if scope["type"] in ("http", "websocket"):
            asked = HTTPConnection(scope)
            if not self._addressed(asked):
                why = f"foreign Host or Origin; {HOSTS_VARIABLE}=NAME,NAME allows more\n"
            elif self._token is not None and (asked.client is None or asked.client.host not in _HERE):
                said = asked.query_params.get("token")
                word = asked.cookies.get(COOKIE, "") if said is None else said
                if not hmac.compare_digest(word.encode(), self._token.encode()):
                    why = "open this page with ?token=WORD\n"
                elif said is not None:
                    send = _with_cookie(send, said)
        if not why:
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await PlainTextResponse(why, 403)(scope, receive, send)

    def _addressed(self, asked: HTTPConnection) -> bool:
        """Whether `Host` is ours: an address, which no foreign name server can redirect, or one of our names.
        A page may talk to the host it came from; so may those of `SCHMIDT_HOSTS`."""
        host, origin = asked.headers.get("host", ""), asked.headers.get("origin")
        try:
            ip_address(_name(host))
        except ValueError:
            if host and _name(host) not in self._names:
                return False
        if origin is None:
            return True
        try:
            where = urlsplit(origin).netloc.lower()
        except ValueError:
            return False
        return bool(where) and (where == host.lower() or _name(where) in self._more)


def _with_cookie(send: Send, word: str) -> Send:
    async def passing(message: Message) -> None:
        if message["type"] == "http.response.start":
            cookie = f"{COOKIE}={word}; Path=/; HttpOnly; SameSite=Strict"
            MutableHeaders(scope=message).append("set-cookie", cookie)
        await send(message)

    return passing


def _name(host: str) -> str:
    """Without port and brackets."""
    try:
        return (urlsplit("//" + host).hostname or "").lower()
    except ValueError:
        return ""
