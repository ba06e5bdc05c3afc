"""A line over position at a period of no stage."""

from dataclasses import replace
from math import pi

from calibration.inputs.train import MESH, SHAFT
from calibration.names.freelines import free_lines
from calibration.names.inplant import Facts, Made, value
from calibration.names.motor_cogging import NAME as COGGING
from calibration.names.name import FORCE, SEARCHED_WORTH, SENSORS, SPEED, Finding, Name, Scene


def of_no_stage(f: Finding, s: Scene) -> Finding:
    """A line at an order that no stage has is a bearing only when the gear table is there to say so."""
    if f.name != NAME.name or not f.order:
        return f
    f = replace(f, note=f"period {(s.view.turn or 1.0) / f.order:.5g} {s.angle_unit}")
    if s.view.rig.stages:
        return f
    alike = list(dict.fromkeys([*f.equivalent, MESH, COGGING.name, NAME.name]))
    gears = replace(f, name=SHAFT, stage=None, equivalent=alike)
    return gears.noted("no gear table was given, so its stage cannot be named")


def to_plant(f: Finding, facts: Facts) -> Made:
    """The motors give A cos(x + phase); the axis has minus that."""
    values = {"amplitude": value(f, "amplitude"), "phase": value(f, "phase") - pi / 2}
    return Made().add(f.name, facts, values | {"order": f.order or 0.0})


NAME = Name(
    name="bearing_pass",
    searched=True,
    channels=(FORCE, SENSORS, SPEED),
    # lines that stand out of the residual's spectrum over position; of a pair of its torque
    columns=lambda s: free_lines(s) if s.pair is None or s.force else [],
    to_plant=to_plant,
    experiment="twice the travel: the order stands clear of every gear, or declare the gears",
    worth=SEARCHED_WORTH,
)
