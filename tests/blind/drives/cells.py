"""The list of cases of a seed."""

import random

from tests.blind.drives.effects import OUTSIDE, WHERE
from tests.blind.drives.families import FAMILIES
from tests.blind.drives.order import Order
from tests.blind.drives.sensors import NOISES

SPOILS = ("", "spikes", "gaps")
SECONDS = (30.0, 60.0, 5.0, 30.0)


def nothing(repeats: int = 3) -> list[Order]:
    """Drives in which nothing is hidden: every family, noise and kind of bad rows; some short, some with two
    sensors."""
    out = []
    for kind in FAMILIES:
        for noise in NOISES:
            for k in range(repeats):
                spoil = SPOILS[k % 3]
                key = f"drive-nothing-{kind}-{noise}-{k}"
                two = kind in ("servo", "belt") and k % 3 == 0
                law = kind in ("ball_screw", "table") and k % 2 == 0
                out.append(
                    Order(
                        key,
                        "nothing",
                        kind,
                        (),
                        0.0,
                        noise,
                        "" if two else spoil,
                        SECONDS[len(out) % 4],
                        two,
                        law,
                    )
                )
    return out


def single(ratios: tuple[float, ...] = (2.0, 5.0), repeats: int = 1) -> list[Order]:
    """Every name in every family it is drawn for."""
    out = []
    for draw, kinds in WHERE.items():
        for kind in kinds:
            for ratio in ratios:
                for k in range(repeats):
                    key = f"drive-single-{draw.__name__}-{kind}-{ratio:g}-{k}"
                    noise = NOISES[len(out) % 2]
                    out.append(Order(key, "single", kind, (draw.__name__,), ratio, noise, "", 40.0))
    return out


def outside(ratios: tuple[float, ...] = (2.0, 5.0)) -> list[Order]:
    """What the catalogue does not have."""
    return [
        Order(
            f"drive-outside-{draw.__name__}-{kind}-{ratio:g}",
            "outside",
            kind,
            (draw.__name__,),
            ratio,
            seconds=40.0,
        )
        for draw, kinds in OUTSIDE.items()
        for kind in kinds
        for ratio in ratios
    ]


#: what is hidden in the two kinds of drive that are made by files of their own
MOUNT, MOUNT_OUTSIDE = ("worm_error", "gear_error"), ("belt_tooth",)
TELESCOPE = (
    "friction_asymmetry", "gravity_imbalance", "gear_eccentricity", "gear_mesh", "torque_ripple",
    "load_friction", "brake_drag", "position_friction", "supply_sag", "pwm_deadband", "magnet_weakening",
    "roller_ratio", "channel_delay",
)  # fmt: skip
TELESCOPE_OUTSIDE = ("outside_quadratic",)
HOUR_S = 3600.0


def others_nothing(repeats: int = 3) -> list[Order]:
    """Mounts in which nothing is hidden, three files of an hour, some of 20 minutes; axes with two motors."""
    out = []
    for k in range(repeats):
        for noise in NOISES:
            key, seconds = f"drive-nothing-mount-{noise}-{k}", HOUR_S / 3 if k % 3 == 2 else HOUR_S
            out.append(Order(key, "nothing", "mount", (), 0.0, noise, "gaps" if k % 2 else "", seconds))
        out.append(Order(f"drive-nothing-telescope-{k}", "nothing", "telescope", law=k % 2 == 0))
    return out


def others_single(ratios: tuple[float, ...] = (2.0, 5.0)) -> list[Order]:
    """Every name of mounts and of axes with two motors."""
    return [
        Order(
            f"drive-single-{name}-{kind}-{ratio:g}", "single", kind, (name,), ratio,
            NOISES[k % 2] if kind == "mount" else "gaussian", "", HOUR_S if kind == "mount" else 0.0, False,
            k % 2 == 0,
        )
        for kind, names in (("mount", MOUNT), ("telescope", TELESCOPE))
        for k, name in enumerate(names)
        for ratio in ratios
    ]  # fmt: skip


def others_outside(ratios: tuple[float, ...] = (2.0, 5.0)) -> list[Order]:
    """What the catalogue does not have in them."""
    return [
        Order(f"drive-outside-{name}-{kind}-{ratio:g}", "outside", kind, (name,), ratio, seconds=HOUR_S)
        for kind, names in (("mount", MOUNT_OUTSIDE), ("telescope", TELESCOPE_OUTSIDE))
        for name in names
        for ratio in ratios
    ]


def others(repeats: int = 3) -> list[Order]:
    """Mounts and axes with two motors."""
    return others_nothing(repeats) + others_single() + others_outside()


def everything() -> list[Order]:
    """The scored set."""
    return nothing(6) + single(repeats=2) + outside() + others(6)


def develop() -> list[Order]:
    """A smaller set to develop on."""
    return nothing(3) + single() + outside() + others(1)


def quick() -> list[Order]:
    """A few for continuous integration."""
    names = ("gravity_imbalance", "channel_delay", "play")
    return nothing(1)[::3] + [
        o for o in single((5.0,)) if o.names[0] in names and o.kind in ("servo", "ball_screw")
    ]


def sample() -> list[Order]:
    """Every seventh case of the scored set: for a scored run in some twenty minutes of a core."""
    return everything()[::7]


def strata() -> list[Order]:
    """Every name once, in a family and at a ratio in turn, every family and noise of nothing, every thing
    outside; in an order drawn once, so that whatever part there is time for is a sample of all."""
    out = nothing(1)
    for k, (draw, kinds) in enumerate(WHERE.items()):
        kind, ratio = kinds[k % len(kinds)], (2.0, 5.0)[k % 2]
        out += [o for o in single((ratio,)) if o.names == (draw.__name__,) and o.kind == kind]
    out += [o for k, o in enumerate(outside()) if k % 4 == (k // 4) % 4]
    out += others_nothing(1)
    out += [o for k, o in enumerate(others_single()) if k % 2 == (k // 2) % 2]
    out += [o for k, o in enumerate(others_outside()) if k % 2 == (k // 2) % 2]
    random.Random(ORDER).shuffle(out)
    return out


ORDER = 7  # of the shuffle of `strata`
SETS = {
    "others": others,
    "strata": strata,
    "everything": everything,
    "sample": sample,
    "develop": develop,
    "quick": quick,
}
