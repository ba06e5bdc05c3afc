"""Numbers by which a replayed run is prepared and compared: value, unit, reason and source."""

from plant.units import ARCSEC

# --- which rows are compared

# s after a start, a gap or a jump of the command: the loop settles, 5 ms of its onset are unknown. ASSUMPTION
SETTLE_S = 1.0
SETPOINT_STEP = 10.0 * ARCSEC  # rad/s within one row: a new rate, and no ramp. ASSUMPTION
# s either side of a passage through the Stribeck speed: when it breaks away hangs on Ts to 0.1 %. ASSUMPTION
BREAKAWAY_S = 1.0
SPEED_S = 0.1  # s over which the speed of that passage is taken. ASSUMPTION
LEAST_ROWS = 100  # rows that may be compared, at least, 1 s. ASSUMPTION
FEWEST_COMPARED = 50  # rows of a channel, all runs together, before it has an error. ASSUMPTION

# --- the comparison

WORSE = 1.25  # times the error before: the loop's own noise is another draw in every replay. ASSUMPTION
NEAR = 1.2  # times the floor: a channel this near to it has nothing to gain. ASSUMPTION
# share of the rows that are near a break-away, from which on it is worth a line. ASSUMPTION
CHAOS_SHARE = 0.02

# rounds in which transients are led to the log's angle: what saturates takes a second one. ASSUMPTION
NUDGES = 2

# --- the declared model without the effects

# log of a ratio: linear corrections of the bristle's shape hold no further. ASSUMPTION, as in the balance
LARGEST_STEP = 0.3

# --- gains of the loop

# s, over which effort differences are taken: the summed error is then far above one count. ASSUMPTION
LAG_S = 0.25
LEAST_LOOP_ROWS = 500  # rows of closed loop in motion that tell its gains. ASSUMPTION
# median deviations: rows beyond are another mode of the controller, or a jump of the set point. ASSUMPTION
AGREE = 6.0
ROBUST_ROUNDS = 8  # rounds of leaving such rows out. ASSUMPTION: it settles before
LARGEST_GAIN = 100.0  # PWM steps per count, of either gain: an unstable loop, or none. ASSUMPTION

# --- the run's beginning

# rows driven by the logged effort before the loop closes: its integrator then starts as logged. ASSUMPTION
LEAD_ROWS = 5
AT_REST = 3e-3  # of full effort: a log that starts with less starts with an empty integrator. ASSUMPTION
LEAST_RATE = 3.0 * ARCSEC  # rad/s; slower, the axis is taken to start at rest. ASSUMPTION
