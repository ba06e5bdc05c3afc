"""What a finished (or interrupted) run leaves to be judged: folder, steps, counters; files of its steps."""

import csv
import io
import math
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from host.logs import traces
from host.logs.files import write_file
from host.logs.guidelog import hysteresis, opening, section
from host.sky.catalogue import Star
from host.sky.mount import STEPS_PER_TURN
from host.sky.observed import observe_many
from host.sky.pointread import AXES, DECLINATION, HOUR_ANGLE
from plant.mount import sky
from plant.parts import MountErrors
from scenarios.lab.layers import Evidence
from scenarios.language.model import Scenario
from scenarios.language.programme import Record, guiding_of

Array = npt.NDArray[np.float64]
_RAD_PER_STEP = 2 * np.pi / STEPS_PER_TURN
_KNOT_S = 1.0


@dataclass
class Outcome:
    """Files by way of `folder`, everything else as it stood when the run ended."""

    folder: Path
    scenario: Scenario
    records: list[Record]
    counters: dict[str, Any]
    bus: list[tuple[float, float, int]] = field(default_factory=list)
    """(t s, load of the second before, frames so far), once a simulated second."""
    faults: list[Evidence] = field(default_factory=list)
    """Of all there were, whether they acted."""
    errors: MountErrors | None = None
    """Of the plant's mount."""
    _places: dict[tuple[Star, tuple[float, float]], tuple[Array, Array, Array]] = field(
        default_factory=dict, repr=False
    )

    def record(self, name: str) -> Record:
        """The step of a name."""
        return next(record for record in self.records if record.step.name == name)

    def window(self, record: Record, settle_s: float = 0.0) -> tuple[float, float] | None:
        """Start and end of a step, s, without its first `settle_s`; None when it has nothing to offer."""
        if record.start_s is None or record.end_s is None or record.end_s <= record.start_s + settle_s:
            return None
        return record.start_s + settle_s, record.end_s

    def truth(self, axis: str, low_s: float, high_s: float) -> tuple[Array, Array, Array]:
        """Time s, true angle of the axis (rad, zero at hour angle or declination zero), true rate rad/s."""
        rows = traces.read(self.folder / f"truth-{axis}.parquet", ("angle", "rate"), low_s, high_s)
        scale = getattr(self.scenario.mount, axis)
        return rows["t_s"], rows["angle"] - scale.zero_steps * _RAD_PER_STEP, rows["rate"]

    def pointed(self, low_s: float, high_s: float) -> tuple[Array, Array, Array]:
        """Time s, true hour angle and declination that the telescope looks at, rad."""
        t, hour_angle, _ = self.truth("ra", low_s, high_s)
        t_dec, declination, _ = self.truth("dec", low_s, high_s)
        count = min(len(t), len(t_dec))
        t, hour_angle, declination = t[:count], hour_angle[:count], declination[:count]
        if self.errors is not None:
            hour_angle, declination = sky(
                hour_angle, declination, self.scenario.site.latitude_rad, self.errors
            )
        return t, hour_angle, declination

    def overview(self, axis: str, first: str = "rate") -> tuple[Array, Array, Array]:
        """The whole run in a few thousand points: time, true angle and rate as `truth` gives them.

        Extremes of the column `first` are kept.
        """
        order = ("rate", "angle") if first == "rate" else ("angle", "rate")
        rows = traces.overview(self.folder / f"truth-{axis}.parquet", order)
        scale = getattr(self.scenario.mount, axis)
        return rows["t_s"], rows["angle"] - scale.zero_steps * _RAD_PER_STEP, rows["rate"]

    def host(self, low_s: float, high_s: float) -> dict[str, Array]:
        """The host's own trace."""
        names = "ra_error_arcsec", "dec_error_arcsec", "focus_half_steps"
        return traces.read(self.folder / "host.parquet", names, low_s, high_s)

    def star_places(self, star: Star, t_s: Array) -> tuple[Array, Array]:
        """Observed hour angle and declination, rad: exact every second, linear between (within 1e-6″)."""
        span = float(np.floor(t_s[0])) - 1, float(np.ceil(t_s[-1])) + 2 * _KNOT_S
        if (star, span) not in self._places:  # most expectations ask about the same stretch
            knots = np.arange(*span, _KNOT_S)
            hour_angle, declination, _, _ = observe_many(star, self.scenario.site, self.scenario.clock, knots)
            self._places[star, span] = knots, np.unwrap(hour_angle), declination
        knots, hour_angle, declination = self._places[star, span]
        return np.interp(t_s, knots, hour_angle), np.interp(t_s, knots, declination)

    def axis_log(self, axis: str, low_s: float, high_s: float) -> dict[str, Array]:
        """Columns t and velocity of the axis log, rows of the window."""
        parts: list[Array] = [np.empty((2, 0))]
        for batch in traces.batches(self.folder / f"axis-{axis}.csv", ("t", "velocity")):
            rows = np.stack([np.from_dlpack(batch.column(name)) for name in ("t", "velocity")])
            parts.append(rows[:, (rows[0] >= low_s) & (rows[0] <= high_s)])
        t, velocity = np.concatenate(parts, axis=1)
        return {"t": t, "velocity": velocity}


COLUMNS = ("step", "t_s", HOUR_ANGLE, DECLINATION, *AXES)
"""Of pointing-stars.csv: observed place that the telescope was seen to look at; angles of both encoders."""


def write_runs(outcome: Outcome) -> None:
    """Write pointing-stars.csv and pointing-model.json, where there was a pointing run."""
    mount = outcome.scenario.mount
    text = io.StringIO()
    text.write(f"# latitude_deg: {math.degrees(outcome.scenario.site.latitude_rad):.6f}\n")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for record in outcome.records:
        for visit in record.visits:
            seen = visit.sighting
            axes = mount.ra.angle_rad(seen.ra_steps), mount.dec.angle_rad(seen.dec_steps)
            angles = seen.hour_angle_rad, seen.declination_rad, *axes
            rows.writerow([record.step.name, f"{visit.t_s:.2f}", *(f"{math.degrees(a):.7f}" for a in angles)])
        if record.model is not None:
            record.model.save(outcome.folder / "pointing-model.json")
    if any(record.visits for record in outcome.records):
        write_file(outcome.folder / "pointing-stars.csv", text.getvalue())


def write_guiding(outcome: Outcome) -> None:
    """Write guiding.txt, where a step has guided."""
    clock = outcome.scenario.clock
    sections = []
    for each in outcome.records:
        if each.guided and each.star is not None and each.start_s is not None:
            how = guiding_of(each.step.arguments)
            words = hysteresis(how.aggressiveness)
            sections.append(
                section(
                    each.step.name, each.start_s, each.star, clock, each.guided,
                    exposure_s=how.exposure_s, algorithm=words,
                )
            )  # fmt: skip
    if sections:
        text = "\n".join([opening(version("schmidt"), clock, 0.0), *sections])
        write_file(outcome.folder / "guiding.txt", text)
