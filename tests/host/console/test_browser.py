"""The consoles in a real Chromium: every control of every page, axe-core, the lock, a browser that goes."""

import os
import re
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from tests.host.console.conftest import PATHS, Consoles, Used, choose, opened, press, shot, state

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]
SPEEDS = ("slew", "set", "guide", "fine")
_OVER = """[...document.querySelectorAll('.box')].filter(box => box.scrollWidth > box.clientWidth + 1)
.map(box => box.querySelector('h2').textContent)"""
"""Cards that something runs out of."""
_BARE = """() => {
  const at = [...document.querySelectorAll('.sky-star, .sky-cloud')].map(
    each => [each.getAttribute('cx'), each.getAttribute('cy')]);
  for (let k = 0; k < 4000; k++) {
    const [x, y] = [Math.sqrt(k) * Math.cos(2.4 * k), Math.sqrt(k) * Math.sin(2.4 * k)];
    if (at.every(([cx, cy]) => Math.hypot(cx - x, cy - y) > 3)) return [x, y];
  }
}"""
"""A place of the chart with nothing near it."""
FRAMEWORK = ["#popup"]
"""NiceGUI's own notice of a lost connection, which a busy machine may show."""
KEYS = ("Move N ↑", "Move S ↓", "Move E ←", "Move W →")


@pytest.mark.parametrize("path", PATHS)
def test_axe_finds_nothing_on_any_page(browser: Any, served: Consoles, path: str) -> None:
    from axe_playwright_python.sync_playwright import Axe

    page = opened(browser, served, path)
    found = []
    for mode in ("night", "day"):
        found += Axe().run(page, {"exclude": [FRAMEWORK]}).response["violations"]
        assert page.evaluate(_OVER) == []
        page.wait_for_timeout(500)  # plots are drawn anew once a second
        shot(page, f"{path.strip('/') or 'main'}-{mode}")
        press(page, "Night / day")
        page.locator("body.day" if mode == "night" else "body:not(.day)").wait_for()
    press(page, "Night / day")
    page.reload()
    page.locator("body.day").wait_for()  # remembered from page to page
    page.close()
    assert [(v["id"], [n["html"][:120] for n in v["nodes"][:3]]) for v in found] == []


def test_a_night_by_hand(browser: Any, served: Consoles) -> None:
    """Every control of the main console, in the order of an evening."""
    used = Used()
    page = opened(browser, served, "/", used)
    press(page, "Health check")
    page.get_by_text("healthy").first.wait_for()
    press(page, "Power on")
    page.get_by_text("motors on", exact=True).first.wait_for()
    choose(page, "Name", "Capella")
    press(page, "Go")
    state(page, "Capella")  # slewing, or there already when the browser is held up
    press(page, "Abort slew")
    state(page, "tracking|stopping|idle")
    press(page, "Stop tracking")
    state(page, "^idle")
    for speed, key in zip(SPEEDS, KEYS, strict=True):
        _paddle(page, speed, key)
    press(page, "Track")
    state(page, "^tracking")
    _parameters(page)
    page.get_by_label("RA, ICRS").fill("nonsense")
    page.get_by_label("Dec, ICRS").fill("+10:00:00")
    press(page, "Go")
    page.get_by_text(re.compile("cannot be read")).first.wait_for()
    _frame(page)
    press(page, "Park")
    state(page, "parked")
    press(page, "Unpark")
    page.get_by_text("motors on", exact=True).first.wait_for()
    press(page, "Power off")
    page.get_by_text("motors off", exact=True).first.wait_for()
    shot(page, "main-after-a-night")
    left = used.untouched(page)
    page.close()
    assert left == set()


def _paddle(page: Any, speed: str, key: str) -> None:
    page.get_by_role("radio", name=speed, exact=True).click()
    page.get_by_label(key).hover()
    page.mouse.down()
    state(page, "moved by hand")
    page.mouse.up()
    state(page, "^(idle|stopping|tracking)")


def _parameters(page: Any) -> None:
    choose(page, "Board", "Dec axis")
    choose(page, "Parameter", "counter_split_percent")
    press(page, "Read")
    page.wait_for_function("document.querySelector('input[aria-label=Value]').value !== '0'")
    page.get_by_label("Value", exact=True).fill("15")
    press(page, "Write")
    page.get_by_text("counter_split_percent is 15").first.wait_for()


def _frame(page: Any) -> None:
    """What every page has: mode, lock, stop, and the ways to the other pages."""
    press(page, "Night / day")
    press(page, "Night / day")
    press(page, "Lock")
    page.get_by_role("button", name="Unlock").click()
    page.get_by_role("button", name="Lock", exact=True).wait_for()
    page.wait_for_function("!document.querySelector('main button[disabled], section button[disabled]')")
    press(page, "STOP  (space)")
    state(page, "^(stopping|idle)")
    for name, path in (
        ("Focus", "/focus"), ("Alignment", "/alignment"), ("Maintenance", "/maintenance"),
        ("Dome and weather", "/dome"), ("Bus", "/bus"), ("Calibrate", "/calibrate"), ("Main", "/"),
    ):  # fmt: skip
        page.get_by_role("link", name=name, exact=True).click()
        page.wait_for_url(f"**{path}", wait_until="commit")  # the state line comes last; "load" can be missed
        state(page, "idle|stopping|tracking")


def test_the_lock_greys_everything_but_the_way_out_and_the_stop(browser: Any, served: Consoles) -> None:
    page = opened(browser, served, "/")
    press(page, "Lock")
    page.get_by_role("button", name="Unlock").wait_for()
    page.wait_for_function("document.querySelectorAll('button:not([disabled])').length === 3")
    free = [" ".join(b.inner_text().split()) for b in page.get_by_role("button").all() if b.is_enabled()]
    assert sorted(free) == ["Night / day", "STOP (space)", "Unlock"]
    shot(page, "main-locked")
    press(page, "STOP  (space)")
    press(page, "Unlock")
    page.get_by_role("button", name="Lock", exact=True).wait_for()
    page.wait_for_function("!document.querySelector('section button[disabled]')")
    assert page.get_by_role("button", name="Power on").is_enabled()
    page.close()


def _below(pid: int) -> list[int]:
    """The browser's own processes, and what drives it."""
    said = subprocess.run(["pgrep", "-P", str(pid)], capture_output=True, text=True, check=False).stdout
    made = [int(each) for each in said.split() if Path(f"/proc/{each}").exists()]
    return made + [below for each in made for below in _below(each)]


def test_a_click_counts_after_a_busy_machine_has_held_the_browser_up(browser: Any, served: Consoles) -> None:
    page = opened(browser, served, "/")
    made = [pid for pid in _below(os.getpid()) if "--type=" in Path(f"/proc/{pid}/cmdline").read_text()]
    assert made
    for kind in (signal.SIGSTOP, signal.SIGCONT):
        for pid in made:
            os.kill(pid, kind)
        time.sleep(4.0 if kind == signal.SIGSTOP else 0.0)
    press(page, "Lock")
    press(page, "Unlock")
    page.get_by_role("button", name="Lock", exact=True).wait_for()
    page.close()


def test_a_click_on_the_sky_chooses_and_a_double_click_goes(browser: Any, served: Consoles) -> None:
    page = opened(browser, served, "/")
    sky = page.locator(".sky")
    for text in ("points at altitude", "GATEWAY", "rms of 120 s"):  # nothing moves any more
        page.get_by_text(text).first.wait_for()
    sky.get_by_text("Capella").wait_for()
    page.wait_for_timeout(2000)
    star = sky.get_by_text("Capella").bounding_box()
    zoom = sky.bounding_box()["width"] / 240
    place = (star["x"] + star["width"] / 2, star["y"] + star["height"] + 1.6 * zoom)
    page.mouse.click(*place)
    page.wait_for_function("document.querySelector('input[aria-label=Name]').value === 'Capella'")
    page.mouse.dblclick(*place)
    state(page, "^tracking, Capella")
    page.get_by_role("log", name="Night log").get_by_text("Tracking Capella").wait_for()
    served.wait(served.status()["simulated_s"] + 20.0)
    page.get_by_text(re.compile(r"rms of 120 s: RA \d")).wait_for()
    shot(page, "main-tracking")
    press(page, "Night / day")
    page.wait_for_timeout(1500)
    shot(page, "main-tracking-day")
    box, spot = sky.bounding_box(), page.evaluate(_BARE)
    page.mouse.click(box["x"] + (120 + spot[0]) * zoom, box["y"] + (120 + spot[1]) * zoom)
    page.wait_for_function("!document.querySelector('input[aria-label=Name]').value")
    page.wait_for_function("/^\\d\\dh/.test(document.querySelector('input[aria-label=\"RA, ICRS\"]').value)")
    press(page, "STOP  (space)")
    state(page, "^idle")
    page.close()


def tracking(browser: Any, served: Consoles) -> Any:
    """The main console of a telescope that tracks; Track has the focus."""
    page = opened(browser, served, "/")
    press(page, "Power on")
    page.get_by_text("motors on", exact=True).first.wait_for()
    press(page, "Track")
    state(page, "^tracking")
    return page


def test_the_space_bar_stops_also_when_a_button_has_the_focus(browser: Any, served: Consoles) -> None:
    """A focused Track button would start the tracking again."""
    page = tracking(browser, served)
    page.keyboard.press("Space")
    state(page, "^idle")
    served.wait(served.status()["simulated_s"] + 5.0)
    state(page, "^idle")
    page.close()


def test_enter_on_the_stop_stops(browser: Any, served: Consoles) -> None:
    """The button acts when it is pressed; a key has no press, and must not be passed over."""
    page = tracking(browser, served)
    page.get_by_role("button", name="STOP  (space)").focus()
    page.keyboard.press("Enter")
    state(page, "^idle")
    page.close()


def test_focus(browser: Any, served: Consoles) -> None:
    used = Used()
    page = opened(browser, served, "/focus", used)
    press(page, "Motor power OFF: hold")
    page.get_by_text("hold").first.wait_for()
    press(page, "Focus +1 half steps")
    page.get_by_text("+1 half steps").first.wait_for()
    press(page, "Focus -1 half steps")
    page.get_by_text("+0 half steps").first.wait_for()
    press(page, "Focus +10 half steps")
    page.get_by_text("+10 half steps").first.wait_for()
    press(page, "Focus -10 half steps")
    page.get_by_text("+0 half steps").first.wait_for()
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
    _curve(page)
    left = used.untouched(page, "section")
    page.close()
    assert left == set()


def _curve(page: Any) -> None:
    """Widths of a star at five places: (x - 20)² / 100 + 4 is width², so the best focus is at 20."""
    press(page, "Go to the best focus")
    page.get_by_text(re.compile("needs 4 positions")).wait_for()
    for place in (-20, 0, 20, 40, 60):
        page.get_by_role("spinbutton", name="Half steps").fill(str(place))
        press(page, "Move To")
        page.get_by_text(f"{place:+d} half steps", exact=True).wait_for()
        page.get_by_label("Star width here").fill(f"{((place - 20) ** 2 / 100 + 4) ** 0.5:.4f}")
        press(page, "Add this point")
    page.get_by_text("best focus at +20 half steps").wait_for()
    press(page, "Go to the best focus")
    page.get_by_text("+20 half steps", exact=True).wait_for()
    shot(page, "focus-curve")
    press(page, "Clear the points")
    page.get_by_text("0 points").wait_for()


def test_alignment_on_the_star_that_is_followed_and_not_on_another(browser: Any, served: Consoles) -> None:
    main = opened(browser, served, "/")
    choose(main, "Name", "Pollux")
    press(main, "Go")
    state(main, "^tracking, Pollux")
    used = Used()
    page = opened(browser, served, "/alignment", used)
    choose(page, "Star in the middle of the field", "Fomalhaut")
    press(page, "Align on this star")
    page.get_by_text(re.compile("not the same star")).first.wait_for()
    choose(page, "Star in the middle of the field", "Pollux")
    press(page, "Align on this star")
    page.get_by_text(re.compile("^aligned: hour angle")).first.wait_for()
    page.get_by_text(re.compile("^Stars aligned on: [1-9].*; the telescope points by no model")).wait_for()
    press(page, "Apply")
    page.get_by_text(re.compile("fit a model first")).first.wait_for()
    press(page, "Fit")
    page.get_by_text(re.compile("needs 6 stars, there are")).first.wait_for()
    press(page, "Without model")
    shot(page, "alignment-aligned")
    left = used.untouched(page, "section:first-child")
    page.close()
    press(main, "STOP  (space)")
    main.close()
    assert left == set()


def test_the_bus_shows_a_board_that_loses_its_supply(browser: Any, served: Consoles) -> None:
    used = Used()
    page = opened(browser, served, "/bus", used)
    choose(page, "Board", "DISPLAY")
    press(page, "Cut its supply")
    row = page.locator("tr", has=page.get_by_role("cell", name="DISPLAY", exact=True)).first
    row.get_by_text("OFF").wait_for()
    shot(page, "bus-display-off")
    press(page, "Give it back")
    row.get_by_text("on", exact=True).wait_for()
    page.get_by_label("Follow the frames").click()
    _bit_errors(page)
    left = used.untouched(page, "section")
    page.close()
    assert left == set()


def _bit_errors(page: Any) -> None:
    """A fault of the bus, wrong at first, then on, then cleared."""
    choose(page, "Fault", "bus: bit_errors")
    arguments = page.get_by_label("Arguments, name=value")
    arguments.fill("probability=200_%")
    press(page, "Start it")
    page.get_by_text(re.compile("out of range")).first.wait_for()
    arguments.fill("probability=5_%")
    press(page, "Start it")
    page.get_by_role("cell", name=re.compile("^bit_errors, probability=0.05")).wait_for()
    page.get_by_text(re.compile("(bit|crc|stuff|form) [1-9]")).first.wait_for()
    shot(page, "bus-bit-errors")
    page.get_by_role("spinbutton", name="Number").fill("0")
    press(page, "Clear it")
    page.get_by_role("cell", name=re.compile("^bit_errors")).wait_for(state="detached")


def test_a_recorded_run_goes_to_the_finder_and_its_report_is_shown(browser: Any, served: Consoles) -> None:
    used = Used()
    page = opened(browser, served, "/calibrate", used)
    press(page, "Start a run")
    page.get_by_text("recording run 1").wait_for()
    served.wait(served.status()["simulated_s"] + 10.0)
    press(page, "End the run")
    page.get_by_text("1 runs recorded").wait_for()
    page.get_by_role("radio", name="dec", exact=True).click()
    page.get_by_role("radio", name="ra", exact=True).click()
    press(page, "Calibrate on the recorded runs")
    link = page.get_by_role("link", name="Report")
    link.wait_for()
    shot(page, "calibrate-report")
    answer = page.request.get(served.url + link.get_attribute("href"))
    assert answer.ok and "<html" in answer.text()
    left = used.untouched(page, "section")
    page.close()
    assert left <= {"Report"}


def test_a_browser_that_vanishes_lets_go_of_the_paddle(browser: Any, served: Consoles) -> None:
    page = opened(browser, served, "/")
    press(page, "Power on")
    page.get_by_text("motors on", exact=True).first.wait_for()
    page.get_by_label("Move W →").hover()
    page.mouse.down()
    state(page, "moved by hand")
    page.close()
    other = opened(browser, served, "/")
    state(other, "^(idle|tracking|stopping)")
    other.close()


def test_dome_and_weather_on_the_network_that_has_them(browser: Any, tmp_path: Path) -> None:
    scenario = tmp_path / "final.yaml"
    scenario.write_text(
        "name: All nodes\nstart_utc: 2026-02-10T14:00:00Z\nnetwork: {name: final}\n"
        "steps:\n  - wait: {for: 1 s}\n"
    )
    used = Used()
    with Consoles(tmp_path, 5.0, str(scenario)) as served:
        page = opened(browser, served, "/dome", used)
        page.get_by_text(re.compile(r"azimuth \d")).first.wait_for()
        page.get_by_text("mast", exact=True).wait_for()
        page.get_by_label("Azimuth, °").fill("90")
        press(page, "Turn")
        page.get_by_text(re.compile("turning to 90.0°")).first.wait_for()
        press(page, "Follow the telescope")
        page.get_by_text(re.compile("The slit follows the telescope")).wait_for()
        press(page, "Turn")
        page.get_by_text(re.compile("end that first")).wait_for()
        press(page, "Stay")
        page.get_by_text(re.compile("The slit stays where it is")).wait_for()
        press(page, "Stop dome")
        page.get_by_text(re.compile(r"azimuth \d+\.\d°; shutter")).first.wait_for()
        press(page, "Open shutter")
        page.get_by_text(re.compile("shutter .*(moving|open)")).first.wait_for()
        press(page, "Close shutter")
        page.get_by_text(re.compile("shutter closed")).first.wait_for()
        page.get_by_text("Interlock: the shutter may open.").wait_for()
        assert page.evaluate(_OVER) == []
        shot(page, "dome-final")
        left = used.untouched(page, "section:first-child")
        page.close()
    assert left == set()


def test_a_silent_board_is_an_alarm_on_every_page_until_it_is_acknowledged(
    browser: Any, served: Consoles
) -> None:
    page, other = opened(browser, served, "/"), opened(browser, served, "/bus")
    choose(other, "Board", "POSITION_RA")
    press(other, "Cut its supply")
    for each in (page, other):
        each.get_by_role("alert").get_by_text("POSITION_RA is silent").wait_for()
    assert page.locator(".stale").count() >= 4  # RA, hour angle, altitude, azimuth, errors
    for width, height in ((1400, 700), (390, 800)):
        page.set_viewport_size({"width": width, "height": height})
        page.mouse.wheel(0, 1500)
        page.wait_for_function("scrollY > 100")
        for seen in (page.get_by_role("button", name="STOP  (space)"), page.locator(".alarms")):
            box = seen.bounding_box()
            assert box["y"] >= 0 and box["y"] + box["height"] <= height
        shot(page, f"alarms-{width}")
        page.evaluate("scrollTo(0, 0)")
    press(other, "Give it back")
    page.wait_for_function("!document.querySelector('.stale')")
    other.get_by_role("alert").get_by_text("(over)").first.wait_for()
    press(other, "Acknowledge")
    for each in (page, other):
        each.locator(".alarms").wait_for(state="hidden")
        each.close()
