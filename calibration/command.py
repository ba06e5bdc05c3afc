"""`schmidt calibrate`: logs in, report.json, report.html and plant.yaml out."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from calibration.errors import CalibrationInputError
from calibration.inputs.draft import draft
from calibration.inputs.logs import Drive, read_drive
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import Run
from calibration.look.axis import look_at_axis
from calibration.look.drift import look_at_drift
from calibration.look.looked import Looked, Options
from calibration.look.response import look_at_response
from calibration.replay.corrected import correct_and_replay, with_curves
from calibration.report.htmlpage import page
from calibration.report.jsonreport import report_of
from calibration.report.pictures import Picture, pictures
from calibration.report.rigview import show_rig
from calibration.report.terminal import show
from plant.yamltext import nearest

__all__ = ["calibrate", "draft", "show_rig"]


def calibrate(
    logs: list[Path],
    rig: Path | None = None,
    hold_out: list[str] | None = None,
    out: Path = Path("."),
    plant: Path | None = None,
    plots: bool = True,
    replay: bool = True,
    on_step: Callable[[str], None] | None = None,
) -> int:
    """Calibrate on `logs` and write report.json, report.html and (for an axis log) plant.yaml into `out`.

    Returns 0 whenever there is an answer, "nothing" and UNKNOWN included. Raises CalibrationInputError (a
    ValueError) naming file, line and column for input that cannot be read. `plant` is the declared plant
    file; `plots=False` leaves the pictures out of the report. `replay=False` leaves out the replayed closed
    loop on an axis log's held-out rows. `on_step` hears each step as it begins.
    """
    if not logs:
        raise CalibrationInputError("calibrate", "give at least one log")
    tell = on_step or (lambda _: None)
    # the matrices are tall and narrow: more threads than one make the work three times as long
    with threadpool_limits(1):
        drive = read_drive(logs, load_rig(rig) if rig is not None else None)
        if plant is not None and (drive.rig is None or drive.rig.format != "axis-log"):
            raise CalibrationInputError("--plant", "is for axis logs: no other drive has a plant file")
        _check_names(hold_out or [], drive.runs, logs)
        out.mkdir(parents=True, exist_ok=True)
        options = Options(hold_out=hold_out or [], out=out, plant=plant, replay=replay, tell=tell)
        found = with_curves(look(drive, options))
        again = correct_and_replay(found, options)
        data = report_of(found, again)
        tell("writing the report")
        drawn = pictures(found, again) if plots else []
        write_report(data, drawn, found.title, drive.runs, out)
    show(data, found.said, out)
    return 0


def _check_names(hold_out: list[str], runs: list[Run], logs: list[Path]) -> None:
    known = {n for r in runs for n in (r.name, r.path.name, str(r.path))} | {str(p) for p in logs}
    for name in hold_out:
        if name not in known:
            hint = nearest(name, [r.name for r in runs])
            raise CalibrationInputError("--hold-out", f"no run is called '{name}'; {hint}")
    if hold_out and all(r.among(hold_out) for r in runs):
        raise CalibrationInputError("--hold-out", "every run is held out: nothing is left to fit")


def look(drive: Drive, options: Options) -> Looked:
    """Look at a drive as it is declared: two motors, a position at constant rate, a response to explain."""
    rig = drive.rig
    if rig is not None and rig.motors is not None:
        return look_at_axis(drive.runs, rig, options)
    if rig is None or rig.drifts:
        return look_at_drift(drive.runs, rig, options)
    return look_at_response(drive, rig, options)


def write_report(data: dict[str, Any], drawn: list[Picture], title: str, runs: list[Run], out: Path) -> None:
    """report.json and report.html."""
    (out / "report.json").write_text(json.dumps(data, indent=1, default=float) + "\n", encoding="utf-8")
    subtitle = f"{len(runs)} run{'s' if len(runs) != 1 else ''}: " + ", ".join(
        f"{r.name} ({r.duration_s:.0f} s, {r.rows} rows)" for r in runs[:12]
    )
    (out / "report.html").write_text(page(data, drawn, title, subtitle), encoding="utf-8")
