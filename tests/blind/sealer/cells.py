"""The list of cases of a seed: nothing, one effect, two effects, outside the catalogue."""

import random

from tests.blind.sealer.case import Order
from tests.blind.sealer.catalogue import APART, BY_NAME, CONFUSABLE, MONO_CLASS, OUTSIDE

NOTHING = 68  # of each kind: 204 in all
RATIOS = (1.0, 2.0, 5.0)
REPEATS = 3
OUTSIDE_CASES = 30
ORDER = 7  # of the shuffle of `strata`
KINDS = ("pure", "off", "gains")


def nothing(count: int = NOTHING) -> list[Order]:
    """Cases without an effect."""
    return [Order(f"nothing-{kind}-{i:03d}", "nothing", kind) for kind in KINDS for i in range(count)]


def single(repeats: int = REPEATS) -> list[Order]:
    """One effect: every name at every ratio. The last repeat at ratio 2 of some names has the poor
    manoeuvre."""
    out: list[Order] = []
    for name in BY_NAME:
        for ratio in RATIOS:
            for i in range(repeats):
                poor = name in MONO_CLASS and ratio == 2.0 and i == repeats - 1 and repeats > 1
                out.append(Order(f"single-{name}-{ratio:g}-{i}", "single", "mixed", (name,), ratio, poor))
    return out


def pairs() -> list[Order]:
    """Two effects at once, at ratio 2 or 5."""
    out: list[Order] = []
    for label, table in (("twin", CONFUSABLE), ("apart", APART)):
        for i, names in enumerate(table):
            out.append(Order(f"pair-{label}-{i:02d}", "pair", "mixed", names, (2.0, 5.0)[i % 2]))
    return out


def outside(count: int = OUTSIDE_CASES) -> list[Order]:
    """Effects outside the catalogue, in turn."""
    names = list(OUTSIDE)
    return [
        Order(
            f"outside-{names[i % len(names)]}-{i:02d}",
            "outside",
            "mixed",
            (names[i % len(names)],),
            (2.0, 5.0)[i % 2],
        )
        for i in range(count)
    ]


def everything() -> list[Order]:
    """All cells."""
    return nothing() + single() + pairs() + outside()


def quick() -> list[Order]:
    """A small subset for continuous integration: two of nothing, six singles, one pair, one outside."""
    names = (
        "gravity_imbalance",
        "motor_cogging",
        "supply_sag",
        "encoder_eccentricity",
        "sample_loss",
        "viscous_change",
    )
    some = [o for o in single(1) if o.names[0] in names and o.ratio == 5.0]
    return nothing(1)[:2] + some + pairs()[20:21] + outside(1)


def develop() -> list[Order]:
    """A first set to develop on: three of nothing per kind, every name at ratios 2 and 5, some pairs, each
    outside."""
    some = [o for o in single(1) if o.ratio > 1.0]
    return nothing(3) + some + pairs()[::4] + outside(len(OUTSIDE))


def sample() -> list[Order]:
    """Every eightieth case: for a scored run in some minutes of one core."""
    return everything()[::80]


def strata() -> list[Order]:
    """A case or more of every class in an order drawn once: whatever part of it there is time for is a sample
    of all of it."""
    names = [o for o in single(1) if o.ratio > 1.0]  # a pair per name: ratio 2, ratio 5
    once = [names[2 * k + (k % 2)] for k in range(len(names) // 2)]
    out = nothing(3) + once + pairs()[::5] + outside(len(OUTSIDE))
    random.Random(ORDER).shuffle(out)
    return out


SETS = {"everything": everything, "sample": sample, "strata": strata, "quick": quick, "develop": develop}
