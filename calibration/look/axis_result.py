"""What the axis pipeline found, channel by channel."""

from dataclasses import dataclass, field

import numpy as np

from calibration.arrays import Mask
from calibration.balances.frame import Frame
from calibration.balances.kinematic import Kinematic
from calibration.balances.motion import Motion
from calibration.balances.torque import Torque
from calibration.balances.view import View
from calibration.balances.volts import Volts
from calibration.decide.parameters import finding_of
from calibration.decide.selection import Selection
from calibration.decide.verdict import ROWS
from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import Declared
from calibration.names import NAMES

SENSORS = {**ROWS, "U": "command"}  # row of the report's error table, by channel


@dataclass
class AxisResult:
    """Everything the axis pipeline found, for the decision and the report."""

    declared: Declared
    frame: Frame
    motion: Motion
    held: Mask
    electrical: Volts | None = None
    kinematic: Kinematic | None = None
    torque: Torque | None = None
    views: dict[str, View] = field(default_factory=dict)  # per channel, what the names were looked for in
    selections: dict[str, Selection] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    held_out: list[str] = field(default_factory=list)
    calibrated: dict[str, Parameter] = field(default_factory=dict)
    before: dict[str, float] = field(default_factory=dict)  # per channel, where an effect was undone
    refused: list[tuple[str, str, str]] = field(default_factory=list)  # channel, what, why
    constant_error: float = 0.0  # relative standard error of the torque constant, where volts told it
    scale_error: float = 0.0  # relative standard error of the N m an ampere is worth, where volts told it
    floors: dict[str, float] = field(default_factory=dict)  # per channel, what the sensors leave
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))  # of all channels

    def collect(self, s: Selection, quotients: dict[str, float] | None = None) -> None:
        """Take every effect that a channel has chosen as a finding; `quotients` as in `Name.retold`."""
        found = (finding_of(s, k) for k in range(len(s.chosen)))
        self.findings += [NAMES[f.name].retold(f, quotients or {}) for f in found]
