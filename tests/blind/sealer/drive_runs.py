"""Run the kernel over all runs of a case."""

from dataclasses import dataclass

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer import held, rates, slots
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.inputs import Inputs, inputs
from tests.blind.sealer.kernel import simulate
from tests.blind.sealer.manoeuvres import Run
from tests.blind.sealer.slots import Array


@dataclass
class Trace:
    """Rows of one run (columns: slots.OUT_NAMES) and what was put in."""

    run: Run
    rows: Array
    inputs: Inputs

    def __getitem__(self, name: str) -> Array:
        column: Array = self.rows[:, slots.OUT[name]]
        return column


def rest(p: Array) -> Array:
    """State at rest, rotors on their flanks."""
    state = np.zeros(rates.STATES)
    state[0] = state[9] = p[slots.TH_START]
    gap = p[slots.HALF_GAP]
    state[2] = p[slots.RATIO] * (state[0] + gap)
    state[4] = p[slots.RATIO] * (state[0] - gap)
    return state


def run_all(drive: Drive, runs: list[Run], effects: dict[str, float], seed: int) -> list[Trace]:
    """Simulate every run with these effect values; noise depends on the seed and the run only.

    Angle and heat carry over from run to run of a session, the windings cool in between; each run starts at
    rest.
    """
    values = {**drive.values, **{k: v for k, v in effects.items() if k in slots.INDEX}}
    out: list[Trace] = []
    memory = np.zeros(held.MEMORY)
    angle = values["TH_START"]
    session, until = "", 0.0
    for i, run in enumerate(runs):
        if run.session != session:
            memory[:2] = 0.0
            session = run.session
        elif values.get("HEAT", 0.0) > 0.0:
            memory[:2] *= np.exp(-max(run.t_session - until, 0.0) / values["HEAT_TAU"])
        until = run.t_session + d.TICK_S * len(run.command)
        phase = float(np.random.default_rng([seed, 17, ord(session)]).uniform(0, 1e6))
        p = slots.vector({**values, "TH_START": angle, "T_SESSION": run.t_session, "ROLLER_PHASE": phase})
        state = rest(p)
        noise = np.random.default_rng([seed, 1, i]).standard_normal(len(run.command))
        given = inputs(run, effects, seed * 1000 + i)
        closed = np.full(len(run.command), 1.0 if run.loop == "closed" else 0.0)
        rows = simulate(
            p, closed, run.command, given.hidden, given.torque, given.upset, given.burst, noise, state, memory
        )
        angle = float(state[0])
        out.append(Trace(run, rows, given))
    return out


def travel(traces: list[Trace]) -> float:
    """Range of the axis angle over all runs, rad."""
    angles = [float(f(trace["theta"])) for trace in traces for f in (np.min, np.max)]
    return max(angles) - min(angles) + d.ARCSEC
