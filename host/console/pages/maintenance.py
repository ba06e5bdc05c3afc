"""Maintenance console 2 (H5): currents, tachometers, live gear reduction, play, encoders combined."""

from nicegui import ui

from host.auxiliary import ABSOLUTE_ARCSEC, APART, AUXILIARY_ARCSEC, BOARDS, combine
from host.console.figures import number
from host.console.live import RATIO
from host.console.plots import plots
from host.console.shell import OLD, Shell, box, table
from host.telescope.state import AXES


def maintenance(shell: Shell) -> None:
    """The page."""
    with shell.page("/maintenance", "Maintenance"), ui.element("div").classes("boxes filled"):
        _motors(shell)
        _gears(shell)
        _encoders(shell)
        plots(shell)


def _motors(shell: Shell) -> None:
    with box("Motors"):
        fill = table(("motor", "current, A", "tachometer, turns/s"))

    @shell.each
    def refresh() -> None:
        now = shell.desk.now
        rows = []
        for name, axis, (board, _, *motors) in (("RA", now.ra, AXES["ra"]), ("Dec", now.dec, AXES["dec"])):
            for k, motor in enumerate("AB"):
                current = f"{axis.currents_a[k]:.3f}{OLD * (board in now.stale)}"
                turns = number(axis.motor_turns_s[k], "+.4f") + OLD * (motors[k] in now.stale)
                rows.append((f"{name} {motor}", current, turns))
        fill(rows)


def _gears(shell: Shell) -> None:
    with box("Gear reduction and play"):
        fill = table(("axis", "motor turns per axis turn", "motor A against B, ″ on the axis"))
        ui.label(
            f"By tooth counts {RATIO:.3f}. Seen only above 50″/s. The motors' difference since power-up:"
            " 419″ is the play between them (42° of a motor), and the train's wind-up."
        ).classes("small")

    @shell.each
    def refresh() -> None:
        if not shell.live.samples:
            return
        last = shell.live.samples[-1]
        fill(
            [
                (
                    name + OLD * (not shell.desk.now.stale.isdisjoint(AXES[name.lower()])),
                    number(last.gear[k], ".2f"),
                    number(last.twist_arcsec[k], "+.1f"),
                )
                for k, name in enumerate(("RA", "Dec"))
            ]
        )


def _encoders(shell: Shell) -> None:
    with box("Encoders"):
        fill = table(("axis", "shaft, ″", "auxiliary", "apart", "combined"))
        ui.label(
            "Combined: the mean weighted by inverse variances, the best linear unbiased estimate of two"
            f" independent readings. σ is {ABSOLUTE_ARCSEC:.2f}″ on the shaft and"
            f" {AUXILIARY_ARCSEC:.2f}″ auxiliary at rest. It is more while moving, as they are read"
            f" milliseconds apart. Beyond {APART:g} σ of their difference the one on the shaft stands alone."
        ).classes("small")

    @shell.each
    def refresh() -> None:
        now = shell.desk.now
        rows = []
        for name, state in (("RA", now.ra), ("Dec", now.dec)):
            other = state.auxiliary
            found = combine(state.steps, *(other if other is not None else (None,)))
            rows.append(
                (
                    name,
                    number(found.absolute_arcsec, ".2f") + OLD * (AXES[name.lower()][1] in now.stale),
                    number(found.auxiliary_arcsec, ".2f", OLD * (BOARDS[name.lower()] in now.stale))
                    if found.auxiliary_arcsec is not None
                    else "no board",
                    number(found.difference_arcsec, "+.2f"),
                    number(found.estimate_arcsec, ".2f", f" ± {found.sigma_arcsec:.2f}")
                    + ("" if found.agree else " (they disagree)"),
                )
            )
        fill(rows)
