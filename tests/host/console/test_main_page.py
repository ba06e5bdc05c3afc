"""The main page on paper: where it points, its commands, the paddle's keys, boards and parameters."""

from concurrent.futures import Future
from itertools import pairwise
from types import SimpleNamespace as Some
from typing import Any

import pytest
from nicegui import ui

from bus.protocol import Device, Health, SpeedClass, State
from host.console.pages.main import flags, main, paddle
from host.telescope.state import BoardState
from tests.host.console.paper import Page, axis, on_paper, snapshot

GUIDE, SLEW = SpeedClass.GUIDE, SpeedClass.SLEW


def after(page: Page, label: str) -> str:
    """Text of the label behind this one."""
    texts = page.texts()
    return texts[texts.index(label) + 1]


def test_the_place_is_told_with_rates_and_errors() -> None:
    async def work(page: Page) -> None:
        page.build(main)
        page.telescope.snapshot = snapshot(
            ra=axis(rate_arcsec_s=15.04), dec=axis(rate_arcsec_s=-0.26), errors_arcsec=(0.123, -4.567)
        )
        page.tick()
        assert after(page, "HA") == "+00°00′00.0″" and after(page, "Az") == "+180°00′00.0″"
        assert after(page, "Alt") == "+60°38′00.0″"  # 90° less the latitude of 29° 22′
        assert after(page, "rates") == "+15.0″/s  -0.3″/s"
        assert after(page, "errors") == "+0.12″  -4.57″"
        page.telescope.snapshot = snapshot(errors_arcsec=(7200.0, -1800.0), slewing=True)
        page.tick()
        assert after(page, "errors") == "+2.00°  -0.50°"
        page.telescope.snapshot = snapshot(ra=axis(steps=None))
        page.tick()
        assert [after(page, name) for name in ("RA", "Dec", "HA", "Alt", "Az", "errors")] == ["–"] * 6

    on_paper(work)


@pytest.mark.parametrize(("board", "old"), [
    (Device.POSITION_RA, {"RA", "HA", "Alt", "Az", "errors"}),
    (Device.POSITION_DEC, {"Dec", "Alt", "Az", "errors"}),
    (Device.AXIS_RA, {"rates"}), (Device.AXIS_DEC, {"rates"}), (Device.FOCUS, set()),
])  # fmt: skip
def test_what_a_silent_board_would_tell_is_marked(board: Device, old: set[str]) -> None:
    async def work(page: Page) -> None:
        page.build(main)
        page.telescope.snapshot = snapshot(stale=frozenset({board}))
        page.tick()
        labels = page.every(ui.label)
        names = {"RA", "Dec", "HA", "Alt", "Az", "rates", "errors"}
        found = {
            name.text for name, value in pairwise(labels) if name.text in names and "stale" in value.classes
        }
        assert found == old

    on_paper(work)


def test_buttons_of_motors_and_tracking_are_their_commands() -> None:
    async def work(page: Page) -> None:
        page.build(main)
        for text in (
            "Power on", "Power off", "Park", "Unpark", "Track", "Stop tracking", "Abort slew", "Health check",
        ):  # fmt: skip
            await page.press(text)
        assert page.telescope.told == [
            ("drive.power_on",), ("drive.power_off",), ("drive.park",), ("drive.power_on",),
            ("drive.track", True), ("drive.track", False), ("drive.abort",), ("boards.check",),
        ]  # fmt: skip

    on_paper(work)


@pytest.mark.parametrize(("powered", "tracking", "words"), [
    (False, False, "motors off"), (True, False, "motors on"), (True, True, "motors on, tracking"),
    (False, True, "motors off"),
])  # fmt: skip
def test_the_supply_is_told(powered: bool, tracking: bool, words: str) -> None:
    async def work(page: Page) -> None:
        page.build(main)
        page.telescope.snapshot = snapshot(powered=powered, tracking=tracking)
        page.tick()
        found = page.texts()
        assert words in found and not ({"motors off", "motors on", "motors on, tracking"} - {words}) & set(
            found
        )

    on_paper(work)


def framed(shell: Any) -> None:
    with shell.page("/", "Paddle"):
        paddle(shell)


def test_a_key_is_held_once_and_let_go_once() -> None:
    async def work(page: Page) -> None:
        page.build(framed)
        speed = page.labelled("Speed of the paddle")
        assert (speed.value, speed.options) == ("guide", ["slew", "set", "guide", "fine"])
        keys = {way: page.labelled(f"Move {text}") for way, text in (
            ("n", "N ↑"), ("s", "S ↓"), ("e", "E ←"), ("w", "W →"),
        )}  # fmt: skip
        for way, key in keys.items():
            await page.fire(key, "mouseup")  # of nothing that was held
            await page.fire(key, "mousedown")
            await page.fire(key, "touchstart")
            speed.value = "slew"
            await page.fire(key, "mouseleave")
            await page.fire(key, "touchend")
            await page.fire(key, "touchstart")
            await page.fire(key, "touchcancel")
            speed.value = "guide"
            name = "dec" if way in "ns" else "ra"
            assert page.telescope.told == [
                ("paddle.press", way, GUIDE), ("paddle.release", name),
                ("paddle.press", way, SLEW), ("paddle.release", name),
            ]  # fmt: skip
            page.telescope.told.clear()
        grid = next(each for each in page.client.elements.values() if "paddle" in each.classes)
        cells = [getattr(each, "text", "") for each in grid.default_slot.children]
        assert cells == ["", "N ↑", "", "E ←", "", "W →", "", "S ↓", ""]

    on_paper(work)


def typed(key: str, down: bool = True, again: bool = False) -> Any:
    return Some(key=key, action=Some(keydown=down, keyup=not down, repeat=again))


@pytest.mark.parametrize(("key", "way", "name"), [
    ("ArrowUp", "n", "dec"), ("ArrowDown", "s", "dec"), ("ArrowLeft", "e", "ra"), ("ArrowRight", "w", "ra"),
])  # fmt: skip
def test_arrow_keys_are_the_paddles(key: str, way: str, name: str) -> None:
    async def work(page: Page) -> None:
        page.build(framed)
        page.client.tab_id = "paper"
        with page.client:
            await page.shell._pressed(typed(key, again=True))
            await page.shell._pressed(typed("x"))
        await page.later()
        assert page.telescope.told == []
        with page.client:
            await page.shell._pressed(typed(key))
        await page.later()
        assert page.telescope.told == [("paddle.press", way, GUIDE)]
        with page.client:
            await page.shell._pressed(typed(key, down=False))
        await page.later()
        assert page.telescope.told[1:] == [("paddle.release", name)]

    on_paper(work)


def test_a_browser_that_vanishes_lets_go() -> None:
    async def work(page: Page) -> None:
        page.build(framed)
        for gone in page.client.disconnect_handlers:
            gone()
        assert page.telescope.told == []
        await page.fire(page.labelled("Move N ↑"), "mousedown")
        for gone in page.client.disconnect_handlers:
            gone()
        assert page.telescope.told[1:] == [("paddle.release",)]

    on_paper(work)


def test_boards_are_a_table_once_a_second() -> None:
    boards = (
        BoardState(Device.AXIS_RA, True, State.ACTIVE, 3, 7, Health(0)),
        BoardState(Device.FOCUS, False, State.READY, 0, 0, Health.SENSOR | Health.STALE),
        BoardState(Device.DISPLAY, True, None, 0, 130, None),
    )

    async def work(page: Page) -> None:
        page.build(main)
        page.telescope.snapshot = snapshot(boards=boards)
        page.tick(4)
        head = ["board", "state", "health", "TEC", "over"]
        assert page.tables()[0] == [
            head, ["AXIS_RA", "active", "healthy", "7", "3"], ["FOCUS", "SILENT", "sensor, stale", "0", "0"],
            ["DISPLAY", "SILENT", "not asked", "130", "0"],
        ]  # fmt: skip
        page.telescope.snapshot = snapshot()
        page.tick()
        assert page.tables()[0] == [head]
        page.telescope.snapshot = snapshot(boards=boards)
        page.tick(3)
        assert page.tables()[0] == [head]
        page.tick()
        assert len(page.tables()[0]) == 4

    on_paper(work)


def test_health_is_told_bit_by_bit() -> None:
    assert flags(Health(0)) == "" and flags(Health.BUS) == "bus"
    assert flags(Health.SENSOR | Health.RANGE) == "sensor, range"


def ended(value: int) -> Any:
    future: Future[int] = Future()
    future.set_result(value)
    return Some(finished=future)


def test_parameters_are_read_and_written() -> None:
    async def work(page: Page) -> None:
        page.build(main)
        board, kind, value = (page.labelled(each) for each in ("Board", "Parameter", "Value"))
        assert (board.value, kind.value, value.value) == ("RA axis", "kp_q12", 0)
        page.telescope.answers |= {"boards.get": ended(77), "boards.set": ended(80)}
        await page.press("Read")
        assert value.value == 77
        board.value, kind.value, value.value = "Dec axis", "ki_q12", 81.0
        await page.press("Write")
        assert value.value == 80 and page.said == "Dec axis ki_q12 is 80"
        value.value = None
        await page.press("Write")
        assert page.telescope.told == [
            ("boards.get", Device.AXIS_RA, 2), ("boards.set", Device.AXIS_DEC, 3, 81),
            ("boards.set", Device.AXIS_DEC, 3, 0),
        ]  # fmt: skip
        from host.telescope import Reason, Refused

        for name in ("boards.get", "boards.set"):
            page.telescope.answers[name] = Refused(Reason.SILENT, "no answer")
        value.value = 5
        await page.press("Read")
        assert page.said == "no answer" and value.value == 5
        await page.press("Write")
        assert page.said == "no answer" and value.value == 5

    on_paper(work)


def test_the_night_log_has_the_last_14_lines_the_newest_on_top() -> None:
    async def work(page: Page) -> None:
        page.live.events.kept.extend((float(k), f"event {k} <") for k in range(20))
        page.build(main).tick()
        log = page.labelled("Night log").content
        lines = log.removeprefix('<pre class="lines">').removesuffix("</pre>").split("\n")
        assert len(lines) == 14
        assert (lines[0], lines[-1]) == ("14:00:19  event 19 &lt;", "14:00:06  event 6 &lt;")

    on_paper(work)
