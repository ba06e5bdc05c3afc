"""What the operator does in a run: set points (closed loop) or efforts (open loop), one value per 5 ms."""

from dataclasses import dataclass

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.slots import Array

COUNTS_PER_RATE = d.ROLLER_COUNTS / 1_296_000.0 * d.TICK_S  # counts per tick of 1 arcsec/s
ACCELERATION = 2400.0  # arcsec/s2: a third of the paper's 2 deg/s2


@dataclass
class Run:
    """One run: kind, closed or open loop, command per tick (counts, or effort when open)."""

    kind: str
    loop: str
    command: Array
    session: str = "a"
    t_session: float = 0.0
    start_offset: float = 0.0

    @property
    def seconds(self) -> float:
        """Length of the run."""
        return len(self.command) * d.TICK_S


def piecewise(points: list[tuple[float, float]], slope: float) -> Array:
    """Hold each (value, seconds), moving between values at `slope` per second."""
    out: list[Array] = []
    here = 0.0
    for value, seconds in points:
        n = max(1, round(abs(value - here) / slope / d.TICK_S))
        out.append(np.linspace(here, value, n, endpoint=False))
        out.append(np.full(max(1, round(seconds / d.TICK_S)), value))
        here = value
    return np.concatenate(out)


def closed(kind: str, points: list[tuple[float, float]], slope: float = ACCELERATION) -> Run:
    """Closed-loop run of rates in arcsec/s."""
    return Run(kind, "closed", piecewise(points, slope) * COUNTS_PER_RATE)


def steps(rng: np.random.Generator) -> Run:
    """Constant rates, both directions, three speeds."""
    slow = float(rng.choice([300.0, 600.0]))
    mid = float(rng.choice([800.0, 1000.0, 1500.0]))
    fast = float(rng.choice([2400.0, 3600.0]))
    hold = rng.uniform(8.0, 11.0)
    points = [(v * s, hold) for v in (slow, mid, fast) for s in (1.0, -1.0)]
    return closed("steps", [(0.0, 1.0), *points, (0.0, 1.0)])


def sweep(rng: np.random.Generator) -> Run:
    """There and back over tens of degrees, at two speeds."""
    one, two = rng.uniform(4000.0, 6500.0), rng.uniform(7500.0, 10800.0)
    return closed("sweep", [(0.0, 0.5), (one, 20.0), (-one, 20.0), (two, 10.0), (-two, 10.0), (0.0, 1.0)])


def ramp(rng: np.random.Generator) -> Run:
    """Slow triangles of the rate through zero."""
    top = rng.uniform(400.0, 1800.0)
    n = 2
    return closed("ramp", [(0.0, 0.5)] + [(top, 0.5), (-top, 0.5)] * n + [(0.0, 0.5)], slope=top / 7.0)


def track(rng: np.random.Generator) -> Run:
    """Tracking and its neighbours: 15, 30, 100 arcsec/s one way, then the other."""
    rate = float(rng.choice([15.0, 15.041, 30.0]))
    return closed("track", [(0.0, 1.0), (rate, 28.0), (100.0, 9.0), (-rate, 22.0), (-100.0, 9.0), (0.0, 1.0)])


def bench(rng: np.random.Generator, stick: float) -> Run:
    """Open loop: efforts below break-away (motors locked by stiction), a small sine, then drive and coast.

    stick: effort (PWM steps) at which the axis breaks away.
    """
    points: list[Array] = []
    for level in (0.0, 0.12, 0.24, 0.36, 0.0, -0.12, -0.24, -0.36, 0.0):
        points.append(np.full(round(2.0 / d.TICK_S), level * stick))
    n = round(12.0 / d.TICK_S)
    points.append(0.5 * stick * np.sin(2 * np.pi * rng.uniform(0.2, 0.4) * d.TICK_S * np.arange(n)))
    for sign in (1.0, -1.0):
        effort = sign * min(2600.0, stick * 1.25)
        points.append(np.full(round(4.0 / d.TICK_S), effort))
        points.append(np.zeros(round(3.0 / d.TICK_S)))
    return Run("bench", "open", np.round(np.concatenate(points)).astype(np.float64))


def mono(rate: float, seconds: float) -> Run:
    """One rate, one direction: what cannot separate twins."""
    return closed("mono", [(0.0, 0.5), (rate, seconds)])


def plan(
    rng: np.random.Generator, stick: float, poor: bool = False, sessions: int | None = None
) -> list[Run]:
    """The runs of a case, with session names and start times (seconds)."""
    if poor:
        rate = float(rng.choice([600.0, 1000.0, 3600.0])) * float(rng.choice([-1.0, 1.0]))
        runs = [mono(rate, 60.0) for _ in range(4)]
    else:
        runs = [
            steps(rng),
            sweep(rng),
            ramp(rng),
            bench(rng, stick),
            steps(rng) if rng.random() < 0.5 else track(rng),
        ]
        runs.append([steps, sweep, ramp][int(rng.integers(3))](rng))
        order = rng.permutation(len(runs))
        runs = [runs[i] for i in order]
    count = sessions if sessions is not None else (2 if rng.random() < 0.4 else 1)
    clock = 0.0
    begin = 0.0
    for i, run in enumerate(runs):
        second = count == 2 and i >= len(runs) // 2
        if second and runs[i - 1].session == "a":
            clock += 7200.0
            begin = clock
        run.session = "b" if second else "a"
        run.start_offset = clock
        run.t_session = clock - begin
        clock += run.seconds + float(np.round(rng.uniform(10.0, 60.0)))
    return runs
