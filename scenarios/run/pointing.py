"""Files of a run's steps: stars and model of pointing runs, the guide log of autoguide steps."""

import csv
import io
import math
from importlib.metadata import version

from host.logs.files import write_file
from host.logs.guidelog import hysteresis, opening, section
from scenarios.language.programme import guiding_of
from scenarios.run.outcome import Outcome

COLUMNS = (
    "step", "t_s", "hour_angle_deg", "declination_deg", "ra_reading_deg", "dec_reading_deg",
)  # fmt: skip
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
            angles = (
                seen.hour_angle_rad,
                seen.declination_rad,
                mount.ra.angle_rad(seen.ra_steps),
                mount.dec.angle_rad(seen.dec_steps),
            )
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
