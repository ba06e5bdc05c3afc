"""What every page has, on paper: the state, the lock, the stop, clocks, alarms, day and night, the target."""

import math
from types import SimpleNamespace as Some
from typing import Any

import pytest
from nicegui import ui

from bus.protocol import Device
from host.console.figures import Clocks
from host.console.pages.target import _wanted, target
from host.console.shell import PAGES, alarm_line, seldom, table
from host.console.skymap import SIZE
from host.sky.angles import parse_right_ascension
from host.sky.listed import listed
from host.telescope import Reason, Refused
from host.telescope.alarms import Alarm, Severity
from tests.host.console.paper import Page, axis, on_paper, rows, snapshot


def empty(shell: Any) -> None:
    with shell.page("/bus", "Empty"):
        shell.control(ui.button("act", on_click=shell.doing(lambda t: t.drive.park())))
        shell.field(ui.input("wide"), wide=True)
        shell.field(ui.input("narrow"))


def test_a_head_has_the_way_to_the_others_and_the_state() -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        links = page.every(ui.link)
        assert [(each.props["href"], each.text) for each in links] == [*PAGES]
        assert [each.text for each in links if each.props.get("aria-current") == "page"] == ["Bus"]
        page.telescope.snapshot = snapshot(powered=True, activity="tracking", tracking=True, target="Vega")
        page.tick()
        assert page.texts()[0] == "tracking, Vega"
        assert page.client.title == "Empty – Schmidt telescope"
        wide, narrow = page.labelled("wide"), page.labelled("narrow")
        assert "w-full" in wide.classes and "w-full" not in narrow.classes
        assert wide.props["outlined"] and narrow.props["dense"]

    on_paper(work)


def test_a_lock_greys_what_commands_and_a_stop_goes_through() -> None:
    async def work(page: Page) -> None:
        page.build(empty).tick()
        act = page.button("act")
        assert act.enabled
        await page.press("Lock")
        assert page.telescope.locked and not act.enabled and page.button("Unlock")
        await page.fire(page.button("STOP  (space)"), "pointerdown")
        assert page.telescope.told == [("emergency_stop",)]
        with page.client:
            await page.shell._pressed(typed(" "))
            for event in (typed(" ", down=False), typed(" ", again=True), typed("x")):
                await page.shell._pressed(event)
        assert page.telescope.told == [("emergency_stop",)] * 2
        await page.press("Unlock")
        assert not page.telescope.locked and act.enabled
        await page.press("act")
        assert page.telescope.told[2:] == [("drive.park",)]

    on_paper(work)


def typed(key: str, down: bool = True, again: bool = False) -> Any:
    return Some(key=key, action=Some(keydown=down, repeat=again))


def test_keys_of_a_page_are_not_taken_while_it_is_locked() -> None:
    async def work(page: Page) -> None:
        keys: list[str] = []
        page.build(empty)
        page.shell.key(lambda event: keys.append(str(event.key)))
        with page.client:
            await page.shell._pressed(typed("a"))
            await page.shell._pressed(typed(" "))
            page.telescope.snapshot = snapshot(locked=True)
            await page.shell._pressed(typed("b"))
        assert keys == ["a"]

    on_paper(work)


def test_an_answer_stays_until_the_next() -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        page.telescope.answers["drive.park"] = Refused(Reason.STATE, "not now")
        await page.press("act")
        assert page.said == "not now" and "bad" in page.shell._said.classes
        page.telescope.snapshot = snapshot(t_s=12.34)
        page.shell.say("well")
        assert page.shell._said.text == "12.3 s: well" and "bad" not in page.shell._said.classes

    on_paper(work)


@pytest.mark.parametrize(("cookie", "day"), [("", False), ("schmidt-day=0", False), ("schmidt-day=1", True)])
def test_a_browser_keeps_day_or_night(cookie: str, day: bool) -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        assert page.shell.day == day
        for wanted in (True, False, True):
            await page.fire(page.button("Night / day"), "click", wanted)
            assert page.shell.day == wanted
        queries = [each for each in page.client.elements.values() if type(each).__name__ == "QueryElement"]
        assert queries and "day" in queries[-1].props["classes"]

    on_paper(work, cookie)


def test_clocks_are_shown_and_marked_without_an_encoder() -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        page.live.clocks = Clocks("14:00:10", "04h40m37", "1.15", "1:00 h before", "3:20 h")
        page.tick()
        texts = page.texts()
        at = texts.index("UTC")
        assert texts[at : at + 10] == [
            "UTC", "14:00:10", "sidereal", "04h40m37", "airmass", "1.15", "meridian", "1:00 h before",
            "limit in", "3:20 h",
        ]  # fmt: skip
        for board, marked in ((Device.POSITION_RA, 3), (Device.POSITION_DEC, 3), (Device.FOCUS, 0)):
            page.telescope.snapshot = snapshot(stale=frozenset({board}))
            page.tick()
            old = [each.text for each in page.every(ui.label) if "stale" in each.classes]
            assert old == ["1.15", "1:00 h before", "3:20 h"][:marked]

    on_paper(work)


def test_alarms_stand_until_somebody_acknowledges_them(monkeypatch: pytest.MonkeyPatch) -> None:
    beeps: list[str] = []
    monkeypatch.setattr(ui, "run_javascript", beeps.append)

    async def work(page: Page) -> None:
        page.build(empty).tick()
        bar = next(each for each in page.client.elements.values() if "alarms" in each.classes)
        assert not bar.visible
        page.live.alarms.take(5.0, {"RA: <FAULT>": Severity.ALARM})
        page.tick()
        assert bar.visible and beeps == []
        assert page.labelled("Alarms").content == (
            '<div class="alarm new"><b>ALARM</b> RA: &lt;FAULT&gt;, since 14:00:05 UTC</div>'
        )
        page.labelled("Sound at a new alarm").value = True
        page.tick()
        assert beeps == []
        page.live.alarms.take(6.0, {"RA: <FAULT>": Severity.ALARM, "wind": Severity.WARNING})
        page.tick(3)
        assert beeps == ["beep()"]
        await page.press("Acknowledge")
        page.tick()
        assert page.labelled("Alarms").content.count("(acknowledged)") == 2
        page.live.alarms.take(7.0, {})
        page.tick()
        assert not bar.visible
        page.live.alarms.take(8.0, {"wind": Severity.WARNING})
        page.tick()
        assert beeps == ["beep()"] * 2

    on_paper(work)


@pytest.mark.parametrize(("alarm", "line"), [
    (Alarm("a", Severity.WARNING, 1.0),
     '<div class="warning new"><b>WARNING</b> a, since 01:02:03 UTC</div>'),
    (Alarm("a", Severity.ALARM, 1.0, 2.0),
     '<div class="alarm new"><b>ALARM</b> a, since 01:02:03 UTC (over)</div>'),
    (Alarm("a", Severity.ALARM, 1.0, None, True),
     '<div class="alarm"><b>ALARM</b> a, since 01:02:03 UTC (acknowledged)</div>'),
])  # fmt: skip
def test_an_alarm_is_a_line(alarm: Alarm, line: str) -> None:
    assert alarm_line(alarm, "2026-02-10T01:02:03.456Z") == line


def test_seldom_is_once_in_so_many() -> None:
    done: list[int] = []
    often, four = seldom(lambda: done.append(1), 3), seldom(lambda: done.append(2))
    for _ in range(7):
        often()
    assert done == [1, 1, 1]
    for _ in range(9):
        four()
    assert done == [1, 1, 1, 2, 2, 2]


def test_a_table_sends_nothing_when_its_rows_are_the_same() -> None:
    async def work(page: Page) -> None:
        page.build(empty)
        with page.client:
            fill = table(("a", "b<"))
            fill([])
            element = page.every(ui.html)[-1]
            assert rows(element.content) == [["a", "b&lt;"]]
            fill([("1", "2&")])
            assert rows(element.content) == [["a", "b&lt;"], ["1", "2&amp;"]]
            element.content = "kept"
            fill([("1", "2&")])
            assert element.content == "kept"
            fill([])
            assert rows(element.content) == [["a", "b&lt;"]]

    on_paper(work)


def framed(shell: Any) -> None:
    with shell.page("/", "Target"):
        target(shell)


def test_a_target_is_a_name_or_a_place() -> None:
    assert _wanted("Vega", "", " ") is listed()["Vega"].star
    place = _wanted("Vega", "06:00:00", "-30:00:00")
    assert place.name == "RA/Dec" and place.right_ascension_rad == pytest.approx(math.pi / 2)
    assert place.declination_rad == pytest.approx(-math.pi / 6)
    for name in (None, ""):
        with pytest.raises(ValueError, match="choose a name, or write right ascension and declination"):
            _wanted(name, "", "")
    with pytest.raises(ValueError, match="declination"):
        _wanted("Vega", "06:00:00", "")
    with pytest.raises(ValueError, match="right ascension"):
        _wanted("Vega", "", "-30:00:00")


def test_a_target_is_gone_to_and_what_is_left_is_told() -> None:
    async def work(page: Page) -> None:
        page.build(framed)
        await page.press("Go")
        assert page.said == "choose a name, or write right ascension and declination"
        page.labelled("Name").value = "Vega"
        await page.press("Go")
        assert page.telescope.told == [("drive.goto", listed()["Vega"].star, ("wake", True))]
        page.telescope.snapshot = snapshot(
            slewing=True, target="Vega", ra=axis(to_go_arcsec=-7200.0), dec=axis(to_go_arcsec=360.0)
        )
        page.tick()
        assert "Vega: 2.00° to go" in page.texts()
        page.telescope.snapshot = snapshot(slewing=True, target="Vega", dec=axis(to_go_arcsec=-360.0))
        page.tick()
        assert "Vega: 0.10° to go" in page.texts()
        page.telescope.snapshot = snapshot(target="Vega")
        page.tick()
        assert "Vega" in page.texts()

    on_paper(work)


def test_a_click_on_the_chart_chooses_and_two_go() -> None:
    async def work(page: Page) -> None:
        page.build(framed).tick()
        chart = page.every(ui.interactive_image)[0]
        assert chart.props["size"] == SIZE
        x, y, star = next(each for each in page.live.chart._seen if each[2].stellar)
        fields = [page.labelled(name) for name in ("Name", "RA, ICRS", "Dec, ICRS")]

        async def click(kind: str, left: float, top: float) -> None:
            data = {"mouse_event_type": kind, "image_x": left, "image_y": top, "button": 0, "buttons": 0}
            keys = dict.fromkeys(("altKey", "ctrlKey", "metaKey", "shiftKey"), False)
            await page.fire(chart, "mouse", data | keys)

        await click("click", 120 + x, 120 + y)
        assert [each.value for each in fields] == [star.star.name, "", ""] and page.telescope.told == []
        await click("click", 121.0, 121.0)
        assert fields[0].value is None or page.telescope.told == []
        await click("click", 0.0, 0.0)
        await click("dblclick", 120 + x, 120 + y)
        assert page.telescope.told == [("drive.goto", star.star, ("wake", True))]
        page.telescope.snapshot = snapshot(locked=True)
        await click("dblclick", 120 + x, 120 + y)
        assert len(page.telescope.told) == 1

    on_paper(work)


def test_a_click_on_the_bare_sky_is_its_place_in_the_catalogue() -> None:
    """In the zenith the hour angle is nought: its right ascension is the sidereal time, precession apart."""

    async def work(page: Page) -> None:
        page.build(framed).tick()
        page.live.chart._seen = []
        chart, ra, dec = (
            page.every(ui.interactive_image)[0],
            page.labelled("RA, ICRS"),
            page.labelled("Dec, ICRS"),
        )
        data = {"mouse_event_type": "click", "image_x": 120.0, "image_y": 120.001, "button": 0, "buttons": 0}
        keys = dict.fromkeys(("altKey", "ctrlKey", "metaKey", "shiftKey"), False)
        await page.fire(chart, "mouse", data | keys)
        assert page.labelled("Name").value is None
        assert math.degrees(parse_right_ascension(ra.value)) == pytest.approx(70.15, abs=0.5)
        assert dec.value.startswith("+29°1") or dec.value.startswith("+29°2")

    on_paper(work)


def test_the_chart_shows_telescope_target_and_slit() -> None:
    async def work(page: Page) -> None:
        page.telescope.house.said = {"DOME": {"Azimuth": 90.0}}
        page.build(framed).tick()
        chart = page.every(ui.interactive_image)[0]
        assert 'class="sky-slit"' in chart.content and 'class="sky-here"' in chart.content
        assert "sky-target" not in chart.content
        assert "The telescope points at altitude 61°." in " ".join(page.texts())
        page.telescope.goal = page.telescope.observatory.observed(1 << 28, 1 << 28)
        page.telescope.house.said = {}
        page.tick(4)
        assert "sky-target" in chart.content and "sky-slit" not in chart.content

    on_paper(work)
