"""What the axis pipeline found, channel by channel."""

from __future__ import annotations

from dataclasses import dataclass, field

from calibration.channels.electrical import Electrical
from calibration.channels.frame import Frame
from calibration.channels.kinematic import Kinematic
from calibration.channels.motion import Motion
from calibration.channels.torque import Torque
from calibration.decide.parameters import finding_of
from calibration.decide.select import Selection
from calibration.declaredplant import Declared
from calibration.finding import Finding, Parameter
from calibration.statistics.whitening import Mask

#: row of the report's error table, by channel
SENSORS = {"T": "torque", "S": "velocity", "K": "position", "E": "electrical", "U": "command"}


@dataclass
class AxisResult:
    """Everything the axis pipeline found, for the decision and the report."""

    declared: Declared
    frame: Frame
    motion: Motion
    held: Mask
    electrical: Electrical | None
    kinematic: Kinematic | None
    torque: Torque | None
    selections: dict[str, Selection] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    held_out: list[str] = field(default_factory=list)
    calibrated: dict[str, Parameter] = field(default_factory=dict)
    before: dict[str, float] = field(default_factory=dict)  # per channel, where an effect was undone
    refused: list[tuple[str, str, str]] = field(default_factory=list)  # channel, what, why
    scale_error: float = 0.0  # relative standard error of the N m an ampere is worth, where volts told it
    floors: dict[str, float] = field(default_factory=dict)  # per channel, what the sensors leave

    def collect(self, s: Selection) -> None:
        """Take every effect that a channel's selection has chosen as a finding."""
        self.findings += [finding_of(s, k) for k in range(len(s.chosen))]
