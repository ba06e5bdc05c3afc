"""A served network with consoles, a Chromium, and what the tests do on a page."""

import contextlib
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.doors.process import ROOT, Serving
from tests.ports import free_ports

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip
PATHS = ("/", "/focus", "/alignment", "/maintenance", "/dome", "/bus", "/calibrate")
SHOTS = ROOT / "out" / "consoles"
LONG_MS = 120_000
NIGHT = "scenarios/observing-night.yaml"
_CONTROLS = "button, [role=combobox], [role=radio], [role=switch], [role=checkbox], input, a[href]"
_WATCH = """
window.schmidtLabel = element => {
  const at = element.closest('[role=radio], [role=switch], [role=checkbox]') || element;
  const said = at.getAttribute("aria-label") || at.innerText || at.placeholder || "?";
  return said.trim().replace(/\\s+/g, ' ');
};
for (const kind of ['mousedown', 'input']) document.addEventListener(kind, event => {
  const at = event.target.closest('CONTROLS');
  const inside = event.target.closest('label') && event.target.closest('label').querySelector('input');
  if (at || inside) window.schmidtUsed(window.schmidtLabel(at || inside));
}, true);
""".replace("CONTROLS", _CONTROLS)


class Consoles(Serving):
    """`schmidt serve` with consoles, as a user starts it."""

    def __init__(self, folder: Path, speed: float, scenario: str = NIGHT, *words: str) -> None:
        self.folder = folder
        self.port = free_ports()
        self.url = f"http://127.0.0.1:{self.port}"
        super().__init__(
            folder, scenario, "--console", str(self.port), "--speed", str(speed),
            "--runs", str(folder / "runs"), "--record", str(folder / "record"), *words,
        )  # fmt: skip


class Used:
    """What of a page's controls somebody has used, by label."""

    def __init__(self) -> None:
        self.labels: set[str] = set()

    def untouched(self, page: Any, within: str = "body") -> set[str]:
        """Labels of the visible controls within an element that nobody has used."""
        found = page.evaluate(
            "([within, controls]) => [...document.querySelectorAll(controls)]"
            ".filter(each => each.closest(within) && each.offsetParent).map(window.schmidtLabel)",
            [within, _CONTROLS],
        )
        return set(found) - self.labels


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed: the consoles cannot be looked at")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as p:
        made = p.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Any:
    """What the browser showed when a test failed, with the failure and as pictures."""
    report = yield
    made = getattr(item, "funcargs", {}).get("browser")
    if report.failed and made is not None:
        for number, page in enumerate(p for context in made.contexts for p in context.pages):
            with contextlib.suppress(Exception):  # a browser that died must not hide the failure itself
                report.sections.append((f"page {number}", page.inner_text("body")))
                shot(page, f"failed-{item.name}-{number}")
    return report


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Consoles]:
    with Consoles(tmp_path_factory.mktemp("consoles"), 5.0) as made:
        yield made


def opened(browser: Any, served: Consoles, path: str, used: Used | None = None) -> Any:
    """A page that is connected and shows the telescope's state."""
    page = browser.new_page(viewport={"width": 1400, "height": 1000})
    page.set_default_timeout(LONG_MS)
    if used is not None:
        page.expose_function("schmidtUsed", lambda label: used.labels.add(label))
        page.add_init_script(_WATCH)
    page.goto(served.url + path)
    page.get_by_role("status").first.wait_for()
    page.wait_for_function("document.querySelector('[role=status]').textContent !== ''")
    return page


def state(page: Any, pattern: str) -> None:
    """Wait until the state line says this; fails with what the page says in its place."""
    from playwright.sync_api import TimeoutError as Late

    try:
        page.wait_for_function(
            "text => new RegExp(text).test(document.querySelector('[role=status]')?.textContent ?? '')",
            arg=pattern,
        )
    except Late:
        pytest.fail(f"never '{pattern}': {page.evaluate('document.body.innerText')}")


def choose(page: Any, label: str, name: str) -> None:
    """Pick from a list; once more where a busy machine has closed it in between, as anybody would."""
    field = page.get_by_label(label, exact=True)
    for _ in range(3):
        field.click()
        option = page.get_by_role("option", name=name, exact=True)
        if label == "Name":  # a long list: only what is in view is there, and what is typed changes it
            field.fill(name)
            page.wait_for_function("document.querySelectorAll('[role=option]').length < 10")
            page.wait_for_timeout(500)
        option.click()
        option.wait_for(state="hidden")
        page.wait_for_timeout(300)
        if label != "Name" or field.input_value() == name:
            return
    raise AssertionError(f"{name} was not taken")


def press(page: Any, name: str) -> None:
    """Click a button; while the notice of a lost connection stands, nobody would."""
    page.wait_for_function("document.querySelector('#popup')?.ariaHidden !== 'false'")
    page.get_by_role("button", name=name, exact=True).click()


def shot(page: Any, name: str) -> None:
    """Keep a picture of the page."""
    SHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=str(SHOTS / f"{name}.png"), full_page=True)
