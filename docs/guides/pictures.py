"""`python docs/guides/pictures.py FOLDER`: pictures of the guides, from what their commands left in FOLDER.

Needs Chromium. What a terminal or the console shows comes from a command that is run here. `--console` makes
the console's picture alone, and needs no FOLDER.
"""

import html
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

HERE = Path(__file__).parent
SHOTS = (
    ("out/my-night/report.html", "my-night.png", 900),
    ("out/bad-night/report.html", "bad-night.png", 652),
    ("out/example/report.html", "calibrated.png", 985),
)
TERMINALS = (
    ("schmidt conformance --board axis:0x11 --board axis:0x10", "conformance.png", None),
    ("schmidt serve --lx200 4030 --serial pty:out/ports --control 7411 --duration 1", "serve.png", 4),
)
"""Command, picture, and how many of its lines are shown (None: all)."""
HIDDEN = " --duration 1"
"""Ends a command whose picture shows it without an end."""
CONSOLE = "schmidt serve observing-night --console PORT --speed 5"
CONSOLE_SIZE = (1400, 800)
"""Width and height of the console's picture: its upper half."""
FOLLOWED_S = 125
"""Emulated time for which the star is followed: the plots reach back two minutes."""
SLOW_MS = 180_000
WIDTH = 1000
STYLE = "margin:0;padding:16px;background:#16202c;color:#eef2f6;font:15px/1.35 'DejaVu Sans Mono',monospace"


def page(browser: Browser, address: str, target: Path, height: int) -> None:
    """The top of a page as a browser shows it."""
    shown = browser.new_page(viewport={"width": WIDTH, "height": height})
    shown.goto(address)
    shown.screenshot(path=target)
    shown.close()


def terminal(browser: Browser, command: str, lines: int | None, folder: Path, target: Path) -> None:
    """A command and what it printed."""
    words = [str(Path(sys.executable).with_name("schmidt")), *command.split()[1:]]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    shows = "\n".join(done.stdout.splitlines()[:lines])
    text = html.escape(f"$ {command.removesuffix(HIDDEN)}\n{shows}".replace(f"{folder}/", ""))
    shown = browser.new_page(viewport={"width": WIDTH, "height": 100})
    shown.set_content(f'<pre style="{STYLE};display:inline-block">{text}</pre>')
    shown.locator("pre").screenshot(path=target)
    shown.close()


def clock_s(shown: Page) -> int:
    """Seconds of the day that the console's clock shows."""
    found = re.search(r"UTC\s+(?:\S+ )?(\d\d):(\d\d):(\d\d)", shown.inner_text("body"))
    assert found, "no clock on the page"
    hours, minutes, seconds = map(int, found.groups())
    return hours * 3600 + minutes * 60 + seconds


def console(browser: Browser, target: Path) -> None:
    """The main console, two minutes after Go."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    words = [
        str(Path(sys.executable).with_name("schmidt")),
        *(port if word == "PORT" else word for word in CONSOLE.split()[1:]),
    ]
    width, height = CONSOLE_SIZE
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as serving:
        try:
            assert serving.stdout
            next(line for line in serving.stdout if "serving" in line)
            shown = browser.new_page(viewport={"width": width, "height": height})
            shown.set_default_timeout(SLOW_MS)
            shown.goto(f"http://127.0.0.1:{port}/")
            shown.get_by_role("button", name="Power on", exact=True).click()
            shown.get_by_text("motors on", exact=True).wait_for()
            star = shown.get_by_label("Name", exact=True)
            star.fill("Pollux")
            shown.get_by_role("option", name="Pollux").click()
            shown.get_by_role("button", name="Go", exact=True).click()
            shown.get_by_text(re.compile("^tracking, Pollux")).first.wait_for()
            begun_s = clock_s(shown)
            while clock_s(shown) < begun_s + FOLLOWED_S:
                shown.wait_for_timeout(1000)
            shown.mouse.move(0, 0)
            shown.evaluate("scrollTo(0, 0)")
            shown.wait_for_timeout(1000)
            shown.screenshot(path=target)
            shown.close()
        finally:
            serving.terminate()


def main(arguments: list[str]) -> None:
    """Make all pictures."""
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        console(browser, HERE.parent / "reference" / "consoles" / "main.png")
        if arguments == ["--console"]:
            return
        folder = Path(arguments[0])
        for name, target, height in SHOTS:
            page(browser, f"file://{(folder / name).resolve()}", HERE / target, height)
        for command, target, lines in TERMINALS:
            terminal(browser, command, lines, folder.resolve(), HERE / target)
    shutil.copy(folder / "out/bad-night/tracking.png", HERE / "bad-night-tracking.png")


if __name__ == "__main__":
    main(sys.argv[1:])
