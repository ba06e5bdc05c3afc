"""The consoles in a real Chromium: every control, axe-core, the lock, the stop, a browser that vanishes."""

from __future__ import annotations

import json
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
ROOT = Path(__file__).parents[3]
FLAGS = [
    "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip
PATHS = ("/", "/focus", "/alignment", "/maintenance", "/dome", "/bus", "/calibrate")
LONG_MS = 90_000
STOP_COMMAND, STOP_OPCODE = "091#11", "11"
"""AXIS_RA_COMMAND, device type, opcode STOP (docs/protocol.md)."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        CHROMIUM is None, reason="Chromium is not installed: the consoles cannot be looked at"
    ),
    pytest.mark.timeout(600),
]


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


class Served:
    """`schmidt serve` with consoles, as a user starts it."""

    def __init__(self, folder: Path, speed: float) -> None:
        self.folder = folder
        self.port, self.control = free_port(), free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.said = (folder / "said.txt").open("w")
        self.process = subprocess.Popen(
            [
                sys.executable, "-c", "from scenarios.cli import main; main()", "serve",
                str(ROOT / "scenarios" / "observing-night.yaml"), "--console", str(self.port),
                "--control", str(self.control), "--speed", str(speed),
                "--runs", str(folder / "runs"), "--record", str(folder / "record"),
            ],
            cwd=ROOT, stdout=self.said, stderr=subprocess.STDOUT,
        )  # fmt: skip
        end = time.monotonic() + 120
        while time.monotonic() < end:
            try:
                self.ask("status")
                break
            except OSError:
                assert self.process.poll() is None, (folder / "said.txt").read_text()
                time.sleep(0.2)

    def ask(self, line: str) -> str:
        with socket.create_connection(("127.0.0.1", self.control), 10) as s:
            s.sendall(line.encode() + b"\n")
            return s.makefile().readline()

    def seconds(self) -> float:
        return float(json.loads(self.ask("status").removeprefix("ok "))["simulated_s"])

    def end(self) -> None:
        if self.process.poll() is None:
            self.ask("stop")
        self.process.wait(60)
        self.said.close()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as p:
        made = p.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    made = Served(tmp_path_factory.mktemp("consoles"), 1.0)
    yield made
    made.end()


def opened(browser: Any, served: Served, path: str) -> Any:
    page = browser.new_page(viewport={"width": 1400, "height": 1000})
    page.set_default_timeout(LONG_MS)
    page.goto(served.url + path)
    page.get_by_role("status").first.wait_for()
    page.wait_for_timeout(1500)
    return page


def state(page: Any, pattern: str) -> None:
    """Wait until the state line says this."""
    page.wait_for_function(
        "text => new RegExp(text).test(document.querySelector('[role=status]').textContent)", arg=pattern
    )


def choose(page: Any, label: str, name: str) -> None:
    page.get_by_label(label).click()
    page.get_by_role("option", name=name, exact=True).click()


def press(page: Any, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).click()


@pytest.mark.parametrize("mode", ["night", "day"])
@pytest.mark.parametrize("path", PATHS)
def test_axe_finds_nothing_on_any_page(browser: Any, served: Served, path: str, mode: str) -> None:
    from axe_playwright_python.sync_playwright import Axe

    page = opened(browser, served, path)
    if mode == "day":
        press(page, "Night / day")
        page.wait_for_timeout(400)
    found = Axe().run(page).response["violations"]
    shots = ROOT / "out" / "consoles"
    shots.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=str(shots / f"{path.strip('/') or 'main'}-{mode}.png"), full_page=True)
    page.close()
    assert [(v["id"], [n["html"][:120] for n in v["nodes"][:3]]) for v in found] == []


def test_a_night_by_hand(browser: Any, served: Served) -> None:
    """Every control of the main console, in the order of an evening."""
    page = opened(browser, served, "/")
    press(page, "Health check")
    page.get_by_text("healthy").first.wait_for()
    press(page, "Power on")
    page.get_by_text("motors on").first.wait_for()
    choose(page, "Named star", "Capella")
    press(page, "Go")
    state(page, "slewing")
    press(page, "Abort slew")
    state(page, "tracking|stopping|idle")
    press(page, "Stop tracking")
    state(page, "^idle")
    page.get_by_text("fine", exact=True).click()
    north = page.get_by_label("Move N ↑")
    north.hover()
    page.mouse.down()
    state(page, "moved by hand")
    page.mouse.up()
    state(page, "^(idle|stopping|tracking)")
    press(page, "Track")
    state(page, "^tracking")
    page.keyboard.press("ArrowUp")
    page.wait_for_timeout(500)
    choose(page, "Parameter", "counter_split_percent")
    press(page, "Read")
    page.wait_for_function("document.querySelector('input[aria-label=Value]').value !== '0'")
    press(page, "Write")
    page.get_by_text(re.compile("counter_split_percent is")).first.wait_for()
    page.get_by_label("RA, ICRS").fill("nonsense")
    page.get_by_label("Dec, ICRS").fill("+10:00:00")
    press(page, "Go")
    page.get_by_text(re.compile("cannot be read")).first.wait_for()
    page.locator("h1").click()  # no input has the focus
    page.keyboard.press("Space")
    state(page, "^(stopping|idle)")
    page.close()


def test_the_lock_greys_everything_but_the_way_out_and_the_stop(browser: Any, served: Served) -> None:
    page = opened(browser, served, "/")
    press(page, "Lock")
    page.get_by_role("button", name="Unlock").wait_for()
    page.wait_for_timeout(800)
    free = [" ".join(b.inner_text().split()) for b in page.get_by_role("button").all() if b.is_enabled()]
    assert sorted(free) == ["Night / day", "STOP (space)", "Unlock"]
    press(page, "STOP  (space)")
    page.wait_for_timeout(600)
    press(page, "Unlock")
    page.get_by_role("button", name="Lock", exact=True).wait_for()
    page.wait_for_timeout(800)
    assert page.get_by_role("button", name="Power on").is_enabled()
    page.close()


def test_the_space_bar_stops_also_when_a_button_has_the_focus(browser: Any, served: Served) -> None:
    """A focused Track button would start the tracking again."""
    page = opened(browser, served, "/")
    press(page, "Power on")
    page.get_by_text("motors on").first.wait_for()
    press(page, "Track")
    state(page, "^tracking")
    page.keyboard.press("Space")
    state(page, "^(stopping|idle)")
    page.wait_for_timeout(2000)
    state(page, "^idle")
    page.close()


def test_focus(browser: Any, served: Served) -> None:
    page = opened(browser, served, "/focus")
    press(page, "Motor power OFF: hold")
    page.get_by_text("hold").first.wait_for()
    press(page, "Focus +1 half steps")
    page.get_by_text("+1 half steps").first.wait_for()
    press(page, "Focus -1 half steps")
    page.get_by_text("+0 half steps").first.wait_for()
    press(page, "Focus +10 half steps")
    page.get_by_text("+10 half steps").first.wait_for()
    press(page, "Focus -10 half steps")
    page.get_by_role("spinbutton", name="Half steps").fill("40")
    press(page, "Move To")
    page.get_by_text("+40 half steps").first.wait_for()
    press(page, "Find reference")
    page.get_by_text(re.compile(r"(?<!not )referenced$")).first.wait_for()
    press(page, "Control power OFF: free")
    page.get_by_text("free, not referenced").first.wait_for()
    press(page, "Move To")
    page.get_by_text(re.compile("the focus is free")).first.wait_for()
    press(page, "Motor power OFF: hold")
    page.get_by_text(re.compile("^hold")).first.wait_for()
    page.close()


def test_alignment_refuses_a_star_that_is_somewhere_else(browser: Any, served: Served) -> None:
    page = opened(browser, served, "/alignment")
    choose(page, "Star in the middle of the field", "Fomalhaut")
    press(page, "Align on this star")
    page.get_by_text(re.compile("not the same star")).first.wait_for()
    page.close()


def test_the_bus_shows_a_board_that_loses_its_supply(browser: Any, served: Served) -> None:
    page = opened(browser, served, "/bus")
    choose(page, "Board", "DISPLAY")
    press(page, "Cut its supply")
    row = page.locator("tr", has=page.get_by_role("cell", name="DISPLAY", exact=True)).first
    row.get_by_text("OFF").wait_for()
    press(page, "Give it back")
    row.get_by_text("on", exact=True).wait_for()
    page.get_by_label("Follow the frames").click()
    page.close()


def test_a_recorded_run_goes_to_the_finder_and_its_report_is_shown(browser: Any, served: Served) -> None:
    page = opened(browser, served, "/calibrate")
    press(page, "Start a run")
    page.get_by_text("recording run 1").wait_for()
    page.wait_for_timeout(3000)
    press(page, "End the run")
    page.get_by_text("1 runs recorded").wait_for()
    page.get_by_text("dec", exact=True).click()
    page.get_by_text("ra", exact=True).click()
    press(page, "Calibrate on the recorded runs")
    link = page.get_by_role("link", name="Report")
    link.wait_for()
    answer = page.request.get(served.url + link.get_attribute("href"))
    assert answer.ok and "<html" in answer.text()
    page.close()


def test_a_browser_that_vanishes_lets_go_of_the_paddle(browser: Any, served: Served) -> None:
    page = opened(browser, served, "/")
    press(page, "Power on")
    page.get_by_text("motors on").first.wait_for()
    page.get_by_label("Move W →").hover()
    page.mouse.down()
    state(page, "moved by hand")
    page.close()
    other = opened(browser, served, "/")
    state(other, "^(idle|tracking|stopping)")
    other.close()


def test_the_stop_is_in_force_within_100_ms_of_the_click(browser: Any, tmp_path: Path) -> None:
    """At a fifth of real time the browser's own way costs little; the axis' command is timed on the bus."""
    served = Served(tmp_path, 0.2)
    try:
        page = opened(browser, served, "/")
        press(page, "Power on")
        page.get_by_text("motors on").first.wait_for()
        page.get_by_label("Move W →").hover()
        page.mouse.down()
        state(page, "moved by hand")
        button = page.get_by_role("button", name="STOP  (space)")
        clicked_s = served.seconds()
        button.evaluate("element => element.click()")
        page.wait_for_timeout(3000)
        page.close()
    finally:
        served.end()
    commands = [
        float(line[1:].split(")")[0])
        for line in (tmp_path / "record" / "can.log").read_text().splitlines()
        if f" {STOP_COMMAND}{STOP_OPCODE}" in line
    ]
    first = min(t for t in commands if t >= clicked_s)
    assert first - clicked_s <= 0.1
