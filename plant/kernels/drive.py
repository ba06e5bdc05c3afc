"""One motor behind a low-side switch, and one gear train with play.

Motor: v = L di/dt + R i + K w (paper, equation (1)), exact for constant v and w over the step. The switch
and the
freewheel diode carry current one way only, so i >= 0: each motor pulls in one direction.
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
def back_emf(speed: float, constant: float, diode: float, drop: float) -> float:
    """Return the voltage that opposes the current, V; `speed` counts positive in the motor's own direction.

    A lagging motor (speed < 0) drives current through its freewheel diode. The paper leaves that out
    (superposition); `diode` 0..1 is the share of it that acts, `drop` the diode's forward voltage.
    """
    if speed < 0.0:
        return diode * min(0.0, constant * speed + drop)
    return constant * speed


@inner
def train(twist: float, twist_rate: float, stiffness: float, damping: float, play: float) -> float:
    """Return the torque of a gear train on the axis, N m; teeth push but never pull, and part within the
    play.
    """
    if twist > play:
        push = stiffness * (twist - play) + damping * twist_rate
        return push if push > 0.0 else 0.0
    if twist < -play:
        push = stiffness * (twist + play) + damping * twist_rate
        return push if push < 0.0 else 0.0
    return 0.0
