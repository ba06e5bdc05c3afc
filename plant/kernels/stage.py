"""The power stage between a supply and one motor: low-side switch, sense resistor, freewheel diode.

The switch closes for the first part of every PWM period. Then the supply drives the current through winding,
switch and sense resistor. For the rest of the period the winding's current runs down through the diode. The
equations are averages over a period. Either the current flows all the time (continuous), or it reaches zero
before the switch closes again (discontinuous). A motor that is dragged against its pull has a negative
back-EMF and needs no case of its own. tests/plant/stage.py solves the same circuit switch by switch.
"""

from math import exp, log

from plant.compiled import Floats, inner
from plant.kernels import layout as at

EDGE_S = 200e-9
"""s, of the switch: a shorter pulse does not reach the supply. ASSUMPTION: some 200 ns for an IRF250 behind
its driver, which is 12 of 3000 PWM steps at 20 kHz."""


@inner
def rail(w: Floats) -> float:
    """Return the supply's voltage, V: what both axes drew in the last step flows through its resistance."""
    return w[at.VOLTAGE] - w[at.SUPPLY_RESISTANCE] * w[at.SUPPLY_CURRENT] - w[at.OTHERS_SAG]


@inner
def closed_share(w: Floats, duty: float) -> float:
    """Return the share of a period in which the switch conducts; a pulse below one edge is a triangle."""
    period = w[at.PULSE] * w[at.INDUCTANCE]
    return duty if duty * period >= EDGE_S else duty * duty * period / EDGE_S


@inner
def rise(w: Floats, net: float, closed: float) -> float:
    """Return how far the current climbs in a period, A. net: V across the inductance as the switch closes."""
    return net * closed * w[at.PULSE] if net > 0.0 else 0.0


@inner
def stage(
    w: Floats, valley: float, duty: float, voltage: float, emf: float, heated: float, h: float
) -> tuple[float, float, float]:
    """Return the valley of the current after a step, its mean over the step and the supply's mean, A.

    valley: the smallest current of a period, A. duty: 0..1. emf: V, against the supply. heated: ohm, on top
    of the declared winding. h: s, many periods; L / R has to be many periods, too.
    """
    closed = closed_share(w, duty)
    winding = w[at.WINDING] + heated
    switch = w[at.RESISTANCE] - w[at.WINDING]
    drop = w[at.DIODE_DROP]
    resistance = winding + closed * switch
    half = 0.5 * rise(w, voltage - emf - (winding + switch) * valley, closed)
    goal = (closed * (voltage + drop) - drop - emf) / resistance - half
    triangle = drawn = 0.0
    if goal < 0.0:  # then back-EMF and drop together oppose the current
        peak = rise(w, voltage - emf, closed)
        fall = min(1.0 - closed, peak / (w[at.PULSE] * (emf + drop + 0.5 * winding * peak)))
        drawn = 0.5 * peak * closed
        triangle = drawn + 0.5 * peak * fall
        if valley <= 0.0:
            return 0.0, triangle, drawn
    slow = w[at.INDUCTANCE] / (resistance * h)
    end = goal + (valley - goal) * exp(-1.0 / slow)
    if end >= 0.0:
        mean = goal + half + (valley - end) * slow
        return end, mean, closed * mean
    # the valley reaches zero within the step
    last = slow * log((valley - goal) / -goal)
    mean = last * (goal + half) + valley * slow
    return 0.0, mean + (1.0 - last) * triangle, closed * mean + (1.0 - last) * drawn


@inner
def peak_current(w: Floats, m: int, emf: float) -> float:
    """Return the current of motor `m` as its switch opens, A, for the duty in force and a back-EMF, V."""
    valley = w[at.VALLEY + m]
    net = rail(w) - emf - w[at.RESISTANCE] * valley
    return valley + rise(w, net, closed_share(w, w[at.DUTY + m]))
