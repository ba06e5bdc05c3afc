"""Numbers by which an input is refused, repaired or told apart: value, unit, reason and source."""

# --- rows that are enough to judge by

# rows, before missing, repeated or leaping ones are looked for: two seconds of the axis' log. ASSUMPTION
FEWEST_ROWS = 200
# rows, before a column is looked through for wraps and spikes. ASSUMPTION: their median is then sound
FEWEST_SAMPLES = 50
# rows that say how far the axis moved, and whether a column is in the format's unit. ASSUMPTION
FEWEST_MOVED = 100
FEWEST_STEPS = 20  # steps of the time column, before its period and direction are judged. ASSUMPTION

# --- the axis log

LONGEST_HEADER = 400  # lines, blank ones too: no header is longer. ASSUMPTION
# counts of the 10-bit converter of the currents, log-format.md: above it a current may be anything
LAST_COUNT = 1022.5
SAME_S = 1e-9  # s: two rows with one time. ASSUMPTION: far below a clock's digits
# share of rows with the time of the row before, from which on two axes are in one file. ASSUMPTION
SHARED_TIMES = 0.3
BACKWARDS = 0.5  # of a period, by which a row may come before the one before it: a clock's jitter. ASSUMPTION
# times, or part of, the declared period, beyond which 't' is not in s: ms would be a thousand. ASSUMPTION
OFF_PERIOD = 20.0
OVER_FULL = 1.05  # of full scale: efforts are logged after their limit. ASSUMPTION: a part of it for rounding
LARGEST_COUNT = 2.0**40  # counts: an unwrapped 29-bit counter would need two thousand turns; by arithmetic
LEAST_EFFORT = 30.0  # counts of effort, one per cent of the supply: less has never turned an axis. ASSUMPTION
# arcsec, above those of one turn (1296000, by arithmetic): fractions below it are an angle, no counts
ANGLE_OF_A_TURN = 2e6
LEAST_TRAVEL = 1000  # counts of travel that no effort in volts or fractions would have made. ASSUMPTION
# unit as the scale's: no scale is larger, and sums of such numbers stay finite. ASSUMPTION
LARGEST_SCALE = 1e12
# of any unit, in a table: its fourth power is finite still, and nothing measured is larger. ASSUMPTION
LARGEST_NUMBER = 1e60

# --- columns that hold one number

MOVED = 1e-9  # of the position's largest number: less is how it was rounded; by arithmetic of doubles
# rows on either side of a gap that tell how far one row moves. ASSUMPTION: 0.1 s of an axis log
BESIDE_A_GAP = 10
# counts that a column must have missed before it is stuck and not merely coarse: one count of rounding at
# either end of its range, and one of noise; by arithmetic
MISSED = 3.0
QUICKER = 10.0  # times the rows beside it: no axis speeds up so in 10 ms. ASSUMPTION
# rad, 20 arcsec: more than noise at rest, an eighth of the shortest counter (2^16 counts); by arithmetic
FAR_RAD = 1e-4
# rows (one packet, log-format.md) over which the position's own noise is averaged out of its rate
RATE_ROWS = 25

# --- a converter's end

# of the effort's range, that a column at its end must hold against: a steady effort makes a steady current.
# 2 % of it, over a few ohm, are tens of a converter's counts (development seed 1044: 0.025 at a clipped end)
DRIVEN = 0.02
# rows at the very end of a column's range. No sound current of axis seeds 1043 and 1044 has more than 66 at
# its highest count, and those had 504 before it
PILE = 60
PILE_TIMES = 3  # times the rows a count before the end, that those at the end must be. Same seeds as PILE
PILE_BESIDE = 20  # rows beyond PILE_TIMES of those a count before the end. Same seeds as PILE

# --- rows that are missing or repeated

OFF_BEAT = 0.15  # of a period either way, for a step of the clock that is whole periods. ASSUMPTION
REGULAR = 0.99  # share of the rows that must keep the beat. ASSUMPTION
LOST_PLACES = 10  # places at which rows are missing: fewer are gaps, which are reported as such. ASSUMPTION
LOST_SHARE = 0.001  # share of the rows that are missing, from which on it is reported. ASSUMPTION
# of the travel that the rows about lost ones promise, that the drive must have made over them: rows that were
# not lost have at most a half. arithmetic
MOVED_ON = 0.6
# steps of a sensor per row, from which on a row tells itself from two: a rounding is an eighth. arithmetic
STEPS_PER_ROW = 8
# of their mean, by which the motion of the rows before and after may differ: else it turns round. ASSUMPTION
LIKE_ITS_NEIGHBOUR = 0.3
# of the places with rows missing, those with steps between whole ones: more is a motion's. ASSUMPTION
BETWEEN = 0.25
FEWEST_REPEATS = 3  # rows that repeat the row before, at least, before a frame is said to be lost. ASSUMPTION
# share of rows that may repeat the row before: more is how the file was written. ASSUMPTION
MOST_REPEATS = 0.2
COARSE_STEPS = 4  # steps of a sensor per row, below which a coarse column repeats itself anyway. ASSUMPTION
# sample periods between two rows: a row is missing. ASSUMPTION: between one missing row's two and three
GAP = 2.5
# share of a clock's steps that are no gaps: serial stamps shake by whole periods in every tenth. ASSUMPTION
USUAL_STEPS = 0.95
# periods that a stamp that shakes is late by at most: more is a pause between bursts of rows. ASSUMPTION
SHAKEN = 3.0

# --- a column's step

FEWEST_VALUES = 3  # values that tell a step: two differences; by definition
# of the readings of another signal, of one that is logged as often: a few are lost. ASSUMPTION
SAME_RATE = 0.9
SAME_VALUE = 1e-12  # of the largest value: closer numbers are one, rounded; by arithmetic of doubles
# share of the steps that is taken for one count: a wide, sparse column has few. ASSUMPTION
SMALL_STEPS = 0.02
STEPS_SHARE = 0.995  # share of all steps that are whole multiples of a quantum. ASSUMPTION
# of a quantum, by which a step may miss a whole multiple: what a text file's digits leave. ASSUMPTION
WHOLE_STEPS = 0.02
# columns without a quantum that have one by luck: one in ten thousand. ASSUMPTION
LUCKY_COLUMN = 1e-4
MOST_MULTIPLE = 50  # times a quantum: beyond, the quantum's own error adds up to WHOLE_STEPS. ASSUMPTION
WHOLE = 1e-3  # of a count of steps, by which a text file's digits may miss a whole one. ASSUMPTION
FINEST = 1e-7  # of a column's range: its step, where none can be told. ASSUMPTION: below any sensor's

# --- wraps that nobody declared

MOVED_TIMES = 3.0  # times what all but one row in a hundred move, that a row with a wrap may. ASSUMPTION
# of the counter's length, by which a wrap's jump may differ: what is moved in one row. ASSUMPTION
NEAR_LENGTH = 0.2
MOST_JUMPS = 0.2  # share of the rows that may jump: more is motion. ASSUMPTION
MOST_JUMPS_WHOLE = 0.9  # share of the jumps that must be the counter's length. ASSUMPTION

# values below zero, before a column is read with a sign. ASSUMPTION: one or two mark failed readings
FEWEST_SIGNED = 3
WHOLE_COUNT = 1e-6  # of a count, by which a scale there and back may miss a whole one. arithmetic
ABOUT_ZERO = 0.1  # of the empty middle of a word: how far its values may stay off zero. ASSUMPTION

# --- spikes and leaps

# robust deviations from the neighbours' line. ASSUMPTION: three times what Gaussian noise has in a long log
SPIKE = 12.0
SPIKE_LEAP = 2.5  # times, between the smallest spike and the largest of the rest. ASSUMPTION
# values below the leap, from which the tail's index is taken (Hill 1975); their number an ASSUMPTION
TAIL = 20
BY_CHANCE = 1e-4  # share of chance of a leap that a heavy tail makes by itself. ASSUMPTION
MOST_SPIKES = 0.01  # share of rows: more is no spike but the signal. ASSUMPTION
TOLD_ROWS = 5  # rows that a note lists; the rest is an ellipsis. ASSUMPTION
LEAP_TIMES = 10.0  # times what all but one row in 200 move: a leap. ASSUMPTION
MOST_LEAPS = 3  # places of leaps that a file may have. ASSUMPTION
LEAP_ROWS = 20  # rows that must lie between two leaps, or they are spikes. ASSUMPTION

# --- readings at the end of their range

FEWEST_LEVELS = 20  # values that differ, before one that comes often is an end. ASSUMPTION
# pieces at one extreme value, before it is an end of the range: a steady load is held once. ASSUMPTION
FEWEST_ENDS = 3
AT_END = 0.002  # share of rows at one extreme value, in pieces: the reading is at its end. ASSUMPTION

# --- time stamps

LEAST_SHAKE = 0.02  # of the sample period, rms about a line: less changes nothing. ASSUMPTION
# of the mean square that the position's neighbours leave by the stamps, that an even grid may. ASSUMPTION
EVEN_BETTER = 0.5
# share of the rows by speed, beyond which a stamp's error shows in the position. ASSUMPTION
QUICK_SHARE = 0.67
# sample periods between two stamps: one is missing; less than GAP, as stamps shake. ASSUMPTION
STAMP_GAP = 1.6
ROUNDED = 1.5  # times what rounding to the stamps' own step leaves: no more is their resolution. ASSUMPTION

# --- guide logs

# s or px; beyond any night and any camera, and sums of such numbers stay finite. ASSUMPTION
LARGEST_FIELD = 1e9
SAME_PX = 0.01  # px: a lock position that is written again, to PHD2's last digits. ASSUMPTION
PIXEL_SCALES = (0.01, 100.0)  # arcsec per px, least and most of any guide camera. ASSUMPTION

# --- rig files

DEFAULT_HOLD_OUT = 0.4  # share of every file: ASSUMPTION, enough blocks on either side
HARMONICS = 2  # harmonics of a stage that are looked for unless the rig file says otherwise. ASSUMPTION
MOST_POINTS = 4000  # points drawn per column: what a picture can show. ASSUMPTION
