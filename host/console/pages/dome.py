"""Dome and weather consoles (H7), and the power boards, as far as the network has them."""

import math
from collections.abc import Mapping, Sequence

from nicegui import ui

from bus.protocol.nodes import DOME, POWER, WEATHER
from host.console.figures import number
from host.console.pages.target import target
from host.console.shell import OLD, Shell, box, button, stale, table


def dome(shell: Shell) -> None:
    """The page."""
    with shell.page("/dome", "Dome and weather"), ui.element("div").classes("boxes filled chart"):
        _dome(shell)
        _weather(shell)
        _power(shell)
        target(shell)


def _dome(shell: Shell) -> None:
    house = shell.telescope.house
    with box("Dome"):
        state = ui.label("–").classes("mid")
        with ui.row().classes("items-center"):
            place = shell.field(ui.number("Azimuth, °", value=0, min=0, max=359.9, format="%.1f"))

            async def go() -> None:
                wanted = float(place.value or 0)
                await shell.attempt(shell.desk.do(lambda t: t.house.turn(wanted)))

            shell.control(button("Turn", on_click=go))
        following = ui.label("–").classes("mid")
        with ui.row():
            shell.control(button("Open shutter", on_click=shell.doing(lambda t: t.house.shutter(True))))
            shell.control(button("Close shutter", on_click=shell.doing(lambda t: t.house.shutter(False))))
            button("Stop dome", on_click=shell.doing(lambda t: t.house.stop()))
        with ui.row():
            follow = button("Follow the telescope", on_click=shell.doing(lambda t: t.house.slave(True)))
            for each in (follow, button("Stay", on_click=shell.doing(lambda t: t.house.slave(False)))):
                shell.control(each)
        interlock = ui.label("–").classes("mid")

    @shell.each
    def refresh() -> None:
        found = house.reading("DOME") if house.boards(DOME) else None
        state.set_text("No dome board on this network." if found is None else dome_text(found))
        stale(state, found is not None and house.stale("DOME"))
        aim = shell.telescope.aim()
        slit = "–" if aim is None else f"{math.degrees(aim.azimuth_rad) % 360:.1f}°"
        doing = "follows the telescope" if house.slaved else "stays where it is"
        following.set_text(f"The slit {doing}; the telescope needs it at {slit}.")
        interlock.set_text(interlock_text(house.unsafe(), found))


def dome_text(found: Mapping[str, float]) -> str:
    """One line of what the dome board says."""
    words = [f"azimuth {found['Azimuth']:.1f}°"]
    if found["Moving"]:
        words.append(f"turning to {found['Target']:.1f}°")
    ends = "open" if found["Opened"] else "closed" if found["Closed"] else f"{found['Shutter']:.0f} % open"
    words.append(f"shutter {ends}" + (", moving" if found["ShutterMoving"] else ""))
    if found["BadWeather"]:
        words.append("bad weather")
    return "; ".join(words)


def interlock_text(causes: Sequence[str], found: Mapping[str, float] | None) -> str:
    """What the weather lets the shutter do, and why. found: what the dome board says."""
    if found is not None and found["BadWeather"]:
        return (
            f"Interlock: the shutter is kept shut ({'; '.join(causes) or 'the dome board hears no station'})."
        )
    return f"Interlock: {'; '.join(causes)}." if causes else "Interlock: the shutter may open."


def _weather(shell: Shell) -> None:
    house = shell.telescope.house
    with box("Weather"):
        fill = table(("station", "air, °C", "humid, %", "wind, m/s", "rain", "verdict"))

    @shell.each
    def refresh() -> None:
        rows = []
        for name in house.boards(WEATHER):
            found = house.reading(name) or {}
            rows.append(
                (
                    name.removeprefix("WEATHER_").lower() + OLD * house.stale(name),
                    number(found["Temperature"], ".1f"),
                    number(found["Humidity"], ".0f"),
                    number(found["Wind"], ".1f"),
                    "yes" if found["Rain"] else "no",
                    "unsafe" if found["Unsafe"] else "safe",
                )
            )
        fill(rows or [("No weather board on this network.", "", "", "", "", "")])


def _power(shell: Shell) -> None:
    house = shell.telescope.house
    with box("Power"):
        fill = table(("board", "supply, V", "current, A", "relays off"))

    @shell.each
    def refresh() -> None:
        rows = []
        for name in house.boards(POWER):
            found = house.reading(name) or {}
            off = [str(k + 1) for k in range(8) if not int(found["Relays"]) >> k & 1]
            supply = number(found["Voltage"], ".2f"), number(found["Current"], ".2f")
            rows.append((name + OLD * house.stale(name), *supply, ", ".join(off) or "none"))
        fill(rows or [("No power board on this network.", "", "", "")])
