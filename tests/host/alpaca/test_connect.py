"""Connecting waits for boards that have just been switched on, and not for ever."""

import asyncio
from typing import cast

import pytest

from host.alpaca import device as alpaca
from host.alpaca.device import COMMON, Device, unknown
from host.alpaca.requests import Parameters
from host.telescope import AsyncDesk


class Late(Device):
    """Says nothing the first times it is asked."""

    kind = "telescope"

    def __init__(self, silent: int) -> None:
        super().__init__(cast(AsyncDesk, None))
        self.silent = silent
        self.asked = 0

    def state(self) -> dict[str, object]:
        self.asked += 1
        if self.asked <= self.silent:
            raise unknown()
        return {}


class Looked(asyncio.SelectorEventLoop):
    """Its time goes on by a millisecond whenever somebody looks at it: however busy the machine is."""

    looks = 0

    def time(self) -> float:
        self.looks += 1
        return self.looks * 1e-3


def connect(device: Device, name: str) -> None:
    member = next(each for each in COMMON if each.name == name)
    given = Parameters("Connected=True" if name == "Connected" else "", exact=True)
    with asyncio.Runner(loop_factory=Looked) as runner:
        assert member.put is not None
        runner.run(member.put(device, given))


@pytest.mark.parametrize("name", ["Connected", "Connect"])
def test_a_client_is_connected_when_the_boards_have_been_heard(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(alpaca, "_LOOK_S", 0.001)
    device = Late(silent=3)
    connect(device, name)
    assert device.connected and device.asked == 4


@pytest.mark.parametrize("name", ["Connected", "Connect"])
def test_boards_that_stay_silent_do_not_hold_it_up(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alpaca, "_LOOK_S", 0.001)
    monkeypatch.setattr(alpaca, "_HEARD_S", 0.02)  # of the loop's time
    device = Late(silent=10**9)
    connect(device, name)
    assert device.connected and device.asked > 1
