"""Figures of a run: each takes an outcome and returns a figure, or None when it has nothing to show."""

from collections.abc import Callable

import erfa
import numpy as np

from host.rates import COUNT_ARCSEC, LOOP_S
from host.sky.observed import observe_many
from scenarios.language.programme import Record
from scenarios.run.errors import NoData, pointing_errors, rate_errors
from scenarios.run.outcome import Outcome
from scenarios.run.report.pointing_run import guiding, pointing_run
from scenarios.run.report.style import COLOURS, Figure, axes, new_figure, thin, title

_SETTLE_S = 5.0


def pointing(outcome: Outcome) -> Figure | None:
    """Pointing error of every tracked target over time, truth and encoders."""
    records = _tracked(outcome)
    if not records:
        return None
    figure = new_figure(2.6 * len(records) + 0.4)
    for index, record in enumerate(records):
        window = outcome.window(record)
        assert window is not None and record.star is not None
        view = axes(figure, len(records), 1, index + 1, ylabel="error, arcsec", xlabel="time in step, s")
        for source, style in (("encoder", {"lw": 0.5, "alpha": 0.55}), ("truth", {"lw": 1.1})):
            try:
                t, ra, dec = pointing_errors(outcome, record.star, *window, source)
            except NoData:
                continue
            ra = ra * np.cos(record.star.declination_rad)
            for name, values, colour in (("RA cos δ", ra, COLOURS["ra"]), ("Dec", dec, COLOURS["dec"])):
                view.plot(
                    *thin(t - window[0], values),
                    color=colour,
                    label=f"{name}, {source}",
                    **style,  # type: ignore[arg-type]
                )
        view.axhspan(-10, 10, color=COLOURS["ok"], alpha=0.07, lw=0)
        reach = max(1.0, *(float(np.nanmax(np.abs(line.get_ydata()))) for line in view.lines)) * 1.15
        view.set_ylim(-reach, reach)
        title(view, f"{record.step.name}: star less telescope")
        view.legend(ncols=4, loc="upper right")
    return figure


def tracking(outcome: Outcome) -> Figure | None:
    """Rate error of the first long track in the three ways: true, 5 ms counts, 1 s mean."""
    records = sorted(_tracked(outcome), key=lambda r: -(r.end_s or 0) + (r.start_s or 0))
    if not records:
        return None
    record = records[0]
    window = outcome.window(record, _SETTLE_S) or outcome.window(record)
    assert window is not None
    figure = new_figure(5.4)
    ways = (("truth", "true"), ("counts_5ms", "5 ms counts"), ("mean_1s", "1 s means"))
    count = 0
    for row, (source, label) in enumerate(ways):
        try:
            t, error = rate_errors(outcome, record, "ra", source, *window)
        except NoData:
            continue
        count += 1
        rms, peak = float(np.sqrt(np.mean(error**2))), float(np.max(np.abs(error)))
        view = axes(
            figure, 3, 4, (4 * row + 1, 4 * row + 3), ylabel="arcsec/s", xlabel="time, s" if row == 2 else ""
        )
        view.plot(*thin(t, error), color=COLOURS[source], lw=0.6 if source != "mean_1s" else 1.0)
        view.axhline(0, color="#888", lw=0.5)
        view.set_xlim(*window)  # one stretch of time for all three
        title(view, f"{record.step.name}, RA rate error, {label}: rms {rms:.3f}, peak {peak:.2f} arcsec/s")
        side = axes(figure, 3, 4, 4 * row + 4, xlabel="samples" if row == 2 else "")
        step = COUNT_ARCSEC / LOOP_S if source == "counts_5ms" else max(peak / 25, 1e-9)
        edges = np.arange(error.min() - step / 2, error.max() + step, step)
        side.hist(error, bins=edges.tolist(), orientation="horizontal", color=COLOURS[source], alpha=0.8)
        side.set_ylim(view.get_ylim())
        side.tick_params(labelleft=False)
    return figure if count else None


def sky(outcome: Outcome) -> Figure | None:
    """The path over the sky: where the telescope looked, in altitude and azimuth."""
    starred = [r for r in outcome.records if r.star is not None and r.start_s is not None]
    if not starred:
        return None
    figure = new_figure(4.8, 5.2)
    view = figure.add_subplot(1, 1, 1, projection="polar")
    view.set_theta_zero_location("N")  # type: ignore[attr-defined]
    view.set_theta_direction(1)  # type: ignore[attr-defined]  # east is left when one looks up
    view.set_rlim(90, 0)  # type: ignore[attr-defined]
    view.set_rgrids([15, 30, 60], ["15°", "30°", "60°"])  # type: ignore[attr-defined]
    view.set_thetagrids([0, 90, 180, 270], ["N", "E", "S", "W"])  # type: ignore[attr-defined]
    t, altitude, azimuth = _telescope_path(outcome)
    if len(t):
        view.plot(azimuth, altitude, color="#6b7785", lw=1.0, label="telescope")
    seen: set[str] = set()
    for record in starred:
        assert record.star is not None and record.start_s is not None
        if record.star.name in seen:
            continue
        seen.add(record.star.name)
        last = max(r.end_s or 0.0 for r in starred if r.star is record.star or r.star == record.star)
        span = np.linspace(record.start_s, max(last, record.start_s + 1), 50)
        _, _, high, around = observe_many(record.star, outcome.scenario.site, outcome.scenario.clock, span)
        view.plot(around, np.degrees(high), lw=3, solid_capstyle="round", color=COLOURS["star"])
        view.annotate(
            record.star.name, (around[-1], np.degrees(high[-1])), textcoords="offset points", xytext=(8, 4)
        )
    horizon = np.full(100, np.degrees(outcome.scenario.horizon_rad))
    view.plot(np.linspace(0, 2 * np.pi, 100), horizon, color=COLOURS["bad"], lw=0.8, ls="--")
    view.set_title("Sky over the site")
    return figure


def focus(outcome: Outcome) -> Figure | None:
    """Focus position, true and as the board counts it."""
    from host.logs import traces

    moves = [
        (r.start_s, r.end_s) for r in outcome.records if r.step.action == "focus" and r.start_s is not None
    ]
    if not moves:
        return None
    rows = traces.overview(outcome.folder / "focus.parquet", ("true_half_steps",))
    board = traces.overview(outcome.folder / "host.parquet", ("focus_half_steps",))
    figure = new_figure(2.8)
    view = axes(figure, 1, 1, 1, ylabel="half steps (6.25 µm)", xlabel="time, s")
    view.plot(*thin(rows["t_s"], rows["true_half_steps"]), color=COLOURS["truth"], lw=2.2, label="true")
    view.plot(*thin(board["t_s"], board["focus_half_steps"]), color=COLOURS["dec"], lw=0.9, label="board")
    view.legend(loc="best")
    title(view, "Focus")
    view.set_xlim(min(start for start, _ in moves) - 2, max(end or start for start, end in moves) + 5)
    return figure


def motion(outcome: Outcome) -> Figure | None:
    """Rates of both axes over the whole run, true, on a scale that shows slewing and tracking."""
    figure = new_figure(3.0)
    view = axes(figure, 1, 1, 1, ylabel="rate, arcsec/s", xlabel="time, s")
    shown = False
    for name in ("ra", "dec"):
        t, _, rate = outcome.overview(name)
        if len(t):
            view.plot(*thin(t, np.degrees(rate) * 3600), color=COLOURS[name], lw=0.8, label=name.upper())
            shown = True
    view.set_yscale("symlog", linthresh=20.0)
    view.axhline(15.041, color="#888", lw=0.5, ls=":")
    view.legend(loc="best")
    title(view, "Rates of the axes (linear to ±20 arcsec/s, logarithmic beyond)")
    for record in outcome.records:
        if record.start_s is not None and record.step.after is None:
            view.axvline(record.start_s, color="#bbb", lw=0.5)
    return figure if shown else None


def bus(outcome: Outcome) -> Figure | None:
    """Bus load second by second."""
    if len(outcome.bus) < 2:
        return None
    t, load, frames = (np.array(column, dtype=float) for column in zip(*outcome.bus, strict=True))
    figure = new_figure(2.4)
    view = axes(figure, 1, 1, 1, ylabel="load, %", xlabel="time, s")
    view.fill_between(t, load * 100, step="pre", color=COLOURS["truth"], alpha=0.35, lw=0)
    view.step(t, load * 100, where="pre", color=COLOURS["truth"], lw=0.8)
    view.set_ylim(0, max(5.0, float(load.max()) * 130))
    rate = (frames[-1] - frames[0]) / max(t[-1] - t[0], 1e-9)
    title(view, f"CAN bus: mean load {load.mean():.1%}, {rate:.0f} frames/s")
    return figure


FIGURES: dict[str, tuple[str, Callable[[Outcome], Figure | None]]] = {
    "pointing": ("Pointing", pointing),
    "pointing-run": ("Pointing run", pointing_run),
    "guiding": ("Guiding", guiding),
    "tracking": ("Tracking", tracking),
    "motion": ("Motion", motion),
    "sky": ("Sky", sky),
    "focus": ("Focus", focus),
    "bus": ("Bus", bus),
}


def _tracked(outcome: Outcome) -> list[Record]:
    return [
        record
        for record in outcome.records
        if record.step.action == "track" and record.star is not None and outcome.window(record) is not None
    ]


def _telescope_path(outcome: Outcome) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t, hour_angle, _ = outcome.overview("ra", "angle")
    t_dec, declination, _ = outcome.overview("dec", "angle")
    if not len(t) or not len(t_dec):
        return t, t, t
    azimuth, altitude = erfa.hd2ae(
        hour_angle, np.interp(t, t_dec, declination), outcome.scenario.site.latitude_rad
    )
    return t, np.degrees(altitude), azimuth
