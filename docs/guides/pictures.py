"""`python docs/guides/pictures.py FOLDER`: the pictures of the guides, from what the guides' commands left in
FOLDER. Needs Chromium; what a terminal shows comes from a command that is run here."""

import html
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

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
    text = html.escape(f"$ {command}\n{shows}".replace(f"{folder}/", ""))
    shown = browser.new_page(viewport={"width": WIDTH, "height": 100})
    shown.set_content(f'<pre style="{STYLE};display:inline-block">{text}</pre>')
    shown.locator("pre").screenshot(path=target)
    shown.close()


def main(folder: Path) -> None:
    """Make all pictures."""
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for name, target, height in SHOTS:
            page(browser, f"file://{(folder / name).resolve()}", HERE / target, height)
        for command, target, lines in TERMINALS:
            terminal(browser, command, lines, folder.resolve(), HERE / target)
    shutil.copy(folder / "out/bad-night/tracking.png", HERE / "bad-night-tracking.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
