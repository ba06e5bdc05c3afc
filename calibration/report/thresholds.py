"""Numbers of the pictures: value, unit and reason; each an ASSUMPTION about what a reader sees."""

MOST_PICTURES = 4  # pictures of effects in a balance. ASSUMPTION
BINS = 80  # bins over a domain. ASSUMPTION
BINS_OF_A_PULSE = 8  # bins over the width of a narrow pulse. ASSUMPTION: its shape shows
FEWEST_DRAWN = 20  # rows, fewest, over a domain. ASSUMPTION
FEWEST_OF_A_TRACE = 3  # rows, fewest, of a trace: a line with a bend. ASSUMPTION
MOST_MARKED = 12  # places of gaps that are marked in a trace; more would hide it. ASSUMPTION
WINDOW_S = 2.0  # s that a page can show of a trace at 10 ms. ASSUMPTION
# share of a window's rows that must be usable for it to be shown. ASSUMPTION: single rows may be missing
WHOLE = 0.99
USUAL_CANDIDATES = 1000  # candidates that a balance has before one is known to be none of it. ASSUMPTION
