"""Attacks on the doors of astronomers' programs: LX200 commands and Alpaca requests, in one thread.

A command that the telescope has to carry out waits for a tick; the attack ticks meanwhile, and gives up
waiting for what takes longer than a second, such as a slew.
"""

import asyncio
import json
from collections.abc import Coroutine
from random import Random
from typing import Any, TypeVar

from host.alpaca.server import Alpaca
from host.lx200.server import PLAIN, WITH_ARGUMENT, Lx200
from scenarios.doors.livenetwork import LiveNetwork
from tests.fuzz import inputs
from tests.host.inprocess import HostInProcess

T = TypeVar("T")
_TICK_NS = 50_000_000
_PATIENCE = 20
"""Ticks until an attack no longer waits for an answer."""


class Hosted:
    """A served network with its host, ticked by whoever waits."""

    def __init__(self, served: LiveNetwork) -> None:
        self.served = served
        self.host = HostInProcess(served)
        self.loop = asyncio.new_event_loop()
        for _ in range(_PATIENCE):
            self.tick()

    @property
    def telescope(self) -> Any:
        return self.host.pc.telescope

    def tick(self) -> None:
        self.host.poll(self.served.now_ns)
        self.served.run_until(self.served.now_ns + _TICK_NS)
        self.host.poll(self.served.now_ns)

    def wait(self, work: Coroutine[Any, Any, T]) -> T | None:
        """The answer, or None when it takes longer; raises what it raised."""
        return self.loop.run_until_complete(self._wait(work))

    async def _wait(self, work: Coroutine[Any, Any, T]) -> T | None:
        task = asyncio.ensure_future(work)
        for _ in range(_PATIENCE):
            for _ in range(4):
                await asyncio.sleep(0)
                if task.done():
                    return task.result()
            self.tick()
            await asyncio.sleep(0)
        task.cancel()
        await asyncio.wait([task])
        return None

    def close(self) -> None:
        self.host.close()
        self.loop.close()


def lx200(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Bytes of LX200 clients: commands near the table, joined, torn, with rubbish between them."""
    from tests.fuzz.doors import rounds

    hosted = Hosted(served)
    session = Lx200(hosted.telescope).session("fuzz")
    found = {"accepted": 0, "refused": 0}
    letters = [*PLAIN, *WITH_ARGUMENT]

    def one(_number: int) -> None:
        unknown = session.unknown
        said = hosted.wait(session.feed(inputs.lx200(random, letters)))
        if said is not None and len(said) > 4096:
            raise AssertionError(f"an answer of {len(said)} bytes")
        found["refused" if session.unknown > unknown else "accepted"] += 1

    rounds(served, count, one)
    hosted.close()
    return found


def alpaca(served: LiveNetwork, count: int, random: Random) -> dict[str, int]:
    """Alpaca requests: members of both devices with parameters that are missing, doubled or absurd."""
    from tests.fuzz.doors import rounds

    hosted = Hosted(served)
    door = Alpaca(hosted.telescope)
    members = [(kind, name) for (kind, _), device in door.devices.items() for name in device.members]
    found = {"accepted": 0, "refused": 0}

    def one(_number: int) -> None:
        answer = hosted.wait(_request(door.app, *inputs.alpaca(random, members)))
        if answer is None:  # a slew that is waited for
            found["accepted"] += 1
            return
        status, body = answer
        if status not in (200, 400, 404, 405):
            raise AssertionError(f"status {status}: {body[:200]!r}")
        number = json.loads(body).get("ErrorNumber") if status == 200 and body[:1] == b"{" else 0
        if number and not 0x400 <= number <= 0xFFF:
            raise AssertionError(f"an error that is none of ASCOM's: {body!r}")
        found["accepted" if status == 200 and not number else "refused"] += 1

    rounds(served, count, one)
    hosted.close()
    return found


async def _request(app: Any, method: str, path: str, query: bytes, body: bytes) -> tuple[int, bytes]:
    """Status and body that an ASGI application answers."""
    said: list[dict[str, Any]] = []
    scope = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": method, "path": path,
        "raw_path": path.encode("utf-8", "surrogatepass"), "query_string": query, "headers": [],
        "scheme": "http", "server": ("127.0.0.1", 11111), "client": ("127.0.0.1", 1), "root_path": "",
    }  # fmt: skip

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": body, "more_body": False}

    async def send(message: dict[str, Any]) -> None:
        said.append(message)

    await app(scope, receive, send)
    return int(said[0]["status"]), b"".join(each.get("body", b"") for each in said[1:])
