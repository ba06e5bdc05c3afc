"""One motor behind a low-side switch, and one gear train with play.

Motor: v = L di/dt + R i + K w (paper, equation (1)), exact for constant v and w over the step. The switch and
the freewheel diode carry current one way only, so i >= 0: each motor pulls in one direction.
"""

from plant.compiled import inner


@inner
def winding(current: float, target: float, decay: float, blend: float) -> tuple[float, float]:
    """Return (current at the end, mean current) of a step towards `target`, A; the diode stops it at zero."""
    end = target + (current - target) * decay
    mean = target + (current - target) * blend
    if end < 0.0:
        end = 0.0
    if mean < 0.0:
        mean = 0.0
    return end, mean


@inner
def back_emf(speed: float, constant: float, applied: float, leads: bool, diode: float, drop: float) -> float:
    """Return the voltage that opposes the current, V; `speed` counts positive in the motor's own direction.

    Motors turned against their pull follow the paper's superposition. The leading motor's EMF adds to the
    applied voltage, but no more than that voltage (a switch that is off conducts nothing). The lagging motor
    gives the torque of its duty alone. In truth the EMF drives current through the freewheel diode; `diode`
    0..1 is the share of that, `drop` the diode's forward voltage.
    """
    emf = constant * speed
    if emf >= 0.0:
        return emf
    free = max(emf, -applied) if leads else 0.0
    return free + diode * (min(0.0, emf + drop) - free)


@inner
def train(twist: float, twist_rate: float, stiffness: float, damping: float, play: float) -> float:
    """Return the torque of a gear train on the axis, N m; teeth push, never pull, and part in the play."""
    if twist > play:
        push = stiffness * (twist - play) + damping * twist_rate
        return push if push > 0.0 else 0.0
    if twist < -play:
        push = stiffness * (twist + play) + damping * twist_rate
        return push if push < 0.0 else 0.0
    return 0.0
