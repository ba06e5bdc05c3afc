"""From the click on STOP to the axes' command on the bus, in emulated time, at several speeds."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from tests.host.console.conftest import Consoles, opened, press, state

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]
STOP = "091#1111"
"""AXIS_RA_COMMAND, device type, opcode STOP (docs/protocol.md)."""
SPEEDS = (0.2, 1.0, 10.0)
BOUND_AT = 0.2
"""There 100 ms are half a second of wall time, which a busy machine's browser keeps too."""


def stop_s(browser: Any, folder: Path, speed: float) -> float:
    """Emulated seconds from before the click to the end of the first STOP on the bus."""
    with Consoles(folder, 5.0) as served:
        page = opened(browser, served, "/")
        press(page, "Power on")
        page.get_by_text("motors on").first.wait_for()
        served.ask(f"speed {speed}")
        page.get_by_label("Move W →").hover()
        page.mouse.down()
        state(page, "moved by hand")
        button = page.get_by_role("button", name="STOP  (space)").element_handle()
        clicked_s = float(served.status()["simulated_s"])
        button.evaluate("element => element.click()")
        served.wait(clicked_s + 0.5)
        page.close()
    log = (folder / "record" / "can.log").read_text().splitlines()
    stops = [float(line[1 : line.index(")")]) for line in log if f" {STOP}" in line]
    return min(t_s for t_s in stops if t_s >= clicked_s) - clicked_s


@pytest.mark.parametrize("speed", SPEEDS)
def test_the_stop_is_in_force_within_100_ms_of_the_click(browser: Any, tmp_path: Path, speed: float) -> None:
    took_s = stop_s(browser, tmp_path, speed)
    load = os.getloadavg()[0]
    print(f"speed {speed:g}: {took_s * 1e3:.0f} ms emulated, load {load:.1f}")
    if speed <= BOUND_AT:
        assert took_s <= 0.1
