"""The desk, from a thread of its own, while this thread ticks."""

import asyncio
import threading
from collections.abc import Callable, Coroutine
from typing import Any

import pytest

from bus.protocol import AxisMode
from host.telescope import AsyncDesk, Reason, Refused
from tests.host.telescope.conftest import Rig


def beside(rig: Rig, work: Callable[[], Coroutine[Any, Any, object]], limit_s: float = 300.0) -> object:
    """Run `work` in a thread and the emulation in this one until it has ended."""
    results: list[object] = []

    def body() -> None:
        try:
            results.append(asyncio.run(work()))
        except Exception as error:
            results.append(error)

    thread = threading.Thread(target=body, daemon=True)
    thread.start()
    for _ in range(round(limit_s / 0.05)):
        rig.advance(0.05)
        thread.join(0.001)
        if not thread.is_alive():
            break
    assert results, "the desk still waits"
    if isinstance(results[0], Exception):
        raise results[0]
    return results[0]


def test_a_job_is_awaited_to_its_end_and_refusals_are_passed_on(rig: Rig) -> None:
    desk = AsyncDesk(rig.telescope)
    beside(rig, lambda: desk.run(lambda t: t.drive.power_on()))
    assert desk.now.powered
    with pytest.raises(Refused) as refused:
        beside(rig, lambda: desk.do(lambda t: t.focuser.move_to(5000)))
    assert refused.value.reason is Reason.VALUE


def test_the_async_desk_awaits(rig: Rig) -> None:
    desk = AsyncDesk(rig.telescope)

    async def work() -> int:
        await desk.run(lambda t: t.drive.power_on())
        await desk.do(lambda t: t.drive.track(True))
        return await desk.run(lambda t: t.boards.get(t.client.devices[0], 1))

    assert beside(rig, work) == 10  # percent: the plant file's counter torque
    assert desk.now.tracking


@pytest.mark.slow
def test_what_one_asks_survives_what_another_begins_on_any_tick(rig: Rig) -> None:
    """Tracking begins some ticks after its command, and a stop ends it; answers asked for then come."""
    axis = rig.telescope.client.devices[0]
    rig.run(lambda t: t.drive.power_on())
    for ticks in range(8):
        for begin in (lambda t: t.drive.track(True), lambda t: t.drive.stop()):
            rig.do(begin)
            rig.advance(0.05 * ticks)
            asked = [rig.telescope.call(lambda t: t.boards.get(axis, 1)) for _ in range(3)]
            rig.advance(1.0)
            assert [each.result(0).finished.result(0) for each in asked] == [10, 10, 10], ticks


def test_a_stop_overtakes_what_moves_nothing(rig: Rig) -> None:
    rig.run(lambda t: t.drive.power_on())
    axis = rig.telescope.client.devices[0]
    gains = [rig.telescope.call(lambda t: t.boards.get(axis, 1)) for _ in range(40)]
    stop = rig.do(lambda t: t.emergency_stop())
    rig.advance(0.5)
    assert stop.finished.done() and not all(each.result(0).finished.done() for each in gains)
    rig.advance(3.0)
    assert {each.result(0).finished.result(0) for each in gains} == {10}
    assert not rig.telescope.journal.errors


def test_H2_the_lock_holds_consoles_but_not_the_stop_nor_programs(rig: Rig) -> None:
    console, program = AsyncDesk(rig.telescope, console=True), AsyncDesk(rig.telescope)
    beside(rig, lambda: console.lock(True))
    rig.advance(0.1)
    assert console.now.locked
    with pytest.raises(Refused) as refused:
        beside(rig, lambda: console.do(lambda t: t.drive.power_on()))
    assert refused.value.reason is Reason.LOCKED
    beside(rig, lambda: program.run(lambda t: t.drive.power_on()))
    beside(rig, lambda: console.emergency_stop())
    rig.advance(0.2)
    assert console.now.ra.mode is AxisMode.STOP
    beside(rig, lambda: console.lock(False))
    beside(rig, lambda: console.do(lambda t: t.drive.track(True)))


def test_a_telescope_that_does_not_tick_is_said_to_be_silent(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("host.telescope.desk.ANSWER_S", 0.05)
    with pytest.raises(Refused, match="no tick"):
        asyncio.run(AsyncDesk(rig.telescope).do(lambda t: t.drive.power_on()))
    rig.advance(1.0)  # given up: it is not carried out later
    assert not rig.telescope.snapshot.powered
