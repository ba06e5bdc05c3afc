"""The figures of docs/results/one-arcsecond.md: `python -m tests.studies.objective.plots`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from plant.model import load, with_effects
from plant.parts import EffectModel, PlantModel
from scenarios.language.configure import parameters_of
from scenarios.run.report.style import COLOURS, axes, new_figure, thin, title
from scenarios.studies.objective.bench import hold
from scenarios.studies.objective.cases import starts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HERE = Path(__file__).parents[3] / "docs" / "results" / "one-arcsecond"
_SECONDS = 60.0
_START = starts(0.0)[2]

EFFECTS = ("motor_cogging", "torque_ripple", "pwm_deadband", "encoder_subdivision")


def _with(model: PlantModel, *names: str) -> PlantModel:
    return with_effects(model, "ra", model.axes.ra.effects + tuple(EffectModel(name) for name in names))


def low() -> Figure:
    """The velocity loop at 15.041 arcsec/s: the paper's firmware and the proposed one, two plants."""
    declared = load("low_preload_bridge")
    fine = list(parameters_of("fine", declared).items())
    rows: tuple[tuple[str, PlantModel, list[tuple[int, int]]], ...] = (
        ("declared plant, the paper's firmware", declared, []),
        ("declared plant, spread duty alone", declared, fine[:1]),
        ("declared plant, spread duty, lock, blend, bias", declared, fine),
        ("cogging and dead band, spread duty alone", _with(declared, *EFFECTS[::2]), fine[:1]),
        ("all four effects, spread duty, lock, blend, bias", _with(declared, *EFFECTS), fine),
    )
    figure = new_figure(9.0)
    for row, (name, model, parameters) in enumerate(rows, 1):
        held = hold(model, _START, 1, "RATE", parameters, _SECONDS)
        last = row == len(rows)
        view = axes(figure, len(rows), 1, row, "time, s" if last else "", "arcsec/s")
        colour = COLOURS["bad"] if held.peak > 1.0 else COLOURS["ok"]
        view.plot(*thin(held.t_s - held.t_s[0], held.rate), color=colour, lw=0.6)
        view.axhspan(-1, 1, color=COLOURS["ok"], alpha=0.08, lw=0)
        reach = 1.15 * max(1.0, held.peak)
        view.set_ylim(-reach, reach)
        title(view, f"{name}: peak {held.peak:.2f} arcsec/s")
    return figure


def high() -> Figure:
    """High preload that leaps: the fine firmware's PI, and its observer."""
    model = load("high_preload_motor_units")
    figure = new_figure(4.2)
    for row, (name, firmware) in enumerate((("PI", "fine"), ("state observer", "observer")), 1):
        held = hold(model, _START, 1, "TRACK", list(parameters_of(firmware, model).items()), _SECONDS)
        view = axes(figure, 2, 1, row, "time, s" if row == 2 else "", "arcsec/s")
        colour = COLOURS["ok" if held.peak <= 1.0 else "bad"]
        view.plot(*thin(held.t_s - held.t_s[0], held.rate), color=colour, lw=0.6)
        title(view, f"high preload, {name}: peak {held.peak:.2f} arcsec/s")
    return figure


if __name__ == "__main__":
    HERE.mkdir(parents=True, exist_ok=True)
    for name, draw in (("low", low), ("high", high)):
        draw().savefig(HERE / f"{name}.png")
