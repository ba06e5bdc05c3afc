"""Maintenance console 1 (H4): encoder offsets from a reference star, a pointing model from many."""

from collections.abc import Callable

from nicegui import ui

from host.console.figures import pointing
from host.console.pages.main import paddle
from host.console.pages.target import target
from host.console.shell import OLD, Shell, box, button, stale, table
from host.procedures.pointing import ENCODERS
from host.sky.catalogue import STARS, star
from host.sky.mount import CENTRE_STEPS, STEP_ARCSEC
from host.sky.pointmodel import TEXTS, PointingModel
from host.telescope.state import AXES


def alignment(shell: Shell) -> None:
    """The page."""
    with shell.page("/alignment", "Alignment"), ui.element("div").classes("boxes"):
        with box("Reference star"):
            ui.label("1. Go to a star and centre it with the paddle.").classes("small")
            ui.label("2. Choose it here and align: both encoders get an offset.").classes("small")
            chosen = shell.field(
                ui.select(sorted(STARS), label="Star in the middle of the field", with_input=True), wide=True
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
        show_model = _model(shell)
        with box("Where it points"):
            here = ui.label("–").classes("mid")
        paddle(shell)
        target(shell)

    @shell.each
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
        show_model()


def _model(shell: Shell) -> Callable[[], None]:
    """Box of the pointing model; returns what brings it up to date."""
    found: list[PointingModel] = []
    with box("Pointing model"):
        state = ui.label().classes("small")
        quality = ui.label("not fitted").classes("small")
        fill = table(("term", "what", "″", "± (95 %)"))

        async def fit() -> None:
            model = await shell.attempt(shell.desk.do(lambda t: t.drive.fit_model()))
            if model is None:
                return
            found[:] = [model]
            quality.set_text(
                f"rms on the sky: {model.before_arcsec:.1f}″ without, {model.after_arcsec:.2f}″ with the "
                f"model, {model.held_out_arcsec:.2f}″ on stars held out"
            )
            fill([
                (each.name, TEXTS[each.name], f"{each.arcsec:+.2f}", f"{each.within_arcsec:.2f}")
                for each in model.terms
            ])  # fmt: skip

        async def apply() -> None:
            if found:
                await shell.attempt(shell.desk.do(lambda t: t.drive.apply_model(found[0])))
            else:
                shell.say("fit a model first", bad=True)

        with ui.row():
            shell.control(button("Fit", on_click=fit))
            shell.control(button("Apply", on_click=apply))
            without = shell.doing(lambda t: t.drive.apply_model(None))
            shell.control(button("Without model", on_click=without))

    def refresh() -> None:
        about = shell.telescope.observatory
        model = about.mount.model
        using = "no model" if model is None else f"a model of {len(model.terms)} terms, {model.stars} stars"
        state.set_text(f"Stars aligned on: {len(about.stars)}; the telescope points by {using}")

    return refresh
