"""An axis with two motors as its owner sees it: the rig file and the tables."""

import math
from dataclasses import dataclass

import numpy as np

from tests.blind.drives.families import Rng
from tests.blind.drives.slots import Array
from tests.blind.sealer.drive_runs import Trace

TURN = 2 * math.pi
TICK_S, ROW_S = 0.005, 0.01
OFF = 0.12  # by which a declared mechanical number may be off without being an effect


@dataclass
class Axis:
    """One axis: the kernel's numbers, the gear table, the sensors."""

    values: dict[str, float]
    teeth: tuple[tuple[int, int], ...]  # (wheel, pinion) from the axis to the motor
    tape: tuple[int, int]
    codes: float  # of the encoder, per turn
    ampere: float  # per count
    tach: float  # counts per motor turn

    @property
    def ratio(self) -> float:
        """Motor turns per axis turn."""
        return math.prod(wheel / pinion for wheel, pinion in self.teeth)

    def order(self, stage: str) -> float:
        """Cycles per axis turn."""
        (w1, p1), (w2, _), _ = self.teeth
        return {
            "pinion": w1 / p1,
            "layshaft": w1 / p1 * w2 / self.teeth[1][1],
            "motor": self.ratio,
            "ring mesh": float(w1),
        }[stage]


def declared(rng: Rng, a: Axis, law: bool) -> str:
    """The rig file that the owner would write from the documentation."""

    def told(name: str) -> str:
        return f"{a.values[name] * (1 + rng.uniform(-OFF, OFF)):.5g}"

    (w1, p1), (w2, p2), (w3, p3) = a.teeth
    reference = "  reference_rate: {column: demand_deg_s, unit: deg/s}\n" if law else ""
    return f"""rig: two motors on one axis
columns:
  time: {{column: t, unit: s}}
  position: {{column: angle_deg, unit: deg}}
  velocity: {{column: tape_deg_s, unit: deg/s, window_s: 0.005}}
{reference}  effort: {{column: pwm, unit: "1", scale: {1 / 3000!r}}}
  current_a: {{column: mA_a, unit: A, scale: 0.001}}
  current_b: {{column: mA_b, unit: A, scale: 0.001}}
  motor_a: {{column: rpm_a, unit: turn/s, scale: {1 / 60!r}}}
  motor_b: {{column: rpm_b, unit: turn/s, scale: {1 / 60!r}}}
supply_V: {a.values["V0"]:g}
turn: 360
runs: {{origin: shared}}
wall_time: {{from: order, gap_s: 20}}
stages:
  - {{name: axis, period: 360, kind: axis}}
  - {{name: pinion, of: axis, teeth: [{w1}, {p1}]}}
  - {{name: tape, of: axis, teeth: [{a.tape[0]}, {a.tape[1]}], kind: roller}}
  - {{name: layshaft, of: pinion, teeth: [{w2}, {p2}]}}
  - {{name: ring mesh, of: axis, teeth: [{w1}, 1], kind: gear_mesh}}
  - {{name: motor, of: layshaft, teeth: [{w3}, {p3}], kind: motor}}
  - {{name: second mesh, of: pinion, teeth: [{w2}, 1], kind: gear_mesh}}
  - {{name: third mesh, of: layshaft, teeth: [{w3}, 1], kind: gear_mesh}}
motors:
  counter_torque: {a.values["COUNTER"]:g}
  torque_constant_Nm_per_A: {told("KA")}
  resistance_ohm: {told("RA")}
  rotor_inertia_kgm2: [{a.values["JM"] / 4:.4g}, {a.values["JM"] * 4:.4g}]
  train_stiffness_Nm_per_rad: {told("KGEAR")}
  source: its maker
friction:
  - coulomb_Nm: {told("TC")}
    stiction_Nm: {told("TS")}
    stribeck_rate_rad_per_s: {told("VS")}
    viscous_Nms_per_rad: {told("SIG2")}
    bristle_stiffness_Nm_per_rad: {told("SIG0")}
    source: its maker
"""


def table(trace: Trace, a: Axis, rng: Rng) -> dict[str, Array]:
    """Columns of one file."""
    n = len(trace.rows)
    scale = a.values["ROLLER_SCALE"]
    codes = np.floor(trace["theta_log"] / TURN * a.codes + 0.4 * rng.standard_normal(n))
    out = {
        "t": ROW_S * np.arange(n),
        "angle_deg": np.mod(codes, a.codes) * 360.0 / a.codes,
        "tape_deg_s": np.degrees(trace["velocity"] / scale / TICK_S),
        "demand_deg_s": np.degrees(trace["setpoint"] / scale / TICK_S),
        "pwm": trace["effort"],
    }
    for side in "ab":
        counts = np.round(trace[f"i_{side}_log"] / a.ampere + 0.7 * rng.standard_normal(n))
        out[f"mA_{side}"] = np.clip(counts, 0, 4095) * a.ampere * 1000
        turned = np.floor(trace[f"phi_{side}"] / TURN * a.tach)
        out[f"rpm_{side}"] = np.diff(turned, prepend=turned[:1]) / a.tach / ROW_S * 60
    return out
