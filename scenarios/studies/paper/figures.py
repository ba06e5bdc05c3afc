"""Look-alikes of the paper's figures: velocity with the set point as a line, control effort dashed."""

from pathlib import Path
from typing import Any

import numpy as np

from scenarios.studies.paper.coasting import coast
from scenarios.studies.paper.experiments.e08 import SPEEDS
from scenarios.studies.paper.log import Log
from scenarios.studies.paper.record import Record
from scenarios.studies.paper.runs import LOW, STEP_TO, TRACKING
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, LOG_PERIOD_S

SIZE = (10.0, 4.2)


def draw_all(record: Record, folder: Path) -> list[Path]:
    """Draw every figure the record has data for; return the files."""
    import matplotlib

    matplotlib.use("Agg")
    folder.mkdir(parents=True, exist_ok=True)
    makers = (_figure_6, _figure_7, _figure_8, _figure_9, _figure_11, _figure_12, _figure_13)
    return [path for maker in makers if (path := maker(record, folder)) is not None]


def _panels(count: int, title: str) -> tuple[Any, list[Any]]:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, count, figsize=SIZE, layout="constrained")
    figure.suptitle(title)
    return figure, list(np.atleast_1d(axes))


def _save(figure: Any, path: Path) -> Path:
    import matplotlib.pyplot as plt

    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path


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


def _figure_6(record: Record, folder: Path) -> Path | None:
    if not record.high:
        return None
    opened = [(run, run.opened) for run in record.high if run.opened is not None]
    if not opened:
        return None
    worst, log = max(opened, key=lambda pair: float(np.max(np.abs(pair[1].rate / pair[0].setpoint - 1.0))))
    figure, axes = _panels(2, "Fig. 6: high speed, low preload")
    _velocity(axes[0], log, worst.setpoint, "(a) open loop")
    _velocity(axes[1], worst.closed, worst.setpoint, "(b) closed loop")
    low = min(axis.get_ylim()[0] for axis in axes)
    high = max(axis.get_ylim()[1] for axis in axes)
    for axis in axes:
        axis.set_ylim(low, high)
    return _save(figure, folder / "figure-06.png")


def _figure_7(record: Record, folder: Path) -> Path | None:
    if record.low.nearest is None:
        return None
    figure, axes = _panels(2, "Fig. 7: 100″/s, low preload")
    opened = record.low.nearest
    _velocity(axes[0], opened, float(opened.rate.mean()), "(a) open loop; line: mean")
    _velocity(axes[1], record.low.closed, LOW, "(b) closed loop")
    low = min(axis.get_ylim()[0] for axis in axes)
    high = max(axis.get_ylim()[1] for axis in axes)
    for axis in axes:
        axis.set_ylim(low, high)
    return _save(figure, folder / "figure-07.png")


def _figure_8(record: Record, folder: Path) -> Path | None:
    if not record.fits:
        return None
    figure, axes = _panels(2, "Fig. 8: friction characteristics about the RA axis")
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
    return _save(figure, folder / "figure-08.png")


def _figure_9(record: Record, folder: Path) -> Path | None:
    if record.run_down is None:
        return None
    figure, axes = _panels(2, "Fig. 9: run-down test, low preload")
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
    curve = coast(record.drive, fit, down, np.array([SPEEDS[0] * ARCSEC]), shown)[0]
    axes[1].plot(t, curve * degrees, color="black", linewidth=1.0,
                 label=f"J = {down.inertia / 1e3:.3f}e6 N mm s²")  # fmt: skip
    axes[1].set(title="(b) deceleration", xlabel="time, s", ylabel="velocity, °/s")
    axes[1].legend(fontsize=8)
    return _save(figure, folder / "figure-09.png")


def _figure_11(record: Record, folder: Path) -> Path:
    figure, axes = _panels(2, "Fig. 11: rest to 600″/s")
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
    return _save(figure, folder / "figure-11.png")


def _figure_12(record: Record, folder: Path) -> Path | None:
    chosen = [(run.setpoint, run.closed) for run in record.high if run.setpoint in (600.0, 1000.0)]
    chosen += [(speed, log) for speed, log in record.slew if speed in (3600.0, 10800.0)]
    if not chosen:
        return None
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(10.0, 7.5), layout="constrained")
    figure.suptitle("Fig. 12: closed loop at high speeds, low preload")
    for axis, (speed, log) in zip(axes.flat, chosen, strict=False):
        name = f"{speed / 3600:g}°/s" if speed >= 3600 else f"{speed:g}″/s"
        _velocity(axis, log, speed, name, 6.0)
        axis.set_ylim(0.85 * speed, 1.1 * speed)
    return _save(figure, folder / "figure-12.png")


def _figure_13(record: Record, folder: Path) -> Path | None:
    if not record.tracking:
        return None
    figure, axes = _panels(2, "Fig. 13: tracking, 15″/s")
    for axis, preload, letter in zip(axes, ("high", "low"), "ab", strict=True):
        if preload in record.tracking:
            _velocity(axis, record.tracking[preload], TRACKING, f"({letter}) {preload} bearing preload", 20.0)
    return _save(figure, folder / "figure-13.png")
