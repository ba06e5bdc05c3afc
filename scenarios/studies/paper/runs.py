"""The experiments as the authors ran them: commands to a bench, logs back. No judgement here."""

from collections.abc import Callable
from math import ceil
from typing import Protocol

import numpy as np

from plant.units import ARCSEC_PER_TURN
from scenarios.studies.paper.measures import Log, join, stalled
from scenarios.studies.paper.scales import EFFORT_SCALE, GEAR_RATIO, LOG_PERIOD_S

TRACKING = 15.0  # arcsec/s, the paper's tracking speed (Fig. 13).
HIGH = (600.0, 700.0, 800.0, 900.0, 1000.0)
"""arcsec/s, "higher speeds of 600 to 1000 arc sec/s" (paper 4)."""
OPENED = (600.0, 1000.0)  # arcsec/s: the ends of that range, at which the loop is opened (Fig. 6(a)).
SLOW_SLEW = (3600.0, 7200.0, 10800.0)
"""arcsec/s, "1 to 3 deg/s" (paper 4)."""
LOW = 100.0  # arcsec/s, Fig. 7.
DWELL_S, SETTLE_S = 60.0, 12.0  # Of each effort of E6, and before it counts.


class Bench(Protocol):
    """One axis with its controller, powered, at rest at the start. Time goes on from run to run.

    The emulator is one, the compiled loop another.
    """

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point, arcsec/s, for `seconds`."""
        ...

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort, 1/3000 of the supply, for `seconds`."""
        ...


def tracking(bench: Bench, seconds: float = 60.0, discard: float = 25.0) -> Log:
    """E1, E2: closed loop at 15 arcsec/s from rest, less start-up (hardware.md 2.4: more than 20 s)."""
    return bench.closed_loop(TRACKING, discard + seconds).after(discard)


def high_speed(bench: Bench, setpoint: float, seconds: float, settle: float) -> tuple[Log, Log]:
    """E3, E5: closed loop at a speed, then as long in open loop at the mean effort that had held it."""
    closed = bench.closed_loop(setpoint, settle + seconds).after(settle)
    effort = round(float(closed.effort.mean()))
    return closed, bench.open_loop(effort, settle + seconds).after(settle)


def low_speed(bench: Callable[[], Bench]) -> tuple[Log, list[Log]]:
    """E6: as an operator would look for the lowest open-loop speed. Return the closed loop, and the open-loop
    runs in which the axis never stood still. bench: makes a fresh one, at the same place.

    Closed loop at 100 arcsec/s first. Then, for one effort after the other, from 140 arcsec/s into open loop
    for DWELL_S after SETTLE_S. The first effort is the one that the loop needed. It falls in the smallest
    steps until the axis stays put, or rises until it keeps moving.
    """
    closed = bench().closed_loop(LOW, SETTLE_S + DWELL_S).after(SETTLE_S)
    effort = round(float(closed.effort.mean()))
    running: list[Log] = []

    def moves(tried: int) -> bool:
        trial = bench()
        trial.closed_loop(1.4 * LOW, 4.0)
        log = trial.open_loop(tried, SETTLE_S + DWELL_S).after(SETTLE_S)
        if stalled(log.rate):
            return False
        running.append(log)
        return True

    if moves(effort):
        for tried in range(effort - 1, max(0, effort - TRIALS), -1):
            if not moves(tried):
                break
    else:
        for tried in range(effort + 1, effort + TRIALS):
            if moves(tried):
                break
    return closed, running


TRIALS = 10  # Efforts tried on each side at most.
MOTOR_TURN_ARCSEC = ARCSEC_PER_TURN / GEAR_RATIO  # arcsec of the axis in a turn of the motor.
OPENED_BEGIN_S, OPENED_SETTLE_S, OPENED_AVERAGED_S = 4.0, 12.0, 30.0
"""s: settling is slowest where friction falls with speed nearly as fast as the motor's torque."""
BROKEN_AWAY = 20.0  # Counts in 5 ms, 46 arcsec/s: the axis no longer creeps.
MAP_SPEEDS = (
    10.0, 15.0, 25.0, 40.0, 60.0, 80.0, 100.0, 140.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 850.0, 1000.0,
    1200.0, 1400.0, 1600.0, 1800.0, 2400.0, 4800.0, 7200.0,
)  # fmt: skip
"""arcsec/s, set points of the torque-velocity map (Fig. 8): below tracking to the slew speed of Table 1."""


MAP_AVERAGED_S, MAP_STRETCH_ARCSEC = 30.0, 36_000.0


def map_run(bench: Bench, setpoint: float) -> Log:
    """E7: one steady state of the torque-velocity map, closed loop.

    Averaged over whole half turns of the motor: the gears' torques are periodic in it. Over less their mean
    is not zero (2.3 % of the torque at 10 arcsec/s over 36 s). At least 30 s, for the noise of the currents,
    but no more than 10 degrees, and 6 s.
    """
    settle = map_settle(setpoint)
    at_least = max(6.0, min(MAP_AVERAGED_S, MAP_STRETCH_ARCSEC / abs(setpoint)))
    half_turn = MOTOR_TURN_ARCSEC / abs(setpoint) / 2.0
    return bench.closed_loop(setpoint, settle + half_turn * ceil(at_least / half_turn)).after(settle)


def map_settle(setpoint: float) -> float:
    """Return how long a closed loop settles before a point of the map is taken, s."""
    return 10.0 if abs(setpoint) < 30.0 else 6.0


def map_pair(bench: Bench, setpoint: float) -> tuple[Log, Log]:
    """E7: a steady state there and back over the same stretch: the balance of the axis changes along it. The
    way there goes on for as long as the way back settles."""
    there = map_run(bench, setpoint)
    bench.closed_loop(setpoint, map_settle(setpoint))
    return there, map_run(bench, -setpoint)


def opened_run(bench: Bench, begin: float, effort: int) -> Log:
    """E7: one steady state with a fixed effort, entered from a speed that the loop holds. Averaged over the
    last whole half turns; a run that makes none is returned as it is."""
    bench.closed_loop(begin, OPENED_BEGIN_S)
    log = bench.open_loop(effort, OPENED_SETTLE_S + OPENED_AVERAGED_S).after(OPENED_SETTLE_S)
    return last_half_turns(log)


def last_half_turns(log: Log) -> Log:
    """Return the last whole half turns of the motor, by the encoder; all of it where there is none."""
    gone = np.abs(np.cumsum(log.rate[::-1])) * LOG_PERIOD_S * 2.0 / MOTOR_TURN_ARCSEC
    whole = int(gone[-1])
    samples = int(np.searchsorted(gone, whole)) + 1
    return log.last(samples * LOG_PERIOD_S) if whole else log


def opened_pair(bench: Bench, begin: float, there: int, back: int) -> tuple[Log, Log]:
    """E7: two of these, efforts `there` and `back` (negative), over the same stretch like `map_pair`."""
    log = opened_run(bench, begin, there)
    bench.open_loop(there, OPENED_BEGIN_S + OPENED_SETTLE_S)
    return log, opened_run(bench, -begin, back)


def break_away(bench: Bench, direction: int, step_s: float = 0.2) -> Log:
    """E7: from rest the effort rises by 1/3000 every `step_s` until the axis is gone. direction: 1 or -1.

    Slowly: at 0.05 s a step the high-preload axis creeps at 25 arcsec/s when its torque is largest. What it
    reads then lies 3 to 7 % off the static curve at that rate. At 0.2 s it creeps at 9 arcsec/s and what it
    reads lies within 2 %.
    """
    logs: list[Log] = []
    for effort in range(1, EFFORT_SCALE + 1):
        logs.append(bench.open_loop(direction * effort, step_s))
        if np.max(np.abs(logs[-1].counts), initial=0.0) > BROKEN_AWAY:
            break
    return join(logs)


def run_down(bench: Bench, setpoint: float = 7200.0, turns: float = 0.0) -> Log:
    """E8: steady state at a speed (2 deg/s), then the input is set to zero; the log starts at that moment.

    turns: of the motor, by which that is later, in whole periods of the log. So all runs have the command at
    the same moment within one.
    """
    later = round(turns * MOTOR_TURN_ARCSEC / abs(setpoint) / LOG_PERIOD_S) * LOG_PERIOD_S
    bench.closed_loop(setpoint, 8.0 + later)
    return bench.open_loop(0, 1.5)


STEP_TO = 600.0  # arcsec/s, Fig. 11.
