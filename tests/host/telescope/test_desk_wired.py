"""The desk on wired boards: what it waits for, and what the console's lock holds."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

import pytest

from bus.protocol import Device, Opcode
from host.telescope import AsyncDesk, Reason, Refused
from tests.host.telescope.wired import AXES, Wired, awake


def during(made: Wired, work: Callable[[], Coroutine[Any, Any, Any]], ticks: int = 300) -> Any:
    """Its value, while the boards go on."""

    async def body() -> Any:
        task = asyncio.ensure_future(work())
        for _ in range(ticks):
            await asyncio.sleep(0)
            if task.done():
                break
            made.tick()
        return await task

    return asyncio.run(body())


def test_a_lock_holds_the_console_and_not_a_program_nor_a_stop() -> None:
    made = awake()
    console, program = AsyncDesk(made.telescope, console=True), AsyncDesk(made.telescope)
    during(made, lambda: console.do(lambda t: t.drive.track(True)))
    assert made.telescope.drive.tracking
    during(made, lambda: console.lock(True))
    assert made.telescope.locked and console.now.locked
    with pytest.raises(Refused, match="the console is locked; unlock it first") as found:
        during(made, lambda: console.do(lambda t: t.drive.track(False)))
    assert found.value.reason is Reason.LOCKED and made.telescope.drive.tracking
    during(made, lambda: console.do(lambda t: t.drive.set_rates(), always=True))
    during(made, lambda: program.do(lambda t: t.drive.track(False)))
    assert not made.telescope.drive.tracking
    made.since()
    during(made, console.emergency_stop)
    made.tick(4)
    assert {(axis, Opcode.STOP) for axis in AXES} <= {*made.since()}
    during(made, lambda: console.lock(False))
    assert not made.telescope.locked


def test_an_emergency_stop_is_urgent_and_other_commands_are_not() -> None:
    made = awake()
    urgent: list[bool] = []
    real = made.telescope.call

    def call(act: Any, urgent_too: bool = False) -> Any:
        urgent.append(urgent_too)
        return real(act, urgent_too)

    setattr(made.telescope, "call", call)  # noqa: B010
    desk = AsyncDesk(made.telescope)
    during(made, desk.emergency_stop)
    during(made, lambda: desk.do(lambda t: t.drive.abort()))
    during(made, lambda: desk.run(lambda t: t.drive.stop()))
    assert urgent == [True, False, False]


def test_a_desk_waits_for_both_encoders(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []
    made = Wired()
    desk = AsyncDesk(made.telescope)

    async def sleep(seconds: float) -> None:
        slept.append(seconds)
        if len(slept) in (3, 6):
            made.tick()
        if len(slept) == 3:
            del made.link.measurements[Device.POSITION_RA]
            made.telescope.tick(made.client.now_ns + 1)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    assert asyncio.run(desk.encoders()) == (*made.steps, pytest.approx(made.client.now_s, abs=0.01))
    assert slept == [0.05] * 6
    slept[:] = [0.0] * 10
    silent = AsyncDesk(Wired().telescope)
    with pytest.raises(Refused, match="no position has been received yet") as found:
        asyncio.run(silent.encoders())
    assert found.value.reason is Reason.SILENT and len(slept) == 110


def test_without_a_tick_it_says_so_after_five_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    waited: list[float] = []

    async def wait_for(future: Any, seconds: float) -> None:
        waited.append(seconds)
        raise TimeoutError

    monkeypatch.setattr(asyncio, "wait_for", wait_for)
    with pytest.raises(Refused, match="no tick within 5 s; is it paused") as found:
        asyncio.run(AsyncDesk(Wired().telescope).do(lambda t: t.drive.abort()))
    assert found.value.reason is Reason.SILENT and waited == [5.0]


def test_readings_need_both_encoders() -> None:
    made = Wired()
    made.tick()
    for missing, other in (
        (Device.POSITION_RA, Device.POSITION_DEC),
        (Device.POSITION_DEC, Device.POSITION_RA),
    ):
        kept = made.link.measurements.pop(missing)
        assert made.link.measurements[other]
        with pytest.raises(Refused, match="no position has been received yet"):
            made.telescope.drive.readings()
        made.link.measurements[missing] = kept
    made.link.measured_ns[Device.POSITION_RA] -= 7_000_000
    assert made.telescope.drive.readings()[2] == pytest.approx(made.client.now_s - 0.007)


def test_a_telescope_that_is_awake_is_woken_to_track() -> None:
    made = awake()
    made.do(lambda t: t.drive.wake())
    assert made.telescope.drive.tracking
    assert made.telescope.drive.job is not None and made.telescope.drive.job.name == "track"
    made.tick(60)
    made.do(lambda t: t.drive.track(False))
    assert made.telescope.drive.job.name == "stop"
