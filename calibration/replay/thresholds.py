"""Numbers by which a replayed run is prepared and compared: value, unit, reason and source."""

from plant.units import ARCSEC

# --- which rows are compared

# s after a start, a gap or a jump of the command: the loop settles, 5 ms of its onset are unknown. ASSUMPTION
SETTLE_S = 1.0
# rad/s within one row: a new rate, and no ramp. ASSUMPTION
SETPOINT_STEP = 10.0 * ARCSEC
# s either side of a passage through the Stribeck speed: when it breaks away hangs on Ts to 0.1 %. ASSUMPTION
BREAKAWAY_S = 1.0
# s over which the speed of that passage is taken. ASSUMPTION
SPEED_S = 0.1
# rows that may be compared, at least, 1 s. ASSUMPTION
LEAST_ROWS = 100
# rows of a channel, all runs together, before it has an error. ASSUMPTION
FEWEST_COMPARED = 50

# --- the comparison

# times the error before: the loop's own noise is another draw in every replay. ASSUMPTION
WORSE = 1.25
# times the floor: a channel this near to it has nothing to gain. ASSUMPTION
NEAR = 1.2
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
# rows of closed loop in motion that tell its gains. ASSUMPTION
LEAST_LOOP_ROWS = 500
# median deviations: rows beyond are another mode of the controller, or a jump of the set point. ASSUMPTION
AGREE = 6.0
# rounds of leaving such rows out. ASSUMPTION: it settles before
ROBUST_ROUNDS = 8
# PWM steps per count, of either gain: an unstable loop, or none. ASSUMPTION
LARGEST_GAIN = 100.0

# --- the run's beginning

# rows driven by the logged effort before the loop closes: its integrator then starts as logged. ASSUMPTION
LEAD_ROWS = 5
# of full effort: a log that starts with less starts with an empty integrator. ASSUMPTION
AT_REST = 3e-3
# rad/s; slower, the axis is taken to start at rest. ASSUMPTION
LEAST_RATE = 3.0 * ARCSEC
