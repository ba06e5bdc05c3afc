"""What a finding becomes in a plant file, and the facts of the log that the translation needs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from calibration.finding import Finding
from plant.effects import REGISTRY
from plant.parts import EffectModel, Function, Number


@dataclass(frozen=True)
class Facts:
    """Facts of log and drive beside the findings, SI.

    middle: mean axis angle of the analysed rows. half_play: half the backlash at the motor. resistance:
    calibrated, of a whole motor loop; winding: the winding's part. per_ampere: N m at the axis per A.
    twists: the encoder channel's (amplitude arcsec, phase) of a gear line by (stage, harmonic).
    """

    name: str
    axis: str = "ra"
    middle: float = 0.0
    span: float = 0.0
    duration_s: float = 1.0
    half_play: float = 0.0
    resistance: float = 2.4
    winding: float = 2.2
    per_ampere: float = 140.0
    ampere_per_count: float = 0.0061
    supply: float = 24.0
    warming: float = 0.0
    twists: dict[tuple[str, int], tuple[float, float]] = field(default_factory=dict)


@dataclass
class Made:
    """Effects of the plant file, changes of its numbers (path below the axis -> SI value added), remarks."""

    effects: list[EffectModel] = field(default_factory=list)
    numbers: dict[str, float] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)

    def add(
        self,
        name: str,
        facts: Facts,
        values: dict[str, float],
        stage: str | None = None,
        harmonic: int = 1,
    ) -> None:
        """Add an effect with `values` in the units of its parameters, clipped to their bounds with a remark.

        Parameters that are not given are set to what adds nothing, never left at the catalogue's default.
        """
        spec = REGISTRY[name]
        parameters: dict[str, Number] = {}
        for p in spec.parameters:
            if p.name in values:
                raw = wrapped(values[p.name]) if p.unit == "rad" and "phase" in p.name else values[p.name]
                value = float(np.clip(raw, p.low, p.high))
                if abs(value - raw) > 1e-9 * max(abs(raw), 1e-12):
                    self.remarks.append(
                        f"{name}: {p.name} {raw:.4g} {p.unit} is beyond the plant's {p.low:g} to {p.high:g}, "
                        f"written as {value:.4g}"
                    )
                parameters[p.name] = Number(value, p.unit, f"fitted to {facts.name}")
            elif p.name in NEUTRAL:
                parameters[p.name] = Number(NEUTRAL[p.name], p.unit, f"not found in {facts.name}")
        self.effects.append(
            EffectModel(name, stage=stage if spec.stages else None, harmonic=harmonic, parameters=parameters)
        )

    def function(
        self,
        target: str,
        domain: str,
        knots: list[tuple[float, float]],
        source: str,
        interpolation: str = "cubic",
        period: float = 0.0,
        motor: int = 0,
    ) -> None:
        """Add an `unknown` effect: knots in SI units."""
        function = Function(target, domain, interpolation, period, tuple(knots), source, motor)
        self.effects.append(EffectModel("unknown", function=function))


#: value of a parameter at which its part of an effect adds nothing
NEUTRAL = {
    "amplitude": 0.0,
    "kinematic": 0.0,
    "second": 0.0,
    "mean": 0.0,
    "coulomb_asymmetry": 0.0,
    "viscous_asymmetry": 0.0,
    "packet_loss": 0.0,
    "repeats": 0.0,
    "drop": 0.0,
    "slip": 0.0,
    "creep": 0.0,
    "stiffness": 0.0,
    "hysteresis": 0.0,
    "exponent_change": 0.0,
}


def wrapped(angle: float) -> float:
    """An angle within -pi to pi."""
    return float(np.angle(np.exp(1j * angle)))


def value(f: Finding, name: str, otherwise: float = 0.0) -> float:
    """A finding's parameter."""
    return f.parameters[name].value if name in f.parameters else otherwise


def motor_of(f: Finding) -> int | None:
    """0 for motor A, 1 for B, None where the finding does not say."""
    return int(f.parameters["motor"].value) if "motor" in f.parameters else None
