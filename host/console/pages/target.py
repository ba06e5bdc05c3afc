"""Where to go: a name, coordinates, or a click on the sky chart; a double click goes at once."""

from nicegui import ui
from nicegui.events import MouseEventArguments

from host.console.figures import hours, pointing
from host.console.shell import Shell, box, button, seldom
from host.console.skymap import SIZE, label, svg
from host.procedures.dome import BOARD as DOME_BOARD
from host.sky.angles import format_degrees, parse_declination, parse_right_ascension
from host.sky.catalogue import Star
from host.sky.listed import listed
from host.sky.observed import Observed, apparent_of_observed, star_of_apparent
from host.telescope import Observatory


def target(shell: Shell) -> None:
    """Both boxes."""
    with box("Go to"):
        chosen = shell.field(
            ui.select(list(listed()), label="Name", with_input=True, clearable=True), wide=True
        )
        with ui.row().classes("w-full"):
            ra = shell.field(ui.input("RA, ICRS", placeholder="05:16:41.36"))
            dec = shell.field(ui.input("Dec, ICRS", placeholder="+45:59:52.8"))

        async def go() -> None:
            try:
                wanted = _wanted(chosen.value, ra.value, dec.value)
            except ValueError as error:
                shell.say(str(error), bad=True)
                return
            await shell.attempt(shell.desk.do(lambda t: t.drive.goto(wanted, wake=True)))

        shell.control(button("Go", on_click=go))
        going = ui.label().classes("mid")

    async def clicked(event: MouseEventArguments) -> None:
        found = shell.live.chart.pick(event.image_x, event.image_y)
        if found is None or shell.desk.now.locked:
            return
        place = _icrs(found, shell.telescope.observatory, shell.desk.now.t_s)
        named = isinstance(found, Star)
        chosen.set_value(place.name if named else None)
        ra.set_value("" if named else hours(place.right_ascension_rad))
        dec.set_value("" if named else format_degrees(place.declination_rad))
        if event.type == "dblclick":
            await go()

    with box("Sky: click to choose, double click to go"):
        chart = ui.interactive_image(
            size=SIZE, on_mouse=clicked, events=["click", "dblclick"], sanitize=False
        ).classes("w-full sky")
        chart.props("aria-hidden=true")  # the list of names holds the same
        sky, caption = chart.add_layer(), ui.label().classes("small")

    @shell.each
    def refresh() -> None:
        now = shell.desk.now
        far = max(abs(now.ra.to_go_arcsec), abs(now.dec.to_go_arcsec))
        going.set_text(f"{now.target}: {far / 3600:.2f}° to go" if now.slewing and now.target else now.target)

    def look() -> None:
        telescope = shell.telescope
        here, dome = pointing(telescope).place, telescope.house.reading(DOME_BOARD.name)
        slit = dome["Azimuth"] if dome is not None else None
        caption.set_text(label(here))
        for layer, picture in (
            (chart, svg(telescope.observatory, here, telescope.target(), slit)),
            (sky, shell.live.chart.layer(shell.desk.now.t_s)),
        ):
            if layer.content != picture:
                layer.set_content(picture)

    shell.each(seldom(look))


def _wanted(name: str | None, ra: str, dec: str) -> Star:
    if ra.strip() or dec.strip():
        return Star("RA/Dec", parse_right_ascension(ra), parse_declination(dec))
    if not name:
        raise ValueError("choose a name, or write right ascension and declination")
    return listed()[name].star


def _icrs(found: Star | Observed, about: Observatory, t_s: float) -> Star:
    if isinstance(found, Star):
        return found
    place = apparent_of_observed(found.hour_angle_rad, found.declination_rad, about.site, about.clock, t_s)
    return star_of_apparent(place, about.clock, t_s, "RA/Dec")
