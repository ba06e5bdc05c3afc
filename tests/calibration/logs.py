"""Axis logs for the tests, made by the plant's compiled loop (not by the sealer of tests/blind)."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from plant.loop import Excitation, LogColumns, simulate
from plant.model import default_files, load, with_effects
from plant.parts import EffectModel, Number

HEADER = (
    "# format: axis-log 1\n# axis: {axis}\n# sample_period_s: 0.010\n# session: a\n# loop: closed\n"
    "# start_utc: 2026-01-15T14:{minute:02d}:00Z\n# preload: low\n# counter_torque: 0.1\n# supply_V: 24\n"
    "# note: the compiled loop of the plant, effects as the test says\n"
)
COLUMNS = ("t", "setpoint", "effort", "position", "velocity", "adc_a", "adc_b", "tach_a", "tach_b")
FORMATS = ["%.6f", "%.4f", *["%d"] * 7]


def manoeuvre(kind: str) -> np.ndarray:
    """Set points in arcsec/s, one per 10 ms."""
    if kind == "steps":
        return np.concatenate([np.full(700, float(s)) for s in (600, -600, 1500, -1500)])
    t = np.arange(4000) * 0.01
    if kind == "ramp":
        return 1500 * np.sin(2 * np.pi * t / 20)
    return np.interp(t, [0, 2, 4, 14, 18, 22, 32, 36, 40], [0, 0, 4000, 4000, 0, -4000, -4000, 0, 0])


def effect(
    name: str, stage: str | None = None, harmonic: int = 1, **parameters: tuple[float, str]
) -> EffectModel:
    """An effect with parameters given as (value, unit)."""
    return EffectModel(name, stage, harmonic, {k: Number(v, u, "test") for k, (v, u) in parameters.items()})


def write_logs(
    folder: Path, effects: Sequence[EffectModel], kinds: Sequence[str] = ("steps", "sweep", "ramp", "steps")
) -> list[Path]:
    """Write one log per manoeuvre; the runs share a session and go on where the one before stopped."""
    # the plant's declared run-out is taken out of both sides: these logs are about the effect under test
    model = with_effects(load(default_files()["low_preload"]), "ra", effects)
    paths, start = [], 4e8
    for k, kind in enumerate(kinds):
        wanted = manoeuvre(kind)
        log = simulate(
            model, "ra", len(wanted) * 0.01, Excitation(setpoint=wanted, start_steps=start), seed=k + 1
        )
        start = float(log.position[-1])
        paths.append(folder / f"run{k + 1}.log")
        write_log(paths[-1], log, 2 * k)
    return paths


def write_log(path: Path, log: LogColumns, minute: int = 0) -> None:
    """Write one run of the right ascension axis."""
    with path.open("w", encoding="utf-8") as file:
        file.write(HEADER.format(axis="ra", minute=minute) + ",".join(COLUMNS) + "\n")
        np.savetxt(file, np.column_stack([getattr(log, c) for c in COLUMNS]), fmt=FORMATS, delimiter=",")


def tiny_log(rows: int = 40, **changes: str) -> str:
    """A well-formed axis log of a slow motion as text; `changes` replace header values."""
    head = HEADER.format(axis="ra", minute=0)
    for key, value in changes.items():
        head = "".join(
            f"# {key}: {value}\n" if line.startswith(f"# {key}:") else line + "\n"
            for line in head.splitlines()
        )
    body = "\n".join(f"{k * 0.01:.2f},15,20,{1000 + 60 * k},7,{k % 5},0,3,3" for k in range(rows))
    return head + ",".join(COLUMNS) + "\n" + body + "\n"
