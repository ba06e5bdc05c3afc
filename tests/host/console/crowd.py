"""Ten browsers at once: `python -m tests.host.console.crowd [--browsers 10] [--seconds 60]` with --realtime,
--apart or both.

Prints the ticks that were late without and with them. --realtime is `schmidt serve --realtime`, as a user
would on a machine that has other work: then the browsers' own appetite for the processor does not count, only
what they ask of the server. A loop that only sleeps then runs on the same core, ahead of the server; a tick
is the server's own fault when that loop was not held up for half of the tick's lateness. --apart keeps the
browsers on one core and the server, its host with it, on another: the nearest that one machine comes to
browsers on others.
"""

import argparse
import json
import os
import tempfile
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from tests.host.console.conftest import CHROMIUM, FLAGS, NIGHT, PATHS, Consoles, opened
from tests.host.console.stalls import Stalls

MACHINES = 0.5
"""Share of a tick's lateness in which the machine ran nobody, from which the tick is the machine's."""


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
    """A line or two of figures. Raises AssertionError when a page does not live, or a board does not."""
    from playwright.sync_api import sync_playwright

    cores(apart, server=True)
    with Consoles(folder, 1.0, NIGHT, "--realtime" if realtime else "--no-realtime") as served:
        cores(apart, server=False)
        core = max(os.sched_getaffinity(served.process.pid))
        if realtime:
            # all of its threads: one that holds Python's lock on a core that is held up stalls the ticks, too
            for thread in Path(f"/proc/{served.process.pid}/task").iterdir():
                os.sched_setaffinity(int(thread.name), {core})
        with Stalls(core, folder / "stalls") if realtime else nullcontext() as stalls:
            start = served.status()
            time.sleep(seconds / 4)
            alone = served.status()
            with sync_playwright() as p, p.chromium.launch(executable_path=CHROMIUM, args=FLAGS) as browser:
                pages = [opened(browser, served, PATHS[k % len(PATHS)]) for k in range(count)]
                opening, from_s = served.status(), time.perf_counter()
                time.sleep(seconds)
                after, to_s = served.status(), time.perf_counter()
                when = json.loads(served.ask("late").removeprefix("ok "))
                lives = [page.get_by_role("status").first.inner_text() != "" for page in pages]
                for page in pages:
                    page.close()
    assert all(lives) and len(lives) == count
    assert all(after["boards"].values())
    quiet, quiet_late = late(start, alone)
    crowded, crowded_late = late(opening, after)
    said = (
        f"without a browser {quiet_late} of {quiet} ticks late; with {count} browsers for {seconds:.0f} s"
        f" {crowded_late} of {crowded} ({1 - crowded_late / max(1, crowded):.2%} on time), pace"
        f" {(after['simulated_s'] - opening['simulated_s']) / seconds:.2f}; load {os.getloadavg()[0]:.1f} on"
        f" {os.cpu_count()} cores"
    )
    if stalls is not None:
        during = [(due_s, ms * 1e-3) for due_s, ms in when if from_s <= due_s <= to_s]
        own = [ms for ms in during if stalls.share_of(*ms) < MACHINES]
        held = sum(lateness for due, lateness in stalls.found if from_s <= due <= to_s)
        said += (
            f"\nof {len(during)} looked at, {len(own)} by the server itself; the machine held up a loop that"
            f" only sleeps for {held * 1e3:.0f} ms of that time"
        )
    return said


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
