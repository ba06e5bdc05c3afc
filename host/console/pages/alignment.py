"""Maintenance console 1 (H4): encoder offsets from a reference star."""

from nicegui import ui

from host.console.figures import pointing
from host.console.pages.main import paddle
from host.console.pages.target import target
from host.console.shell import OLD, Shell, box, button, stale, table
from host.procedures.pointing import ENCODERS
from host.sky.catalogue import STARS, star
from host.sky.mount import CENTRE_STEPS, STEP_ARCSEC
from host.telescope.state import AXES


def alignment(shell: Shell) -> None:
    """The page."""
    with shell.page("/alignment", "Alignment"), ui.element("div").classes("boxes"):
        with box("Reference star"):
            ui.label("1. Go to a star and centre it with the paddle.").classes("small")
            ui.label("2. Choose it here and align: both encoders get an offset.").classes("small")
            chosen = shell.control(
                ui.select(sorted(STARS), label="Star in the middle of the field", with_input=True)
                .classes("w-full")
                .props("outlined dense")
            )
            result = ui.label().classes("mid").props('role="status"')

            async def align() -> None:
                if not chosen.value:
                    shell.say("choose the star that is in the middle of the field", bad=True)
                    return
                found = await shell.attempt(shell.desk.do(lambda t: t.drive.sync(star(chosen.value))))
                if found is not None:
                    result.set_text(f"aligned: hour angle {found[0]:+.1f}″, declination {found[1]:+.1f}″")

            shell.control(button("Align on this star", on_click=align))
        with box("Encoder offsets"):
            fill = table(("axis", "reading, steps", "zero, steps", "offset from the maker’s, ″"))
        with box("Where it points"):
            here = ui.label("–").classes("mid")
        paddle(shell)
        target(shell)

    def refresh() -> None:
        now, mount = shell.desk.now, shell.telescope.observatory.mount
        rows = []
        for name, state, scale in (("RA", now.ra, mount.ra), ("Dec", now.dec, mount.dec)):
            offset = (scale.zero_steps - CENTRE_STEPS) * STEP_ARCSEC
            name += OLD * (AXES[name.lower()][1] in now.stale)
            rows.append((name, str(state.steps or "–"), str(scale.zero_steps), f"{offset:+.2f}"))
        fill(rows)
        place = pointing(shell.telescope)
        stale(here, not now.stale.isdisjoint(ENCODERS))
        here.set_text(f"RA {place.right_ascension}, Dec {place.declination}")

    shell.each(refresh)
