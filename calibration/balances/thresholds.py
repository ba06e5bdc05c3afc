"""Numbers that decide which rows and columns a balance is made of: value, unit, reason and source.

Where no other source is given they are ASSUMPTIONS, held on development seeds 1000 to 1999.
"""

# --- rows

# rows of any column, before its scatter, its trend or its noise is told. ASSUMPTION
FEWEST_FOR_A_SCATTER = 20
# rows of one segment, before a level of its own is fitted there. ASSUMPTION: its mean is then good to a third
FEWEST_FOR_A_LEVEL = 10
FEWEST_ROWS = 200  # rows of a balance, or of what is compared, before anything is told of it. ASSUMPTION
# rows that move, before gains by speed, or friction on held-out rows, are looked at. ASSUMPTION
FEWEST_MOVING = 100
# rows of a command, 10 s, before its law is looked for: four gains and their covariance. ASSUMPTION
FEWEST_FOR_A_LAW = 1000
FEWEST_FOR_A_CUBIC = 4  # rows of a column that are numbers, before a cubic goes through them: a definition
FEWEST_FOR_A_DRIFT = 3  # rows that a section needs for an offset, a drift and something to fit: a definition
# files, before a scatter between them is told or one is held out whole: a definition, two leave one
FEWEST_FILES = 3
# share of the rows of a log that hold a number, before it has the column at all. ASSUMPTION: one in twenty
COLUMN_PRESENT = 0.05
UNTOUCHED = 1e-9  # share of a filter that may lie on a marked row: arithmetic, rounding of two running means

# --- motion

SLOW_RATE = 5e-6  # rad/s, an arcsec/s: slower is no direction. ASSUMPTION, a fifteenth of the tracking rate
# rad, 2 arcsec: an axis that travels less does not move. ASSUMPTION, four steps of its encoder
LEAST_TRAVEL = 1e-5
LIMITED = 0.9  # share of full effort, beyond which a log has been at its limit. ASSUMPTION
AT_LIMIT = 0.98  # share of the largest effort, from which on it is at that limit. ASSUMPTION
# cycles within a row of the analysis grid, where its boxcars pass nothing: arithmetic, their zero is at one
UNSEEN_CYCLES = 0.9

# --- what a motion cannot tell (friction's parts): shares of rows, ASSUMPTIONS

# of the Stribeck speed: from standing to sliding on the falling branch, and beyond it. ASSUMPTION
FALLING = (0.05, 0.8)
SLIDING = 2.5  # times the Stribeck speed: beyond it friction slides. ASSUMPTION
FALLING_ROWS = 0.004  # share of rows on that branch. ASSUMPTION
SLIDING_ROWS = 0.02  # share of rows beyond it. ASSUMPTION
ONE_WAY = 0.02  # share of rows that move the other way. ASSUMPTION
ONE_SPEED = 3.0  # quotient of the 95 % and the 30 % speed, below which there is one speed only. ASSUMPTION
LEAST_ACCELERATION = 2e-4  # rad/s2: a 99 % acceleration below it says nothing of an inertia. ASSUMPTION
TURNING = 1e-4  # rad of travel behind a reversal, 20 arcsec, in which bristles show themselves. ASSUMPTION
TURNING_ROWS = 0.002  # share of rows there. ASSUMPTION
OPEN_CONSTANT = 0.03  # of the torque constant, a standard error that leaves it open. ASSUMPTION

# --- encoders and columns

# arcsec per N m times arcsec: a compliance below it is none (a train of 1e8 N m/rad). ASSUMPTION
LEAST_COMPLIANCE = 1e-8
LEAST_SCALE = 0.3  # scale of a column against the position's rate, below which it is no velocity. ASSUMPTION
OTHER_MOTION = 0.3  # share, of the autocorrelation: below it a motion is another one. ASSUMPTION
LAG_PART = 0.66  # part of a log that a lag may have. ASSUMPTION

# --- the command

SLOWEST_LINE_HZ = 0.1  # slower is the motion's own. ASSUMPTION
FEWEST_SPIKES = 12  # count of spikes, before they are pulses. ASSUMPTION
FEWEST_GAPS = 6  # count of gaps between them likewise. ASSUMPTION
# periods that a gap may be off a whole number of them. ASSUMPTION: by luck one gap in ten is
OFF_PERIOD = 0.05

# --- a mount's periodic parts

# turns of the slowest part: one that is no quicker than what was found is looked for again. arithmetic
AS_QUICK = 0.99
# turns within a section, by which two periods are apart. ASSUMPTION: a resolution cell is one
APART_TURNS = 0.4
STRAY = 1e-3  # share of a row's filter that may lie on rows of which nothing is known. ASSUMPTION
