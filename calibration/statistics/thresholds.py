"""Numbers of the statistics: value, unit, reason and source."""

KEPT = 1e-6  # share of a column's sum of squares that must lie beside the base: less is rounding. ASSUMPTION
# smallest eigenvalue of a block's correlations, part of 1: below, two columns are one. ASSUMPTION
APART = 1e-4
# of the largest eigenvalue of scaled normal equations: arithmetic, squares keep half of doubles' digits
SINGULAR = 1e-11
# share of the variance, as white noise: a filter must not live on smoothed bands. ASSUMPTION, against power
LOADING = 0.3
ROWS_PER_ORDER = 5  # rows per coefficient of an autoregression, at least. ASSUMPTION
# p of a chi2 tail, below which doubles underflow and the asymptotic term is exact; by arithmetic
SMALLEST_TAIL = 1e-250
# of the variance of independent means over two boxcars, that of their second difference. By arithmetic
SECOND = 6 - 32 / 19
SURE_Z = 4.0  # standard errors beyond which an estimate is surely not zero. ASSUMPTION: 1 in 3e4 by luck
