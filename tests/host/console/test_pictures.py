"""Every page in every state of a night, night and day, on a desk and on a phone: kept as pictures, which
are an artefact of CI. What a program can judge of them is judged."""

import os
import re
import signal
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest

from bus.protocol import Device, Opcode, pack_command
from bus.protocol.nodes import WEATHER
from bus.protocol.report import pack_report
from tests.doors.test_host_process import host_of
from tests.host.console.conftest import PATHS, SHOTS, Consoles, choose, opened, press, state

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]
SIZES = {"desk": (1400, 1000), "phone": (390, 844)}
NARROW = (1408, 1024, 360)
"""Pages whose cards are narrowest: four columns of 21 rem side by side, a tablet, a small phone."""
REDRAW_MS = 1200
"""Plots are drawn anew once a second."""
FIT_MS = 300
NOTICE_MS = 3000
"""The notice of a lost connection takes its colours with a delay."""
WHITISH = 165
"""The least of a pixel's three colours, of 255, from which it disturbs eyes that are used to the dark.
ASSUMPTION."""
LIGHT = 0.8
"""Median brightness of a page by day. ASSUMPTION."""
FILLED = 0.4
"""Share of a desk's first screen that is covered by cards. ASSUMPTION."""
REACHED = 0.9
"""Share of a desk's height down to which the cards of FILLED_PAGES reach. ASSUMPTION."""
FILLED_PAGES = ("dome", "maintenance", "calibrate")
"""Their few cards grow with the screen."""
_REACH = """Math.max(...[...document.querySelectorAll(".box")].map(
  at => at.getBoundingClientRect().bottom)) / innerHeight"""
_WIDE = """[...document.querySelectorAll('.box, .q-btn, .q-btn__content')].filter(
  at => at.scrollWidth > at.clientWidth + 1 || !at.matches('.box') && at.scrollHeight > at.clientHeight + 1)
.map(at => (at.querySelector('h2') || at).textContent)
.concat(document.documentElement.scrollWidth > innerWidth ? ['the page'] : [])"""
"""What something runs out of."""
_AWAY = """[...document.querySelectorAll('.stop, .alarms > .q-btn')].filter(at => {
  const place = at.getBoundingClientRect();
  return place.height && (place.top < 0 || place.bottom > innerHeight);
}).map(at => at.textContent)"""
"""What must be in view wherever one looks."""
_COVERED = """() => {
  const top = document.querySelector('.top').getBoundingClientRect().bottom;
  const areas = [...document.querySelectorAll('.box')].map(box => box.getBoundingClientRect()).map(
    at => (at.right - at.left) * Math.max(0, Math.min(at.bottom, innerHeight) - Math.max(at.top, top)));
  return areas.reduce((sum, each) => sum + each, 0) / (innerHeight - top) / innerWidth;
}"""


class Observatory(Consoles):
    """All nodes, with another host program's plug."""

    def __init__(self, folder: Path) -> None:
        scenario = folder / "final.yaml"
        scenario.write_text(
            "name: All nodes\nstart_utc: 2026-02-10T14:00:00Z\nnetwork: {name: final}\n"
            "steps:\n  - wait: {for: 1 s}\n"
        )
        self.plug = folder / "plug"
        super().__init__(folder, 5.0, str(scenario), "--hid", f"unix:{self.plug}")

    def told(self, line: str) -> None:
        """A command of the control plane that has to be obeyed."""
        assert (said := self.ask(line)).startswith("ok"), said

    def set(self, device: Device, number: int, value: int) -> None:
        """A parameter of a board, as another program sets it."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as plug:
            plug.connect(str(self.plug))
            plug.send(pack_report([pack_command(device, Opcode.SET_PARAMETER, number, value)]))
            self.wait(self.status()["simulated_s"] + 0.2)


@pytest.fixture(scope="module")
def observatory(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Observatory]:
    with Observatory(tmp_path_factory.mktemp("pictures")) as made:
        yield made


def no_power(page: Any, _at: Observatory) -> None:
    state(page, "motors off")
    page.get_by_text("POWER_ROOM").first.wait_for()


def weather_unsafe(page: Any, at: Observatory) -> None:
    """The mast calls any humidity too high; the shutter, which was opened, is shut by its board."""
    press(page, "Open shutter")
    page.get_by_text(re.compile("shutter .*moving")).first.wait_for()
    at.set(WEATHER.device("WEATHER_MAST"), 2, 0)
    page.get_by_role("alert").get_by_text("humid").wait_for()


def tracking(page: Any, at: Observatory) -> None:
    for number, value in ((2, 900), (3, 0)):
        at.set(WEATHER.device("WEATHER_MAST"), number, value)
    page.get_by_text("Interlock: the shutter may open.").wait_for()
    press(page, "Acknowledge")
    press(page, "Follow the telescope")
    choose(page, "Name", "Capella")
    press(page, "Go")
    state(page, "^tracking, Capella")
    at.wait(at.status()["simulated_s"] + 60.0)


def slewing(page: Any, at: Observatory) -> None:
    choose(page, "Name", "Pollux")
    press(page, "Go")
    state(page, "^slewing")
    at.wait(at.status()["simulated_s"] + 1.0)


def fault_running(page: Any, at: Observatory) -> None:
    state(page, "^tracking, Pollux")
    at.told("fault start bit_errors probability=0.05")
    page.get_by_role("alert").get_by_text("bit_errors").wait_for()


def alarm_latched(page: Any, at: Observatory) -> None:
    at.told("fault clear 0")
    at.told("power POSITION_RA off")
    page.get_by_role("alert").get_by_text("POSITION_RA is silent").wait_for()
    at.told("power POSITION_RA on")
    page.locator(".alarm", has_text=re.compile(r"POSITION_RA is silent.*\(over\)")).wait_for()


def link_lost(page: Any, at: Observatory) -> None:
    """The gateway has no supply: nothing of any board reaches the host."""
    press(page, "Acknowledge")
    at.told("power GATEWAY off")
    page.get_by_role("alert").get_by_text("POSITION_DEC: no measurement").wait_for()
    at.wait(at.status()["simulated_s"] + 5.0)


STATES = (no_power, weather_unsafe, tracking, slewing, fault_running, alarm_latched, link_lost)


def test_every_page_of_every_state(browser: Any, observatory: Observatory) -> None:
    """One state after another, each from the one before; time stands still while it is looked at."""
    wrong = []
    for brought in STATES:
        page = opened(browser, observatory, "/dome")  # it has the sky's boxes, too
        observatory.told("resume")
        brought(page, observatory)
        observatory.told("pause")
        for path in PATHS:
            page.goto(observatory.url + path)
            page.wait_for_function("document.querySelector('[role=status]')?.textContent")
            name = f"{brought.__name__.replace('_', '-')}-{path.strip('/') or 'main'}"
            wrong += photographed(page, name)
        page.close()
    assert wrong == []


def photographed(page: Any, name: str) -> list[str]:
    """Four pictures; what is wrong with them, a line each."""
    found = []
    for width in NARROW:
        page.set_viewport_size({"width": width, "height": 800})
        page.wait_for_timeout(FIT_MS)
        found += [f"{name}, {width} px: something runs out of {each}" for each in page.evaluate(_WIDE)]
    for mode in ("night", "day"):
        page.wait_for_timeout(REDRAW_MS)
        for size, (width, height) in SIZES.items():
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_timeout(FIT_MS)
            found += [f"{name}, {size}: something runs out of {each}" for each in page.evaluate(_WIDE)]
            found += [f"{name}, {size}: {each} is out of view" for each in page.evaluate(_AWAY)]
            if size == "desk" and (covered := page.evaluate(_COVERED)) < FILLED:
                found.append(f"{name}: cards cover {covered:.0%} of a desk")
            filled = size == "desk" and name.endswith(FILLED_PAGES)
            if filled and (reach := page.evaluate(_REACH)) < REACHED:
                found.append(f"{name}: cards end at {reach:.0%} of a desk's height")
            SHOTS.mkdir(parents=True, exist_ok=True)
            file = SHOTS / f"{name}-{mode}-{size}.png"
            page.screenshot(path=str(file), full_page=True)
            found += [f"{name}, {mode}, {size}: {each}" for each in wrong_colours(file, mode)]
        press(page, "Night / day")
    page.set_viewport_size(dict(zip(("width", "height"), SIZES["desk"], strict=True)))
    return found


def wrong_colours(file: Path, mode: str) -> list[str]:
    """Whitish places by night, a dark page by day."""
    pixels = np.asarray(matplotlib.image.imread(file))[..., :3]
    if mode == "day":
        brightness = float(np.median(pixels.mean(axis=2)))
        return [f"brightness {brightness:.2f}"] if brightness < LIGHT else []
    white = int((pixels.min(axis=2) * 255 > WHITISH).sum())
    return [f"{white} whitish pixels"] if white else []


def test_whitish_and_dark_pages_are_found(tmp_path: Path) -> None:
    file = tmp_path / "page.png"
    for mode, right, wrong in (("night", 0.0, 0.8), ("day", 1.0, 0.1)):
        for grey in (right, wrong):
            matplotlib.image.imsave(file, np.full((4, 4, 3), grey))
            assert bool(wrong_colours(file, mode)) is (grey == wrong)


def test_a_page_whose_server_hangs_says_so(browser: Any, observatory: Observatory) -> None:
    """Stopped, not ended: a network that is lost looks the same to a browser."""
    page = opened(browser, observatory, "/")
    observatory.told("resume")
    both = observatory.process.pid, host_of(observatory.process.pid)
    for process in both:
        os.kill(process, signal.SIGSTOP)
    try:
        page.locator("#popup[aria-hidden=false]").wait_for()
        assert page.evaluate("getComputedStyle(document.querySelector('.boxes')).opacity") == "0.45"
        wrong = photographed_lost(page)
    finally:
        for process in both:
            os.kill(process, signal.SIGCONT)
    page.close()
    assert wrong == []


def photographed_lost(page: Any) -> list[str]:
    found = []
    for mode in ("night", "day"):
        page.wait_for_timeout(NOTICE_MS)
        file = SHOTS / f"server-lost-main-{mode}.png"
        page.screenshot(path=str(file))
        found += [f"{mode}: {each}" for each in wrong_colours(file, mode)]
        page.get_by_role("button", name="Night / day").click(force=True)
    return found
