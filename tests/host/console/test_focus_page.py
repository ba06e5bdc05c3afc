"""The focus page on paper: what it shows, what its buttons command, and the curve of star widths."""

import math
from typing import Any

import pytest
from nicegui import ui

from bus.protocol import Device, Focus, FocusFlag
from host.console.pages.focus import best, curve, focus
from tests.host.console.paper import Page, on_paper, snapshot

FIRST = 13
"""Labels of every page before those of the focus."""


def at(position: int, flags: int = 0, encoder: int = 480, lvdt: int = 612) -> Any:
    return snapshot(focus=Focus(Device.FOCUS, flags, position, encoder, lvdt))


def values(page: Page) -> dict[str, str]:
    """Texts by the label before them; `steps` is the big one."""
    texts = page.texts()[FIRST - 1 :]
    return {"steps": texts[0], **dict(zip(texts[1:9:2], texts[2:9:2], strict=True))}


def test_readings_are_in_half_steps_millimetres_and_counts() -> None:
    """By hand: 120 half steps of 6.25 µm; 100 of 1024 counts over 10 mm."""

    async def work(page: Page) -> None:
        page.build(focus).tick()
        assert set(values(page).values()) == {"–"}
        page.telescope.snapshot = at(120)
        page.tick()
        assert values(page) == {
            "steps": "+120 half steps", "from the middle": "+0.7500 mm", "LVDT": "612 counts, +0.98 mm",
            "encoder": "480 counts", "state": "energised, not referenced",
        }  # fmt: skip
        page.telescope.snapshot = at(-8, lvdt=512)
        page.tick()
        assert values(page)["LVDT"] == "512 counts, +0.00 mm"
        assert values(page)["from the middle"] == "-0.0500 mm"

    on_paper(work)


@pytest.mark.parametrize(("flags", "words"), [
    (FocusFlag.FREE, "free, not referenced"), (FocusFlag.HOLD, "hold, not referenced"),
    (FocusFlag.HOLD | FocusFlag.REFERENCED, "hold, referenced"),
    (FocusFlag.FREE | FocusFlag.HOLD, "free, not referenced"),
])  # fmt: skip
def test_the_state_is_told_in_words(flags: FocusFlag, words: str) -> None:
    async def work(page: Page) -> None:
        page.build(focus)
        page.telescope.snapshot = at(0, int(flags))
        page.tick()
        assert values(page)["state"] == words

    on_paper(work)


def test_the_lamp_is_lit_while_it_moves_and_old_values_are_marked() -> None:
    async def work(page: Page) -> None:
        page.build(focus).tick()
        lamp = page.labelled("not moving")
        assert "on" not in lamp.classes
        page.telescope.snapshot = at(0, int(FocusFlag.MOVING))
        page.tick()
        assert lamp is page.labelled("moving") and "on" in lamp.classes
        page.telescope.snapshot = at(0, 0)
        page.tick()
        assert lamp is page.labelled("not moving") and "on" not in lamp.classes
        big = next(each for each in page.every(ui.label) if "big" in each.classes)
        assert "stale" not in big.classes
        page.telescope.snapshot = at(0)._replace(stale=frozenset({Device.FOCUS}))
        page.tick()
        assert sum("stale" in each.classes for each in page.every(ui.label)) == 5
        page.telescope.snapshot = at(0)
        page.tick()
        assert not any("stale" in each.classes for each in page.every(ui.label))

    on_paper(work)


def test_every_button_is_its_command() -> None:
    async def work(page: Page) -> None:
        page.build(focus)
        for text in ("-10", "-1", "+1", "+10"):
            await page.press(text)
            assert page.labelled(f"Focus {text} half steps") is page.button(text)
        for text in ("Find reference", "Motor power OFF: hold", "Control power OFF: free", "Move To"):
            await page.press(text)
        place = page.labelled("Half steps")
        assert (place.value, place.props["min"], place.props["max"]) == (0, -800, 800)
        place.value = 120.0
        await page.press("Move To")
        place.value = None
        await page.press("Move To")
        assert page.telescope.told == [
            ("focuser.step", -10), ("focuser.step", -1), ("focuser.step", 1), ("focuser.step", 10),
            ("focuser.reference",), ("focuser.hold",), ("focuser.free",), ("focuser.move_to", 0),
            ("focuser.move_to", 120), ("focuser.move_to", 0),
        ]  # fmt: skip

    on_paper(work)


def test_the_best_focus_is_the_hyperbolas() -> None:
    """Width² = 4 + 0.01 (x - 30)²."""
    points = [(float(x), math.sqrt(4 + 0.01 * (x - 30) ** 2)) for x in (-40, 0, 20, 70)]
    assert best(points) == pytest.approx((4.0, 30.0, 0.01))
    assert best(points[:3]) is None and best([*points[:3], points[0]]) is None
    assert best([(x, math.sqrt(400 - 0.01 * x**2)) for x in (-40.0, 0.0, 20.0, 70.0)]) is None
    assert best([(x, 2.0) for x in (0.0, 1.0)] * 2) is None


def framed(shell: Any) -> None:
    with shell.page("/focus", "Focus console"):
        curve(shell)


def test_a_curve_gathers_points_and_goes_to_their_best() -> None:
    async def work(page: Page) -> None:
        page.build(framed)
        width = page.labelled("Star width here, ″ or pixels")
        assert (width.value, width.props["min"]) == (3.0, 0.01)
        await page.press("Add this point")
        assert page.said == "a width above 0 is needed, and a focus that tells where it is"
        for position, value in ((-40, 0.0), (-40, -1.0), (-40, None)):
            page.telescope.snapshot = at(position)
            width.value = value
            await page.press("Add this point")
        assert page.live.widths == []
        for position in (-40, 0, 20, 70):
            page.telescope.snapshot = at(position)
            width.value = math.sqrt(0.25 + 0.01 * (position - 30) ** 2)
            await page.press("Add this point")
            await page.press("Go to the best focus")
            assert bool(page.telescope.told) == (position == 70)
        assert page.said == "the best focus needs 4 positions with the least width between"
        assert page.telescope.told == [("focuser.move_to", 30)]
        assert page.live.widths[0] == pytest.approx((-40, math.sqrt(49.25)))
        page.tick()
        chart = page.labelled("Star width by focus position").options
        assert chart["xAxis"]["min"] == "dataMin" and chart["xAxis"]["name"] == "half steps"
        assert chart["xAxis"]["max"] == "dataMax"
        measured, fit = chart["series"]
        assert measured["type"] == "scatter" and measured["symbol"] == "circle"
        assert [x for x, _ in measured["data"]] == [-40, 0, 20, 70]
        assert len(fit["data"]) == 60 and (fit["data"][0][0], fit["data"][-1][0]) == (-40, 70)
        for x, y in fit["data"]:
            assert y == pytest.approx(math.sqrt(0.25 + 0.01 * (x - 30) ** 2), abs=0.01)
        assert fit["data"][1][0] == pytest.approx(-40 + 110 / 59, abs=0.05)
        assert "best focus at +30 half steps" in page.texts()
        await page.press("Clear the points")
        page.tick()
        assert "0 points" in page.texts() and page.live.widths == []
        assert page.labelled("Star width by focus position").options["series"][1]["data"] == []

    on_paper(work)


def test_the_curve_turns_to_day_with_the_page() -> None:
    async def work(page: Page) -> None:
        page.build(focus).tick()
        chart = page.labelled("Star width by focus position")
        night = chart.options["color"][0]
        page.shell.day = True
        page.tick()
        assert chart.options["color"][0] != night == "#ff6a5a"
        held = chart.options["series"]
        page.tick()
        assert chart.options["series"] is held, "nothing new is sent"

    on_paper(work)


def test_what_is_refused_is_told() -> None:
    from host.telescope import Reason, Refused

    async def work(page: Page) -> None:
        page.build(focus)
        page.telescope.answers["focuser.reference"] = Refused(Reason.STATE, "it moves")
        await page.press("Find reference")
        assert page.shell._said.text == "10.0 s: it moves" and "bad" in page.shell._said.classes

    on_paper(work)
