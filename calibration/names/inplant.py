"""What a finding becomes in a plant file, and the facts of the log that the translation needs."""

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from calibration.finding import UNKNOWN, Finding
from plant.effects import REGISTRY
from plant.parts import EffectModel, Function, Number

Knots = list[tuple[float, float]]


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
        self, name: str, facts: Facts, values: dict[str, float], stage: str | None = None, harmonic: int = 1
    ) -> Self:
        """Add an effect with `values` in the units of its parameters, clipped to their bounds with a remark.

        Parameters that are not given are set to what adds nothing, never left at the catalogue's default.
        """
        spec = REGISTRY[name]
        parameters: dict[str, Number] = {}
        for p in spec.parameters:
            if p.name in values:
                raw = values[p.name]
                if p.unit == "rad" and "phase" in p.name:
                    raw = float(np.angle(np.exp(1j * raw)))  # within a turn
                value = float(np.clip(raw, p.low, p.high))
                if abs(value - raw) > 1e-9 * max(abs(raw), 1e-12):
                    beyond = f"{raw:.4g} {p.unit} is beyond the plant's {p.low:g} to {p.high:g}"
                    self.remarks.append(f"{name}: {p.name} {beyond}, written as {value:.4g}")
                parameters[p.name] = Number(value, p.unit, f"fitted to {facts.name}")
            elif p.name in NEUTRAL:
                parameters[p.name] = Number(0.0, p.unit, f"not found in {facts.name}")
        self.effects.append(
            EffectModel(name, stage=stage if spec.stages else None, harmonic=harmonic, parameters=parameters)
        )
        return self

    def added(self, f: Finding, facts: Facts, /, **values: float) -> Self:
        """`add` the effect of a finding, at its place."""
        return self.add(f.name, facts, values, f.stage, f.harmonic or 1)

    def function(self, target: str, domain: str, knots: Knots, source: str, **more: Any) -> None:
        """Add an `unknown` effect: knots in SI units; `more`: other fields of `Function`."""
        fields: dict[str, Any] = {"interpolation": "cubic", "period": 0.0, **more}
        function = Function(target, domain, knots=tuple(knots), source=source, **fields)
        self.effects.append(EffectModel(UNKNOWN, function=function))


#: ends the name of a time that is counted from the start of every run; the plant's effect comes once
IN_RUN = "_in_run"


def as_found(f: Finding, facts: Facts) -> Made:
    """An effect whose numbers are the finding's, by the plant's names and in its units."""
    made = Made(remarks=[f"{f.name}: {f.note}"] if f.note else [])
    if any(name.endswith(IN_RUN) for name in f.parameters):
        made.remarks.append(f"{f.name}: it comes in every run, the plant has it from its own start on")
    known = {p.name for p in REGISTRY[f.name].parameters}
    found = {name.removesuffix(IN_RUN): p.value for name, p in f.parameters.items()}
    return made.added(f, facts, **{name: x for name, x in found.items() if name in known})


#: how far a motor's angle lies off the axis', times half the play: both motors, A, B. definition
SIDES = (0.0, 1.0, -1.0)

#: phase, rad, from the cosine that two encoders differ by to the sine of the absolute one's error, which is
#: subtracted; minus this to the other's
OF_ABSOLUTE = -np.pi / 2

#: parameters that are left at 0 when a log has not shown them: their part of an effect then adds nothing
NEUTRAL = {"amplitude", "kinematic", "second", "mean", "stiffness", "hysteresis", "exponent_change"}
NEUTRAL |= {"coulomb_asymmetry", "viscous_asymmetry", "packet_loss", "repeats", "drop", "slip", "creep"}


def value(f: Finding, name: str, otherwise: float = 0.0) -> float:
    """A finding's parameter."""
    return f.parameters[name].value if name in f.parameters else otherwise


def motor_of(f: Finding) -> int:
    """As the plant counts them: 1 A, 2 B, 0 both, or where the finding does not say."""
    return int(value(f, "motor"))
