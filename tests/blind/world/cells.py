"""The list of cases of a seed."""

import random

from tests.blind.drives.order import Order

NOISES = ("gaussian", "heavy", "drift")
SHUFFLE = 11
#: kind -> (name, how often)
SINGLE: dict[str, tuple[tuple[str, int], ...]] = {
    "motor": (
        ("motor_cogging", 9), ("command_disturbance", 6), ("bearing_pass", 3), ("brake_drag", 2),
        ("gear_eccentricity", 2), ("gear_mesh", 2), ("damaged_tooth", 2),
    ),
}  # fmt: skip
OUTSIDE: dict[str, tuple[str, ...]] = {
    "motor": ("outside_telegraph", "outside_swept", "outside_growing", "outside_telegraph", "outside_swept"),
}
SHORT: dict[str, tuple[str, ...]] = {"motor": ("motor_cogging", "command_disturbance", "bearing_pass")}
NOTHING = {"motor": 9}
RATIOS = (2.0, 3.0, 5.0, 10.0)


def _order(cell: str, kind: str, names: tuple[str, ...], k: int, spoil: str = "") -> Order:
    name = names[0] if names else "none"
    ratio = RATIOS[k % 4] if names else 0.0
    key = f"world-{cell}-{kind}-{name}-{k}" + (f"-{spoil}" if spoil else "")
    return Order(key, cell, kind, names, ratio, NOISES[k % 3], spoil, 0.0, k % 3 == 1)


def nothing() -> list[Order]:
    """Logs in which nothing is hidden."""
    return [_order("nothing", kind, (), k) for kind, count in NOTHING.items() for k in range(count)]


def single() -> list[Order]:
    """One effect, at a ratio of two or more."""
    return [
        _order("single", kind, (name,), k)
        for kind, names in SINGLE.items()
        for name, count in names
        for k in range(count)
    ]


def outside() -> list[Order]:
    """What no name explains."""
    return [_order("outside", kind, (n,), k) for kind, names in OUTSIDE.items() for k, n in enumerate(names)]


def short() -> list[Order]:
    """Logs that are too short to be sure."""
    return [_order("short", kind, (n,), k) for kind, names in SHORT.items() for k, n in enumerate(names)]


def everything() -> list[Order]:
    """The scored set."""
    return nothing() + single() + outside() + short()


def part(count: int) -> list[Order]:
    """A sample of every cell and family in its share, in an order drawn once."""
    groups: dict[tuple[str, str], list[Order]] = {}
    for order in everything():
        groups.setdefault((order.cell, order.kind), []).append(order)
    total = sum(map(len, groups.values()))
    out: list[Order] = []
    for some in groups.values():
        want = max(1, round(count * len(some) / total))
        out += [some[int((j + 0.5) * len(some) / want)] for j in range(want)]
    random.Random(SHUFFLE).shuffle(out)
    return out


def strata() -> list[Order]:
    """About sixty cases across all."""
    return part(60)


def develop() -> list[Order]:
    """Forty cases to develop on."""
    return part(40)


SETS = {"everything": everything, "strata": strata, "develop": develop}
