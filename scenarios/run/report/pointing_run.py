"""Figures of steps that look at stars: a pointing run's residuals on the sky, what a guide camera saw."""

import erfa
import numpy as np

from bus.units import ARCSEC_PER_RAD
from host.sky.pointfit import fit_stars
from host.sky.pointmodel import ZEROS, PointingModel
from host.sky.pointstars import Stars, stars_of
from scenarios.run.outcome import Array, Outcome
from scenarios.run.report.style import COLOURS, Figure, axes, new_figure, title

_ARROW_DEG = 14.0
"""Length of the longest arrow on the chart, degrees of zenith distance."""
_SMALL_RAD = 1e-4
"""Step on the sky that shows the direction of an arrow on the chart."""


def pointing_run(outcome: Outcome) -> Figure | None:
    """Of the run's last model: residuals of every star before and after it."""
    record = next((each for each in reversed(outcome.records) if each.model is not None), None)
    if record is None:
        return None
    assert record.model is not None
    seen = [each.sighting for each in record.visits]
    return residuals(stars_of(seen, outcome.scenario.mount, record.model.latitude_rad), record.model)


def residuals(stars: Stars, model: PointingModel) -> Figure:
    """Residuals of every star as arrows on the sky, north up, before and after; its own scale each."""
    zeros = fit_stars(stars, ZEROS)
    figure = new_figure(4.9)
    parts = (
        ("zeros of both axes", zeros, COLOURS["bad"]),
        (f"model of {len(model.terms)} terms", model, COLOURS["ok"]),
    )
    for number, (name, each, colour) in enumerate(parts, 1):
        view = figure.add_subplot(1, 2, number)
        x, y, east, north = _arrows(stars, each)
        size = np.hypot(east, north)
        scale = float(np.max(size)) / _ARROW_DEG
        view.quiver(x, y, east, north, color=colour, angles="xy", scale_units="xy", scale=scale, width=0.005)
        view.plot(x, y, ".", color="#6b7785", ms=3)
        for distance in (30, 60, 90):
            around = np.linspace(0, 2 * np.pi, 181)
            view.plot(distance * np.cos(around), distance * np.sin(around), color="#bbb", lw=0.5)
            view.annotate(f"{90 - distance}°", (0.71 * distance, 0.71 * distance), color="#888", fontsize=7)
        for text, place in (("N", (0, 95)), ("S", (0, -95)), ("E", (-95, 0)), ("W", (95, 0))):
            view.annotate(text, place, ha="center", va="center")
        view.set_aspect("equal")
        view.set_xlim(-105, 105)
        view.set_ylim(-105, 105)
        view.set_axis_off()
        rms = float(np.sqrt(np.mean(size**2)))
        view.set_title(f"{name}:\nrms {rms:.2f}″, longest arrow {float(np.max(size)):.2f}″")
    return figure


def _arrows(stars: Stars, model: PointingModel) -> tuple[Array, Array, Array, Array]:
    """Places on the chart; reading less model there, ″, in the chart's directions."""
    h, d, latitude = stars.h, stars.d, stars.latitude_rad
    west, north = stars.off(model)
    size = np.hypot(west, north)
    x, y = _chart(h, d, latitude)
    share = _SMALL_RAD / np.where(size > 0, size, 1.0)
    x_end, y_end = _chart(h + west * share / np.cos(d), d + north * share, latitude)
    length = np.hypot(x_end - x, y_end - y)
    size = size * ARCSEC_PER_RAD / np.where(length > 0, length, 1.0)
    return x, y, (x_end - x) * size, (y_end - y) * size


def _chart(h: Array, d: Array, latitude_rad: float) -> tuple[Array, Array]:
    """Degrees of zenith distance, west right and north up, as one looks up."""
    azimuth, altitude = erfa.hd2ae(h, d, latitude_rad)
    zenith = 90 - np.degrees(altitude)
    return -zenith * np.sin(azimuth), zenith * np.cos(azimuth)


def guiding(outcome: Outcome) -> Figure | None:
    """Of every such step, star less its place in the first exposure, and what the pulses did."""
    records = [each for each in outcome.records if each.guided]
    if not records:
        return None
    figure = new_figure(2.9 * len(records))
    for number, record in enumerate(records, 1):
        t = np.array([each.t_s for each in record.guided]) - (record.start_s or 0.0)
        off, sent = (np.array([getattr(each, name) for each in record.guided]) for name in ("off", "sent"))
        view = axes(figure, len(records), 1, number, ylabel="arcsec on the sky", xlabel="time in step, s")
        for axis, name in enumerate(("ra", "dec")):
            rms = float(np.sqrt(np.mean(off[:, axis] ** 2)))
            label = f"{name.upper()}, rms {rms:.2f}″"
            view.plot(t, off[:, axis], color=COLOURS[name], lw=0.9, label=label)
            view.vlines(t, 0.0, sent[:, axis], color=COLOURS[name], alpha=0.35, lw=1.5)
        view.legend(ncols=2, loc="upper right")
        title(view, f"{record.step.name}: star less its first place; bars: pulses")
    return figure
