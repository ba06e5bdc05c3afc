"""From the click on STOP to the axes' command on the bus, in emulated time, at several speeds."""

import os
import time
from pathlib import Path
from typing import Any

import pytest

from tests.host.console.conftest import Consoles, opened, press, state

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]
STOP = "091#1111"
"""AXIS_RA_COMMAND, device type, opcode STOP (docs/reference/protocol.md)."""
SPEEDS = (0.2, 1.0, 10.0)
PRESS_S = 0.08
"""Wall time from a button's press to its release, the click. ASSUMPTION: people take 80 to 120 ms."""
BOUND_S = 0.1


def stop_s(browser: Any, folder: Path, speed: float) -> tuple[float, float]:
    """Emulated seconds to the end of the first STOP on the bus: from before the press, and from before the
    click, which may come later than the stop."""
    with Consoles(folder, 5.0) as served:
        page = opened(browser, served, "/")
        press(page, "Power on")
        page.get_by_text("motors on", exact=True).first.wait_for()
        served.ask(f"speed {speed}")
        page.get_by_label("Move W →").hover()
        page.mouse.down()
        state(page, "moved by hand")
        button = page.get_by_role("button", name="STOP  (space)").element_handle()
        pressed_s = float(served.status()["simulated_s"])
        button.evaluate("element => element.dispatchEvent(new PointerEvent('pointerdown', {bubbles: true}))")
        time.sleep(PRESS_S)
        clicked_s = float(served.status()["simulated_s"])
        button.evaluate(
            "element => element.dispatchEvent(new MouseEvent('click', {bubbles: true, detail: 1}))"
        )
        served.wait(clicked_s + 0.5)
        page.close()
    log = (folder / "record" / "can.log").read_text().splitlines()
    stops = [float(line[1 : line.index(")")]) for line in log if f" {STOP}" in line]
    stopped_s = min(t_s for t_s in stops if t_s >= pressed_s)
    return stopped_s - pressed_s, stopped_s - clicked_s


@pytest.mark.parametrize("speed", SPEEDS)
def test_the_stop_is_in_force_within_100_ms_of_the_click(browser: Any, tmp_path: Path, speed: float) -> None:
    press_s, click_s = stop_s(browser, tmp_path, speed)
    load = os.getloadavg()[0]
    print(
        f"speed {speed:g}: {press_s * 1e3:.0f} ms emulated after the press, "
        f"{click_s * 1e3:.0f} after the click, load {load:.1f}"
    )
    assert click_s <= BOUND_S
