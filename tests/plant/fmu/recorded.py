"""What the boards do with an axis' pins during a run, and an FMU that is asked the same."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from pyarrow import parquet

from plant import plant as plants
from plant.axis import AxisPort
from plant.kernels import layout as at
from plant.model import PlantModel
from scenarios.lab.prepare import prepare
from scenarios.run import run as runner


class Event(NamedTuple):
    """At t, ns: the duties that were set, or what a pin said."""

    t: int
    pin: str
    value: Any


class Recorded(NamedTuple):
    """Events at the pins of the RA axis in the order of time, and what an FMU of it is made of.

    ahead: the readings that the emulator takes from a later grid point than their time: a board's outputs
    act at the end of its routine, and the plant had gone there already.
    """

    events: list[Event]
    ahead: set[tuple[int, str]]
    model: PlantModel
    seed: int
    start_angle: float


def record(scenario: Path, folder: Path, patch: pytest.MonkeyPatch) -> Recorded:
    """Run a scenario, which must pass."""
    events: list[Event] = []
    names = ("incremental", "absolute", "auxiliary", "tachometer_a", "tachometer_b")

    class Watched(AxisPort):
        def __init__(self, grid: Any, row: int, *rest: Any) -> None:
            super().__init__(grid, row, *rest)
            self.watched = row == 0
            if self.watched:
                events.append(Event(-1, "start", float(grid.world[row, at.ANGLE])))
            for name in names if self.watched else ():
                setattr(self, name, self.watch(name, getattr(self, name)))
            if self.watched:
                now = self.current
                self.current = lambda t, m: self.said(t, f"current_{'ab'[m]}", now(t, m))

        def watch(self, name: str, pin: Callable[[int], int]) -> Callable[[int], int]:
            return lambda t: self.said(t, name, pin(t))

        def said(self, t: int, name: str, value: Any) -> Any:
            events.append(Event(t, name, value))
            return value

        def drive(self, t_ns: int, duty_a: float, duty_b: float) -> None:
            if self.watched:
                events.append(Event(t_ns, "drive", (duty_a, duty_b)))
            super().drive(t_ns, duty_a, duty_b)

    patch.setattr(plants, "AxisPort", Watched)
    scene, model = prepare(scenario)
    result = runner.run(scene, model, folder, lambda *_: None, runner.Way(report=False))
    assert result.passed, result.verdicts
    grid_ns, latest, ahead = round(model.numerics.grid.si * 1e9), 0, set()
    for event in events[1:]:
        if event.t < latest // grid_ns * grid_ns:
            ahead.add((event.t, event.pin))
        latest = max(latest, event.t)
    rows = parquet.read_table(folder / "truth-ra.parquet").to_pylist()
    for row in rows:
        for name in ("angle", "rate", "friction"):
            events.append(Event(round(row["t_s"] * 1e9), name, row[name]))
    start = events.pop(0).value
    return Recorded(sorted(events, key=lambda e: e.t), ahead, model, scene.seed, start)


class Imported:
    """An FMU that fmpy has loaded. fmi: 2 or 3."""

    def __init__(self, file: Path, folder: Path, fmi: int = 3, **start: float | bool) -> None:
        import fmpy
        from fmpy import fmi2, fmi3

        about = fmpy.read_model_description(str(file))
        made = fmi3.FMU3Slave if fmi == 3 else fmi2.FMU2Slave
        self.refs = {v.name: v.valueReference for v in about.modelVariables}
        self.fmu = made(
            guid=about.guid or about.instantiationToken,
            unzipDirectory=fmpy.extract(str(file), str(folder)),
            modelIdentifier=about.coSimulation.modelIdentifier,
            instanceName="axis",
        )
        self.three = fmi == 3
        self.fmu.instantiate()
        if not self.three:
            self.fmu.setupExperiment(startTime=0.0)
        for name, value in start.items():
            self.set(name, value)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.now = 0

    def set(self, name: str, value: float | bool) -> None:
        kind = "Boolean" if isinstance(value, bool) else "Float64" if self.three else "Real"
        getattr(self.fmu, f"set{kind}")([self.refs[name]], [value])

    def get(self, name: str) -> Any:
        whole = name in ("incremental", "absolute", "auxiliary", "tachometer_a", "tachometer_b")
        kind = ("Int64" if self.three else "Integer") if whole else ("Float64" if self.three else "Real")
        return getattr(self.fmu, f"get{kind}")([self.refs[name]])[0]

    def drive(self, duties: tuple[float, float]) -> None:
        for name, duty in zip(("duty_a", "duty_b"), duties, strict=True):
            self.set(name, duty)

    def step(self, t: int) -> None:
        """Go on to t, ns."""
        if t > self.now:
            self.fmu.doStep(self.now * 1e-9, t * 1e-9 - self.now * 1e-9)
            self.now = t


def differences(events: list[Event], fmu: Imported) -> list[tuple[Event, Any]]:
    """Replay the events; those whose value the FMU gives otherwise, with its value."""
    found: list[tuple[Event, Any]] = []
    for event in events:
        fmu.step(event.t)
        if event.pin == "drive":
            fmu.drive(event.value)
        else:
            said = fmu.get(event.pin)
            if said != event.value:
                found.append((event, said))
    return found
