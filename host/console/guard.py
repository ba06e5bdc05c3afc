"""Who may look: this machine always, others only with the token, once in the address, then by a cookie."""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable, MutableMapping, Sequence
from http.cookies import SimpleCookie
from typing import Any
from urllib.parse import parse_qs

Scope = MutableMapping[str, Any]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]
COOKIE = "schmidt-token"


class Guard:
    """An ASGI application around another. token: the word that clients of other machines must know."""

    def __init__(self, app: App, token: str) -> None:
        self._app = app
        self._token = token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or refuse with 403."""
        if scope["type"] not in ("http", "websocket") or self._local(scope):
            await self._app(scope, receive, send)
        elif self._knows(scope):
            await self._app(scope, receive, self._with_cookie(scope, send))
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await send(
                {"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain")]}
            )
            await send({"type": "http.response.body", "body": b"open this page with ?token=WORD\n"})

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
