"""The web server under consoles and Alpaca: an application that does not start is an error of its door."""

import asyncio
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from fastapi import FastAPI

from host.outside import Outside
from host.web import answer


def _listener() -> socket.socket:
    listener = socket.socket()
    listener.bind(("127.0.0.1", 0))
    listener.listen()
    return listener


@asynccontextmanager
async def _broken(_app: FastAPI) -> AsyncIterator[None]:
    raise RuntimeError("no such thing")
    yield


def test_an_application_that_does_not_start_says_why_and_leaves_the_other_doors_alone() -> None:
    outside = Outside()
    try:
        service = outside.keep(answer(FastAPI(lifespan=_broken), _listener()))
        outside.run(asyncio.sleep(0.2), 10)
        with pytest.raises(OSError, match="does not start: RuntimeError: no such thing"):
            service.check()
        assert outside.run(asyncio.sleep(0, "alive"), 10) == "alive"
    finally:
        outside.close()


def test_a_server_that_is_closed_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    """Its lifespan is cancelled last, and FastAPI tells that as an error, with a traceback."""
    outside = Outside()
    service = outside.keep(answer(FastAPI(), _listener()))
    outside.run(asyncio.sleep(0.2), 10)
    service.cancel()
    outside.close()
    assert capfd.readouterr() == ("", "")
