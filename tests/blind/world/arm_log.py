"""An arm's case: files, the rig file, and what its oracle can tell."""

import numpy as np

from tests.blind.drives.order import Order
from tests.blind.world import arm, logfile, oracle
from tests.blind.world import arm_kernel as kernel
from tests.blind.world.arm import Arm
from tests.blind.world.arm_effects import WHERE, Effect
from tests.blind.world.arm_oracle import Runs, columns_of, confounded, logged, seen
from tests.blind.world.logfile import Column, Log, Style
from tests.blind.world.made import TURN, Array, Made, Rng, clock, pick, wide
from tests.blind.world.rigtext import Rig

LEAST_SEEN = 2.0  # what the log's own columns must show, over the same log without the effect
TRIES = 4


def sized(
    a: Arm, effect: Effect, weight: dict[str, float], goals: list[Array], number: int, wanted: float
) -> tuple[float, float, Runs]:
    """Size, ratio reached, runs: the drive is run again until the ratio is met."""
    size, reached, runs = 1.0, 0.0, arm.run(a, weight, goals, number)
    for _ in range(TRIES):
        runs = arm.run(a, {**weight, **effect.values(size)}, goals, number)
        rows, base, _ = columns_of(a, runs, effect.weight)
        reached = oracle.ratio(rows[:, kernel.OWN], base, a.floor)
        if 0.93 < reached / wanted < 1.07 or (size >= effect.most and reached < wanted):
            break
        size = min(size * float(np.clip(wanted / max(reached, 1e-9), 0.1, 10.0)), effect.most)
    return size, reached, runs


def make(order: Order, rng: Rng, number: int) -> Made:
    """Files, rig file, truth. Another arm is drawn where no plausible size is seen in this one, or its loop
    runs away."""
    name = order.names[0] if order.names else ""
    for _ in range(40):
        if (found := _one(order, rng, number, name)) is None:
            continue
        made = found
        tells = order.cell == "short" or made.drive["seen_over_sound"] > LEAST_SEEN
        if not name or (made.reached > 0.9 * order.ratio and tells):
            return made
    return made


def _one(order: Order, rng: Rng, number: int, name: str) -> Made | None:
    a, weight = arm.draw(rng)
    if order.cell == "short":
        a.files, a.seconds = 1, wide(rng, 1.5, 4.0)
    if name == "gear_eccentricity":
        a.gear = min(a.gear, 0.1 / (a.speed * a.period_s))  # the motor's line is well below the rows' rate
        a.values["STEP"] = min(a.values["STEP"], TURN / a.gear / 60)
    effect = WHERE[name](rng, a, weight) if name else None
    lifted = {"GRAV": weight * rng.uniform(0.5, 1.2), "GRAV_P": float(rng.uniform(-0.6, 0.6))}
    declares = effect.weight if effect else rng.random() < 0.6
    two = declares and rng.random() < 0.25
    if two:
        lifted["GRAV2"] = 0.6 * weight
    if not declares:
        lifted = {}
    if declares and not two and a.files >= 3 and (order.spoil == "load" or rng.random() < 0.4):
        a.loads = [float(x) for x in rng.choice([0.5, 0.8, 1.2, 1.5, 2.0], a.files)]
    if not name and rng.random() < 0.3:
        a.values["STIC"] = a.values["COUL"] * rng.uniform(1.2, 1.6)  # and declared
    goals = arm.paths(rng, a)
    size, reached, tells, runs = 0.0, 0.0, 1.0, arm.run(a, lifted, goals, number)
    if effect is not None:
        sound = seen(a, runs, declares, number)
        size, reached, runs = sized(a, effect, lifted, goals, number, order.ratio)
        rows, base, torque = columns_of(a, runs, effect.weight)
        torque = torque + a.floor * np.random.default_rng([number, 8]).standard_normal(len(torque))
        effect.hidden.confounded = confounded(name, rows, base, torque)
        effect.hidden.raw = effect.values(size)
        shares = np.array(seen(a, runs, declares, number)) / np.array(sound)
        tells = float(np.nanmax(shares)) if np.isfinite(shares).any() else 0.0
    if not all(np.isfinite(rows).all() for rows, _ in runs):
        return None
    files, rig = _tables(order, rng, a, runs, declares, two, number)
    drive = {
        **a.values,
        **lifted,
        "seconds": a.seconds,
        "files": a.files,
        "stroke": a.stroke,
        "floor": a.floor,
        "seen_over_sound": tells,
    }
    return Made(files, rig, effect.hidden if effect else None, reached, drive)


def _tables(
    order: Order, rng: Rng, a: Arm, runs: Runs, declares: bool, two: bool, number: int
) -> tuple[dict[str, str], str]:
    """The files' texts and the rig file's."""
    faults = {"iso": Style("iso", "comma"), "german": Style("german", "semicolon")}
    usual = Style(str(rng.choice(["s", "ms"])), str(rng.choice(["comma", "semicolon", "tab"])))
    shaped = order.spoil in ("lines", "lists", "long", "long_lines")
    style = (
        Style("iso" if rng.random() < 0.5 else "s", order.spoil) if shaped else faults.get(order.spoil, usual)
    )
    unit, scale = [("rad", 1.0), ("deg", 360.0 / TURN)][int(rng.integers(2))]
    step = a.values["STEP"]
    per = 1.0 if a.force == "N m" else pick(rng, 1.0, a.values["GAIN"])
    files, last, start = {}, [], 0.0
    gains = [float(x) for x in rng.choice([1.0, 2.0, 4.0, 8.0], len(runs))]
    names = [f"run{k + 1}" for k in range(len(runs))]
    for k, (rows, angle) in enumerate(runs):
        effort = logged(a, rows, np.random.default_rng([number, 6, k]))
        counts = (
            "position",
            "count",
            unit,
            np.floor(rows[:, kernel.X] / step),
            "%d",
            (f"scale: {step * scale!r}",),
        )
        words: tuple[str, ...] = ()
        if order.spoil == "gain":  # the loop's error is logged, its gain is not
            effort = effort / gains[k]
            factors = ", ".join(f'"{n}": {g!r}' for n, g in zip(names, gains, strict=True))
            words = (f"files: {{{factors}}}",)
        load = Column("effort", "u", a.effort, effort, "%.7g", words)
        if order.spoil == "sign":
            size = a.values["EFFORT_STEP"]
            bits = max(int(np.ceil(np.log2(a.values["TOP"] / size + 1))), 4)
            load = Column("effort", "u", a.effort, np.round(effort / size), "%d", (f"scale: {size!r}",))
            load = logfile.encode(load, bits)
        columns = [Column(*counts), load]
        if two:
            columns.append(Column("joint", "q_next", unit, angle * scale, "%.6f"))
        t = clock(len(rows), a.period_s)
        files[f"{names[k]}.{style.ending}"] = logfile.write(Log(t, columns, start), style, rng)
        last, start = columns, start + len(rows) * a.period_s + 2.0
    more = []
    if a.loads:
        factors = ", ".join(f'"{n}": {x!r}' for n, x in zip(names, a.loads, strict=True))
        more.append(f"load: {{files: {{{factors}}}, unit: kg}}")
    told = logfile.told(last, style, a.period_s, more)
    known = f", gain: {a.values['GAIN']!r}" if per != 1.0 else ""
    unit_of = "N m" if per != 1.0 else a.effort
    estimate = ("inertia", "viscous", "coulomb", "offset", *(["gravity"] if declares else []))
    turn = 360.0 if unit == "deg" else TURN
    stages = [
        f"name: joint, period: {turn!r}, harmonics: 2",
        f"name: motor, period: {turn / a.gear!r}, harmonics: 2",
    ]
    extra = ["runs: {origin: shared}"]
    extra += [
        "wall_time: {from: time}" if style.time in ("iso", "german") else "wall_time: {from: order, gap_s: 2}"
    ]
    ratio = a.values["STIC"] / a.values["COUL"]
    if ratio > 1.0:
        speed = a.values["VS"] * scale
        extra.append(
            f"friction_law: {{stiction_ratio: {ratio:.3g}, stribeck_speed: {speed:.3g}, source: its maker}}"
        )
    answer = f"channel: effort, unit: {unit_of}{known}"
    return files, Rig("joint of an arm", told, answer, estimate, stages, extra).text()
