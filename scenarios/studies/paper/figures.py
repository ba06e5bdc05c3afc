"""Look-alikes of the paper's figures: velocity with the set point as a line, control effort dashed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scenarios.run.report.style import new_figure
from scenarios.studies.paper.coasting import coast
from scenarios.studies.paper.experiments.friction import RUN_DOWN_SPEEDS
from scenarios.studies.paper.log import Log
from scenarios.studies.paper.record import Record
from scenarios.studies.paper.runs import LOW, STEP_TO, TRACKING
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, LOG_PERIOD_S

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH_IN, ROW_IN = 10.0, 4.2


def draw_all(record: Record, folder: Path) -> list[Path]:
    """Draw every figure the record has data for; return the files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for number, maker in _MAKERS.items():
        figure = maker(record)
        if figure is not None:
            files.append(folder / f"figure-{number}.png")
            figure.savefig(files[-1])
    return files


def _panels(title: str, rows: int = 1, alike: bool = False) -> tuple[Figure, list[Any]]:
    """Two panels a row; alike: with one scale of velocity."""
    figure = new_figure(ROW_IN * rows, WIDTH_IN)
    figure.suptitle(title)
    return figure, list(figure.subplots(rows, 2, sharey=alike).flat)


def _velocity(axis: Any, log: Log, setpoint: float, title: str, seconds: float | None = None) -> None:
    """One panel as in the paper: velocity solid, set point horizontal, control effort dashed on the right."""
    part = log if seconds is None else log.last(seconds)
    t = part.t_s - part.t_s[0]
    axis.plot(t, part.rate, color="tab:blue", linewidth=0.7, label="velocity, 5 ms counts")
    axis.axhline(setpoint, color="black", linewidth=1.0, label="set point")
    axis.set(title=title, xlabel="time, s", ylabel="velocity, ″/s")
    right = axis.twinx()
    right.plot(t, part.effort / 30.0, "--", color="tab:red", linewidth=0.8, label="control effort")
    right.set_ylabel("control effort, % of 24 V")
    low, high = float(part.effort.min()) / 30.0, float(part.effort.max()) / 30.0
    room = max(0.5, (high - low) * 0.5)
    right.set_ylim(low - 3 * room, high + room)
    lines = [*axis.get_legend_handles_labels()[0], *right.get_legend_handles_labels()[0]]
    axis.legend(lines, [line.get_label() for line in lines], loc="lower right", fontsize=7)


def _figure_6(record: Record) -> Figure | None:
    opened = [(run, run.opened) for run in record.high if run.opened is not None]
    if not opened:
        return None
    worst, log = max(opened, key=lambda pair: float(np.max(np.abs(pair[1].rate / pair[0].setpoint - 1.0))))
    figure, axes = _panels("Fig. 6: high speed, low preload", alike=True)
    _velocity(axes[0], log, worst.setpoint, "(a) open loop")
    _velocity(axes[1], worst.closed, worst.setpoint, "(b) closed loop")
    return figure


def _figure_7(record: Record) -> Figure | None:
    if record.low.nearest is None:
        return None
    figure, axes = _panels("Fig. 7: 100″/s, low preload", alike=True)
    opened = record.low.nearest
    _velocity(axes[0], opened, float(opened.rate.mean()), "(a) open loop; line: mean")
    _velocity(axes[1], record.low.closed, LOW, "(b) closed loop")
    return figure


def _figure_8(record: Record) -> Figure | None:
    if not record.fits:
        return None
    figure, axes = _panels("Fig. 8: friction characteristics about the RA axis")
    for axis, preload, letter in zip(axes, ("high", "low"), "ab", strict=True):
        if preload not in record.fits:
            axis.set_visible(False)
            continue
        fit, points = record.fits[preload], record.points[preload]
        rate = np.geomspace(0.5 * ARCSEC, max(p.rate for p in points), 300)
        axis.semilogx(rate / ARCSEC, fit.torque(rate), color="black", linewidth=1.0, label="LuGre fit")
        axis.errorbar(
            [p.rate / ARCSEC for p in points], [p.torque for p in points], [2 * p.spread for p in points],
            fmt="o", markersize=4, color="tab:blue", label="from motor currents, ±2 s.e.",
        )  # fmt: skip
        text = (
            f"σ2 = {fit.viscous:.0f} N m s/rad\nTc = {fit.coulomb:.0f} N m\nTs = {fit.stiction:.0f} N m\n "
            f"vs = {fit.stribeck_rate:.2e} rad/s\nδ = {fit.exponent:.2f}"
        )
        axis.text(0.62, 0.96, text, transform=axis.transAxes, ha="center", va="top", fontsize=8)
        axis.set(title=f"({letter}) {preload} bearing preload", xlabel="velocity, ″/s", ylabel="torque, N m")
        axis.set_ylim(bottom=0.0)
        axis.legend(loc="lower left", fontsize=7)
    return figure


def _figure_9(record: Record) -> Figure | None:
    if record.run_down is None:
        return None
    figure, axes = _panels("Fig. 9: run-down test, low preload")
    fit, (log, down) = record.fits["low"], record.run_down
    points = record.points["low"]
    rate = np.linspace(0.5 * ARCSEC, max(p.rate for p in points), 400)
    axes[0].plot(np.degrees(rate), fit.torque(rate), color="black", linewidth=1.0)
    axes[0].plot(np.degrees([p.rate for p in points]), [p.torque for p in points], "o", markersize=4)
    axes[0].set(title="(a) friction over velocity", xlabel="velocity, °/s", ylabel="torque, N m")
    shown = 6  # 60 ms: then it is at rest but for its swing
    t = (np.arange(shown) + 1.0) * LOG_PERIOD_S
    degrees = COUNT_RATE * ARCSEC * 180.0 / np.pi
    axes[1].plot(t, log.counts[:shown] * degrees, "o", markersize=4, label="log, 10 ms")
    curve = coast(record.drive, fit, down, np.array([RUN_DOWN_SPEEDS[0] * ARCSEC]), shown)[0]
    axes[1].plot(t, curve * degrees, color="black", linewidth=1.0,
                 label=f"J = {down.inertia / 1e3:.3f}e6 N mm s²")  # fmt: skip
    axes[1].set(title="(b) deceleration", xlabel="time, s", ylabel="velocity, °/s")
    axes[1].legend(fontsize=8)
    return figure


def _figure_11(record: Record) -> Figure:
    figure, axes = _panels("Fig. 11: rest to 600″/s")
    t, rate, effort = record.linear
    log = record.step
    span = 1.5
    axes[0].plot(
        log.t_s - log.t_s[0], log.rate, color="tab:blue", linewidth=0.9, label="emulator, 5 ms counts"
    )
    axes[0].plot(t, rate, color="black", linewidth=1.0, label="equation (6) + PI")
    axes[0].axhline(STEP_TO, color="grey", linewidth=0.8)
    axes[0].set(xlim=(0, span), title="velocity", xlabel="time, s", ylabel="velocity, ″/s")
    axes[1].plot(
        log.t_s - log.t_s[0], log.effort / 30.0, "--", color="tab:red", linewidth=0.9, label="emulator"
    )
    axes[1].plot(t, effort / 30.0, "--", color="black", linewidth=0.9, label="equation (6) + PI")
    axes[1].set(xlim=(0, span), title="control effort", xlabel="time, s", ylabel="% of 24 V")
    for axis in axes:
        axis.legend(fontsize=8)
    return figure


def _figure_12(record: Record) -> Figure | None:
    chosen = [(run.setpoint, run.closed) for run in record.high if run.setpoint in (600.0, 1000.0)]
    chosen += [(speed, log) for speed, log in record.slew if speed in (3600.0, 10800.0)]
    if not chosen:
        return None
    figure, axes = _panels("Fig. 12: closed loop at high speeds, low preload", rows=2)
    for axis, (speed, log) in zip(axes, chosen, strict=False):
        name = f"{speed / 3600:g}°/s" if speed >= 3600 else f"{speed:g}″/s"
        _velocity(axis, log, speed, name, 6.0)
        axis.set_ylim(0.85 * speed, 1.1 * speed)
    return figure


def _figure_13(record: Record) -> Figure | None:
    if not record.tracking:
        return None
    figure, axes = _panels("Fig. 13: tracking, 15″/s")
    for axis, preload, letter in zip(axes, ("high", "low"), "ab", strict=True):
        if preload in record.tracking:
            _velocity(axis, record.tracking[preload], TRACKING, f"({letter}) {preload} bearing preload", 20.0)
    return figure


_MAKERS: dict[str, Callable[[Record], Figure | None]] = {
    "06": _figure_6, "07": _figure_7, "08": _figure_8, "09": _figure_9, "11": _figure_11, "12": _figure_12,
    "13": _figure_13,
}  # fmt: skip
