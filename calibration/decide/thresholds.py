"""Numbers that verdict and probability hang on: value, unit, reason, and the seeds they were set on."""

from dataclasses import dataclass

# --- acceptance of a candidate (docs/reference/calibration.md, steps 5 and 6). Where no other source is given
# the thresholds of a decision were set on development seeds 1000 to 1999 of tests/blind.

# share of the cross-validated mean square that an effect takes away: 2 % held the level on pure noise
# (effects.md, lesson 3), more is for what a rigid balance misses of a compliant drive
MARGIN = 0.05
# z of a gain or a loss over blocks, or of a wrong sign: two standard errors of luck. Seeds 1000 to 1999
LUCK_Z = 2.0
# share of it that held the level on noise alone (effects.md, lesson 3): the margin of a rig's balances and of
# a command's law, and of a name that takes much of the error as it is
NOISE_SHARE = 0.02
PLAINLY = 0.25  # share of the held-out mean square, unfiltered, that a steady effect takes. ASSUMPTION
# share that a function without a name takes: it can imitate most names. ASSUMPTION in its size
HANDICAP = 0.12
# -log10 p of the best of all candidates: by luck in one of 1e4 logs (arithmetic). Of 1e3 candidates, each
# needs 7; of two, as a mount with its worm declared has, 4.3
LEAST_EVIDENCE = 4.0
# log10 of the chance that rows which nothing was fitted to gain by luck, at LUCK_Z: arithmetic. The chance of
# both by luck is the product
BY_HELD_OUT_ROWS = -1.64
# lines among which a line of no stage is the best: those that a spectrum's peaks stand out of. ASSUMPTION
SPECTRUM = 1000
MOST_TIMES = 4  # times its length, that a log is said to be too short by at most. ASSUMPTION
# of what one explanation takes off the held-out mean square, that another takes in its place. ASSUMPTION
AS_MUCH = 0.9
# share of a value, standard error: the declared model's own, ten times noise's (seeds 1000 to 1999)
MODEL_ERROR = 0.03
ROUNDING = 0.001  # share of the held-out mean square, up to which a loss or a gain is rounding. ASSUMPTION
# blocks of training rows: fewer clusters give too small a covariance (20 to 50: Cameron and Miller 2015)
FEWEST_BLOCKS = 20
# part of the best one's gain, from which on another name is a rival worth a paired test. ASSUMPTION
RIVAL_GAIN = 0.5
PAIRED_LOSS = 2.0  # log likelihood that a rival may lose and still not be told apart. ASSUMPTION
TIE = 1e-3  # log likelihood by which two fits of the same columns differ: rounding; arithmetic

# --- the search

MOST_EFFECTS = 5  # effects per channel at most. ASSUMPTION
# rows per column before a fit on a log too short for an interval is tried at all. ASSUMPTION
ROWS_PER_COLUMN = 8
TRIED = 4  # candidates that are judged in a look, best first. ASSUMPTION: more cost time, fewer miss a name
# the same when a pick is looked at again beside all others. ASSUMPTION: candidates as with TRIED
TRIED_AGAIN = 3
# times its log likelihood that a smooth function without a name counts: it can imitate most names. ASSUMPTION
UNNAMED = 0.85
# of the gain of a stage's line, that a line next to it must gain more (opened seeds 20261124 and 20261126)
MORE = 0.05
SAME_SHAPE = 0.1  # of the mean square of what two add: more apart, they are two explanations. ASSUMPTION
# share of mean square that two picks may have in common and not change each other's rank. ASSUMPTION
APART = 0.01
# candidates fitted in full, each with its own noise model. ASSUMPTION: time against names missed
CONTENDERS = 8
# candidates of CONTENDERS, at least, from the ranking on the residual as it is. ASSUMPTION
PLAIN_CONTENDERS = 2
FORMS_PER_EFFECT = 2  # forms of one effect over one domain that are fitted in full. ASSUMPTION
# times 1/n that every column must take of the mean square: three times what it takes by chance. ASSUMPTION
COLUMN_PRICE = 3.0
# columns filtered and projected at once: what stays in a core's cache for 2e4 rows; arithmetic, no decision
SCAN_COLUMNS = 32
# of an order: two stages that mesh turn in whole ratios, to the digits of a rig file. ASSUMPTION
SAME_ORDER_SHARE = 1e-6

# --- refinement of nonlinear parameters

# rounds of coordinate searches, each on a finer grid. ASSUMPTION: the last step is a ninth of the grid's
REFINE_ROUNDS = 3
REFINE_POINTS = 7  # points per coordinate and round. ASSUMPTION: they divide the reach by REFINE_REACH
# grid steps that the first round reaches to either side, and by which every round is finer. ASSUMPTION
REFINE_REACH = 3.0
POLISH_EVALUATIONS = 90  # evaluations of the joint search. ASSUMPTION: it ends by itself before
SLOPE_STEP = 0.3  # of a grid step, to either side, for the slope of a column. ASSUMPTION: far above rounding
# of a nonlinear parameter's small step, standard error: the grid it was refined on. ASSUMPTION
STEP_ERROR = 0.15

# --- held-out rows and cross-validation

# share of a run's rows that are slower than its reach, by which runs are ordered. ASSUMPTION
QUICK_SHARE = 0.9
# share of the rows that are fitted where the ends of runs are held out. ASSUMPTION: enough to judge by
FITTED_SHARE = 0.7
# rows to compare two models on, held out. ASSUMPTION: the mean square of fewer scatters by a third
FEWEST_HELD = 20
# held-out rows that one figure is told of: a floor, a law's gains. ASSUMPTION: fewer are a few moves
FEWEST_TOLD = 60
# rows to cross-validate on, all folds together. ASSUMPTION: ten to a fold, whose gains must all be gains
FEWEST_VALIDATED = 50
FOLDS = 5  # folds of the cross-validation, the usual five (Hastie 2009, 7.10)
# s per piece at most: pieces of one fold are spread over all runs. ASSUMPTION: longer than a noise's memory
FOLD_S = 6.0
PER_FOLD = 2  # pieces of a fold at least: a short log is cut finer, never left in one piece. ASSUMPTION
LEAST_PIECE = 8  # rows of a piece at least. ASSUMPTION

# --- the gate

# surrogates (docs/reference/calibration.md, step 7): the quantile below stands on the largest four of them
DRAWS = 400
# quantile of the surrogates' largest score: at most 1 % false alarms (docs/reference/calibration.md, step 7)
GATE_LEVEL = 0.99

# --- a step that no fitted row saw

ONSETS = 9  # places tried over the stretch, both ends among them (docs/reference/calibration.md, step 6)
# of the columns' rms on fitted rows, by which two onsets differ that are told apart. ASSUMPTION
ONSET_ALIKE = 0.01
# s: a stretch worth the name, the longest one that is followed, and how finely its ends are told. ASSUMPTION
SHORTEST_UNSEEN_S = 2.0
LONGEST_UNSEEN_S = 1e4  # s: longer than any log's pause. ASSUMPTION
# of an effect that begins, that declared terms must leave: a variance inflation of ten is the usual limit of
# collinearity (Kutner et al., Applied Linear Statistical Models, 10.5). Seed 1922: a false one 0.001, true
# ones from 0.43 on
OWN = 0.1
ONSET_FINE_S = 0.25  # s to which a stretch's ends are told. ASSUMPTION

# --- effects left out at the end

# of the held-out mean square that all effects take: less may be what the strongest one's formula leaves of
# it. A sixth in amplitude; of ratio 1 beside 5 effects are worth 1/26 (seed 1012, opened 20261122)
REMAINDER = 0.03
# of the same, that the strongest effect takes alone: else others are there for themselves. ASSUMPTION
DOMINANT = 0.95
# of the held-out mean square above the floor, that an effect must take of it beside all others. ASSUMPTION
OF_THE_UNEXPLAINED = 0.1
# of the lesser of two effects, that their sum leaves of them: they cancel each other. ASSUMPTION: a half
CANCELS = 0.5
# share of the held-out mean square that names must take below the floor: most of it. ASSUMPTION
CLEAR_SHARE = 0.5
CLEAR_Z = 3.0  # standard errors of it, and of an amplitude told among many (opened seed 20261211: 3.4)

# --- parameters and their intervals

MOST_WAVES = 6  # sine pairs that are reported, small ones too. ASSUMPTION: what a reader reads
# of the largest section's amplitude, below which a section hardly shows a line. ASSUMPTION
SHOWN_SECTION = 0.2
# degrees of freedom, values at least, so that an interval from few blocks stays finite. ASSUMPTION
FEWEST_FREEDOM = 3

# --- controls

# turns by which a wrong tooth count must shift the line over the travel, to be a test. ASSUMPTION
TOOTH_TURNS = 0.7
# share of the reversed columns' mean square within the span of the right ones: the same effect. ASSUMPTION
REVERSIBLE = 0.4

# --- what is still missing

# after / floor, times, beyond which something is still missing. ASSUMPTION: not fitted to any log
STILL_MISSING = 2.0
DOMAIN_BINS = 24  # bins of a domain at most, each with as many rows as the next. ASSUMPTION
FEWEST_DOMAIN_BINS = 8  # bins, fewest, of a domain. ASSUMPTION
ROWS_PER_BIN = 10  # rows per bin at least. ASSUMPTION
# share of the mean square, explained on rows the means are not made of, before a domain is named. ASSUMPTION
LEAST_SHARE = 0.1
# the same of a channel twice above its floor: chance alone has none there (seed 1043: a brush has 0.07)
SHOWN = 0.05

# --- late columns

SMALLEST_LAG_S = 1.2e-4  # s: shorter lags are within an interrupt's latency. ASSUMPTION
WINDOW_DELAY_S = 0.0025  # s: the velocity column counts over the last 5 ms (paper 3.3): half of it
# s, least and most of the volts on a sound log: a tick (paper 3.3), L/R of 0.5 to 5 ms (ASSUMPTION), a latch
SOUND_VOLTS_LAG_S = (0.003, 0.0105)
# s of the volts on sound logs, 0.0051 to 0.0068 (seeds 1024 to 1027): a tick and what the winding needs
SOUND_LAG_S = 0.006
# s: a measurement behind another frame on the bus, 130 bits each at 1 Mbit/s (FIDELITY.md: not in its age)
BUS_WAIT_S = 2.6e-4
TICK_S = 0.005  # s: the loop's, paper 3.3
CONFIRMED = 0.6  # of the delay seen against the effort, that the torque must lag the motion. ASSUMPTION
SLACK_S = 0.002  # s beyond SOUND_VOLTS_LAG_S before the volts alone call a column late. ASSUMPTION
LATE_CURRENT_S = 0.0015  # s against the encoder; a converter's own delay is well below a tick. ASSUMPTION
# s, the reach of a lag's interval: a wider one says nothing. Of encoders and the velocity. ASSUMPTION
SURE_LAG_S = 3e-4
SURE_VOLTS_LAG_S = 1e-3  # s, the same of the volts. ASSUMPTION
# times its interval's reach that a lag of encoders must be. ASSUMPTION: five standard errors
LAG_OVER_ERROR = 2.5
# times its interval's reach that the currents' lag must be. ASSUMPTION: six standard errors
CURRENT_OVER_ERROR = 3.0
SAME_LAG = 0.3  # of a lag, that two of one column may differ by. ASSUMPTION
# degrees of freedom, values, of Student's t for a lag: any large number of blocks gives 2.0. ASSUMPTION
LAG_FREEDOM = 60


@dataclass(frozen=True)
class Earned:
    """Answers of one kind on sealed development logs, and how many first names were right."""

    right: int
    named: int

    @property
    def probability(self) -> float:
        """Laplace's rule of succession: never 0 or 1, and near a half where hardly any were seen."""
        return (self.right + 1) / (self.named + 2)


# Axis logs of tests/blind, development seeds 1025 and 1027, set strata: all 126 effects in the answers that
# the finder of commit b383650 gave. No answer was ambiguous there: that kind keeps the two of seed 1800
# (commit b92d544). docs/reference/blind-tests.md has the table.
AXIS_EARNED = {
    "sole": Earned(98, 98),
    "further": Earned(16, 18),
    "ambiguous": Earned(0, 2),
    "above": Earned(9, 10),
}
