"""What every page is made of: its boxes in their order, the wide ones, and the words that explain."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import pytest
from nicegui import ui

from host.console.pages.alignment import alignment
from host.console.pages.bus import bus
from host.console.pages.calibrate import calibrate
from host.console.pages.dome import dome
from host.console.pages.focus import focus
from host.console.pages.main import main
from host.console.pages.maintenance import maintenance
from host.console.views import FaultKind
from tests.host.console.paper import Page, on_paper

PLOTS = ["Position error, ″", "Rate, ″/s", "Effort, %", "Motor current, A"]
TARGET = ["Go to", "Sky: click to choose, double click to go"]
PADDLE = "Hand paddle (also the arrow keys)"
RUNS = Some(logs=lambda _: [], recording=False, start=None, stop=None, folder=Path())


def with_bus(shell: Any, page: Page) -> None:
    page.bus.boards, page.bus.kinds = ("AXIS_RA",), [FaultKind("noise", "bus", "It rustles.", "", "")]
    bus(shell, page.bus)


PAGES: list[tuple[Callable[..., None], list[str], list[str]]] = [
    (main, ["Where it points (apparent, of date)", "Motors and tracking", PADDLE, *TARGET, "Night log, UTC",
            "Boards", *PLOTS, "Parameters"], []),
    (focus, ["Position", "Move", "Power", "Focus curve"], ["Free lets go of the shaft"]),
    (alignment, ["Reference star", "Encoder offsets", "Pointing model", "Where it points", PADDLE, *TARGET],
     ["1. Go to a star", "2. Choose it here"]),
    (maintenance, ["Motors", "Gear reduction and play", "Encoders", *PLOTS],
     ["By tooth counts 360.", "Combined: the mean weighted by inverse variances"]),
    (dome, ["Dome", "Weather", "Power", *TARGET], []),
    (with_bus, ["Load and errors", "Nodes", "Supply of the boards", "Faults", "Commands and boards, UTC",
                "Frames"], ["It rustles."]),
    (lambda shell, _: calibrate(shell, RUNS), ["Record", "Ask the finder", *PLOTS],  # type: ignore[arg-type]
     ["one file a run"]),
]  # fmt: skip
WIDE = {"Focus curve", "Commands and boards, UTC", "Frames"}


@pytest.mark.parametrize(("builder", "boxes", "words"), PAGES)
def test_a_page_has_its_boxes_in_their_order(
    builder: Callable[..., None], boxes: list[str], words: list[str]
) -> None:
    async def work(page: Page) -> None:
        page.build(lambda shell: builder(shell, page) if builder not in PLAIN else builder(shell)).tick()
        heads = [each for each in page.every(ui.html) if each.content.startswith("<h2>")]
        assert [each.content[4:-5] for each in heads] == boxes
        wide = {each.content[4:-5] for each in heads if "wide" in each.parent_slot.parent.classes}
        assert wide == WIDE & {*boxes}
        for each in words:
            assert any(each in text for text in page.texts()), each
        titles = [each.content for each in page.every(ui.html) if each.content.startswith("<h1>")]
        assert len(titles) == 1

    on_paper(work)


PLAIN = (main, focus, alignment, maintenance, dome)


def full(field: Any) -> bool:
    return "w-full" in field.classes


def test_long_fields_go_over_the_whole_box() -> None:
    async def work(page: Page) -> None:
        page.build(main)
        assert full(page.labelled("Parameter")) and full(page.labelled("Name"))
        assert not full(page.labelled("Board")) and not full(page.labelled("Value"))
        name = page.labelled("Name")
        assert name.props["use-input"] and name.props["clearable"]
        assert not page.labelled("Board").props.get("use-input")
        image = page.every(ui.interactive_image)[0]
        assert str(image.props["aria-hidden"]) == "true"

    on_paper(work)


def test_long_fields_of_other_pages() -> None:
    async def stars(page: Page) -> None:
        page.build(alignment)
        field = page.labelled("Star in the middle of the field")
        assert full(field) and field.props["use-input"]

    async def faults(page: Page) -> None:
        page.build(lambda shell: with_bus(shell, page))
        assert full(page.labelled("Fault")) and full(page.labelled("Arguments, name=value"))
        assert not full(page.labelled("Number"))

    on_paper(stars)
    on_paper(faults)


@pytest.mark.parametrize(("builder", "press"), [
    (main, "Go"), (alignment, "Align on this star"), (alignment, "Apply"), (focus, "Add this point"),
    (focus, "Go to the best focus"),
    (lambda shell: calibrate(shell, RUNS), "Calibrate on the recorded runs"),  # type: ignore[arg-type]
])  # fmt: skip
def test_what_cannot_be_done_is_told_as_bad(builder: Callable[..., None], press: str) -> None:
    async def work(page: Page) -> None:
        page.build(builder)
        await page.press(press)
        assert page.said and "bad" in page.shell._said.classes

    on_paper(work)


def test_letting_go_of_a_key_is_not_locked() -> None:
    async def work(page: Page) -> None:
        page.build(main)
        key = page.labelled("Move N ↑")
        await page.fire(key, "mousedown")
        page.telescope.locked = True
        await page.fire(key, "mouseup")
        assert [each[0] for each in page.telescope.told] == ["paddle.press", "paddle.release"]

    on_paper(work)
