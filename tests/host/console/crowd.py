"""Ten browsers at once: `python -m tests.host.console.crowd [--browsers 10] [--seconds 60]` with --realtime,
--apart or both.

Prints the ticks that were late without and with them. --realtime serves under `chrt -r 1`, as a user would on
a machine that has other work: then the browsers' own appetite for the processor does not count, only what
they ask of the server. --apart keeps the browsers on one core and the server, its host with it, on another:
the nearest that one machine comes to browsers on others.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.host.console.conftest import CHROMIUM, FLAGS, PATHS, Consoles, opened


def late(before: dict[str, Any], after: dict[str, Any]) -> tuple[int, int]:
    """Ticks between two looks, and how many of them were more than 1 ms off."""
    ticks = after["ticks"] - before["ticks"]
    on_time = after["ticks"] * after["on_time"] - before["ticks"] * (before["on_time"] or 0.0)
    return ticks, ticks - round(on_time)


def cores(apart: bool, server: bool) -> None:
    """What this process starts from now on runs on these cores."""
    every = sorted(os.sched_getaffinity(os.getppid()))
    if apart:
        os.sched_setaffinity(0, every[:1] if server else every[1:] or every)


def crowd(folder: Path, count: int, seconds: float, realtime: bool = False, apart: bool = False) -> str:
    """One line of figures. Raises AssertionError when a page does not live, or a board does not."""
    from playwright.sync_api import sync_playwright

    cores(apart, server=True)
    with Consoles(folder, 1.0) as served:
        cores(apart, server=False)
        if realtime:
            for thread in os.listdir(f"/proc/{served.process.pid}/task"):
                os.sched_setscheduler(int(thread), os.SCHED_RR, os.sched_param(1))
        start = served.status()
        time.sleep(seconds / 4)
        alone = served.status()
        with sync_playwright() as p, p.chromium.launch(executable_path=CHROMIUM, args=FLAGS) as browser:
            pages = [opened(browser, served, PATHS[k % len(PATHS)]) for k in range(count)]
            opening = served.status()
            time.sleep(seconds)
            after = served.status()
            lives = [page.get_by_role("status").first.inner_text() != "" for page in pages]
            for page in pages:
                page.close()
    assert all(lives) and len(lives) == count
    assert all(after["boards"].values())
    quiet, quiet_late = late(start, alone)
    crowded, crowded_late = late(opening, after)
    return (
        f"without a browser {quiet_late} of {quiet} ticks late; with {count} browsers for {seconds:.0f} s"
        f" {crowded_late} of {crowded} ({1 - crowded_late / max(1, crowded):.2%} on time), pace"
        f" {(after['simulated_s'] - opening['simulated_s']) / seconds:.2f}; load {os.getloadavg()[0]:.1f} on"
        f" {os.cpu_count()} cores"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--browsers", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--realtime", action="store_true")
    parser.add_argument("--apart", action="store_true")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print(crowd(Path(folder), asked.browsers, asked.seconds, asked.realtime, asked.apart))


if __name__ == "__main__":
    main()
