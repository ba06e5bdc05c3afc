"""`schmidt calibrate`: logs in, report.json, report.html and plant.yaml out."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from calibration.decide.verdict import Verdict, as_dict
from calibration.errors import CalibrationInputError
from calibration.inputs.logs import Drive, read_drive
from calibration.inputs.rigfile import load_rig
from calibration.readers.run import Run

Plots = list[dict[str, str]]


def calibrate(
    logs: list[Path],
    rig: Path | None = None,
    hold_out: list[str] | None = None,
    out: Path = Path("."),
    plant: Path | None = None,
    plots: bool = True,
    replay: bool = True,
) -> int:
    """Calibrate on `logs` and write report.json, report.html and (for an axis log) plant.yaml into `out`.

    Returns 0 whenever there is an answer, "nothing" and "unknown" included. Raises CalibrationInputError (a
    ValueError) naming file, line and column for input that cannot be read. `plant` is the declared plant
    file;
    `plots=False` leaves the pictures out of the report, `replay=False` the closed loop run again on an axis
    log's held-out rows.
    """
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
    from threadpoolctl import threadpool_limits

    if not logs:
        raise CalibrationInputError("calibrate", "give at least one log")
    # the matrices are tall and narrow: more threads than one make the work three times as long
    with (
        threadpool_limits(1),
        Progress(
            SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn(), transient=True
        ) as bar,
    ):
        task = bar.add_task("reading")
        tell: Callable[[str], None] = lambda text: bar.update(task, description=text)  # noqa: E731
        drive = read_drive(logs, load_rig(rig) if rig is not None else None)
        if plant is not None and not drive.emulated:
            raise CalibrationInputError("--plant", "is for axis logs: no other drive has a plant file")
        _check_names(hold_out or [], drive.runs, logs)
        out.mkdir(parents=True, exist_ok=True)
        verdict, pictures, title = answer(drive, hold_out or [], out, plant, plots, tell, replay)
        tell("writing the report")
        write_report(verdict, pictures, title, drive.runs, out)
    print(paragraph(as_dict(verdict), verdict.remarks, out))
    return 0


def show_rig(rig: Path, logs: list[Path], out: Path | None = None) -> str:
    """What is understood of a rig file and its logs: columns with unit, range, rate, gaps, quantum; `out`: a
    PNG of them."""
    from calibration.rigview import show

    return show(rig, logs, out)


def paragraph(data: dict[str, Any], remarks: list[str], out: Path) -> str:
    """The verdict in words, for the terminal."""
    from calibration.report.page import summary

    parts = [f"{data['verdict']}:", summary(data)]
    names = [
        e["name"]
        + (f" on {e['stage']}" if e["stage"] else "")
        + (f", harmonic {e['harmonic']}" if e["harmonic"] else "")
        for e in data["effects"]
    ]
    if len(names) > 1:
        parts.append(f"In order of what they take away: {'; '.join(dict.fromkeys(names))}.")
    for channel, row in data["error"].items():
        floor = "floor not known" if row["floor"] is None else f"floor {row['floor']:.4g}"
        parts.append(
            f"Held-out {channel}: {row['before']:.4g} -> {row['after']:.4g} {row['unit']} ({floor})."
        )
    parts += [f"{r}." for r in remarks]
    if data["separating_experiment"]:
        parts.append(f"To be sure: {data['separating_experiment']}.")
    parts.append(f"Report: {out / 'report.html'}")
    return " ".join(p for p in parts if p)


def _check_names(hold_out: list[str], runs: list[Run], logs: list[Path]) -> None:
    import difflib

    known = {n for r in runs for n in (r.name, r.path.name, str(r.path))} | {str(p) for p in logs}
    for name in hold_out:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.3)
            hint = (
                f"; nearest is '{near[0]}'"
                if near
                else f"; there are {', '.join(sorted(r.name for r in runs))}"
            )
            raise CalibrationInputError("--hold-out", f"no run is called '{name}'{hint}")
    if hold_out and all({r.name, r.path.name, str(r.path)} & set(hold_out) for r in runs):
        raise CalibrationInputError("--hold-out", "every run is held out: nothing is left to fit")


def answer(
    drive: Drive,
    hold_out: list[str],
    out: Path,
    plant: Path | None,
    plots: bool,
    tell: Callable[[str], None],
    replay: bool = True,
) -> tuple[Verdict, Plots, str]:
    """Verdict, pictures and title, by what the drive is declared to be: an axis with two motors, a position
    at constant rate, or a response to explain."""
    rig = drive.rig
    if rig is not None and rig.motors is not None:
        from calibration.twomotors.answer import axis_answer

        return axis_answer(drive.runs, hold_out, out, plant, plots, tell, replay, rig)
    if rig is None or rig.drifts:
        from calibration.drift.answer import guide_answer

        return guide_answer(drive.runs, rig, hold_out, plots)
    from calibration.response.answer import drive_answer
    from calibration.response.look import analyse

    found = analyse(drive.records, rig, hold_out, drive.clock, tell)
    tell("controls and pictures")
    return drive_answer(found, plots)


def write_report(verdict: Verdict, pictures: Plots, title: str, runs: list[Run], out: Path) -> None:
    """report.json and report.html."""
    from calibration.report.page import page

    data = as_dict(verdict)
    (out / "report.json").write_text(json.dumps(data, indent=1, default=float) + "\n", encoding="utf-8")
    subtitle = f"{len(runs)} run{'s' if len(runs) != 1 else ''}: " + ", ".join(
        f"{r.name} ({r.duration_s:.0f} s, {r.rows} rows)" for r in runs[:12]
    )
    (out / "report.html").write_text(page(data, pictures, title, subtitle), encoding="utf-8")
