"""The list of cases of a seed."""

import random
from dataclasses import replace

from tests.blind.drives.order import Order

NOISES = ("gaussian", "heavy", "drift")
SHUFFLE = 11
#: kind -> (name, how often)
SINGLE: dict[str, tuple[tuple[str, int], ...]] = {
    "gear": (
        ("play", 4), ("encoder_eccentricity", 3), ("gear_eccentricity", 2), ("shaft_compliance", 2),
        ("roller_slip", 2), ("channel_delay", 2), ("roller_ratio", 1), ("encoder_thermal_drift", 1),
    ),
    "guide": (("worm", 13), ("before", 4)),
    "rate": (("worm", 4), ("before", 2)),
    "arm": (
        ("gravity_imbalance", 9), ("cable_wrap", 3), ("position_friction", 3), ("load_friction", 2),
        ("brake_drag", 2), ("friction_warmup", 2), ("command_disturbance", 2), ("gear_eccentricity", 2),
    ),
    "motor": (
        ("motor_cogging", 9), ("command_disturbance", 6), ("bearing_pass", 3), ("brake_drag", 2),
        ("gear_eccentricity", 2), ("gear_mesh", 2), ("damaged_tooth", 2),
    ),
}  # fmt: skip
OUTSIDE: dict[str, tuple[str, ...]] = {
    "gear": (*("outside_bump", "outside_shake", "outside_stiffening") * 2,),
    "guide": ("outside_period", "outside_flop", "outside_period", "outside_flop", "outside_period"),
    "rate": ("outside_period", "outside_flop"),
    "arm": (*("outside_stop", "outside_saturation", "outside_coupling") * 2, "outside_stop"),
    "motor": ("outside_telegraph", "outside_swept", "outside_growing", "outside_telegraph", "outside_swept"),
}
SHORT: dict[str, tuple[str, ...]] = {
    "gear": ("play", "encoder_eccentricity"),
    "guide": ("worm",) * 4,
    "rate": ("worm",),
    "arm": ("gravity_imbalance", "position_friction", "brake_drag"),
    "motor": ("motor_cogging", "command_disturbance", "bearing_pass"),
}
NOTHING = {"gear": 6, "guide": 8, "rate": 2, "arm": 10, "motor": 9}
#: (whose log, fault, what is hidden)
TABLES = (
    ("arm", "iso", "gravity_imbalance"), ("arm", "german", "brake_drag"),
    ("arm", "sign", "gravity_imbalance"), ("arm", "lines", "position_friction"),
    ("arm", "lists", "gravity_imbalance"), ("arm", "long", "cable_wrap"),
    ("arm", "long_lines", "gravity_imbalance"), ("arm", "gain", "gravity_imbalance"),
    ("arm", "load", "brake_drag"), ("arm", "gain", "cable_wrap"), ("motor", "lines", "motor_cogging"),
    ("motor", "lists", "motor_cogging"), ("motor", "semicolon", "bearing_pass"),
    ("motor", "long", "motor_cogging"), ("arm", "load", "outside_stop"),
    ("motor", "lists", "outside_telegraph"), ("arm", "long", ""), ("arm", "sign", ""),
    ("arm", "gain", ""), ("arm", "load", ""), ("motor", "lines", ""), ("motor", "long", ""),
    ("arm", "lists", ""), ("arm", "german", ""), ("gear", "long", "play"),
    ("gear", "long_lines", "play"), ("gear", "lists", "encoder_eccentricity"), ("gear", "long", ""),
    ("gear", "iso", "channel_delay"),
)  # fmt: skip
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


def tables() -> list[Order]:
    """The faults of real tables, with something inside or not."""
    out = []
    for k, (kind, fault, name) in enumerate(TABLES):
        cell = "outside" if name.startswith("outside") else "single" if name else "nothing"
        order = _order(cell, "table", (name,) if name else (), k, f"{kind} {fault}")
        out.append(replace(order, key=order.key.replace(" ", "-")))
    return out


def everything() -> list[Order]:
    """The scored set."""
    return nothing() + single() + outside() + short() + tables()


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
