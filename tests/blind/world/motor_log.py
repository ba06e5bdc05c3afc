"""A motor's case: files at one or two speeds, the rig file, and what its oracle can tell."""

import math

import numpy as np

from tests.blind.drives.order import Order
from tests.blind.world import logfile, oracle
from tests.blind.world.logfile import Column, Log, Style
from tests.blind.world.made import TURN, Array, Made, Rng, clock, pick
from tests.blind.world.motor import Motor, draw, loop_of, noise, speeds, spun, summed, turned
from tests.blind.world.motor_effects import GEARED, OVER_ANGLE, WHERE, Effect
from tests.blind.world.rigtext import Rig

IN_ANGLE = ("motor_cogging", "torque_ripple", "gear_eccentricity", "gear_mesh", "bearing_pass")


def files_of(
    m: Motor, effect: Effect | None, plan: list[float], number: int, kind: str, size: float, viscous: float
) -> tuple[list[Array], list[Array], list[Array]]:
    """Turns, response and the effect's own part of it, per file."""
    t = clock(m.rows, m.period_s)
    turns, response, own = [], [], []
    for k, speed in enumerate(plan):

        def rng(use: int, k: int = k) -> Rng:
            return np.random.default_rng([number, use, k])

        if m.speed_log:
            loop = loop_of(m)
            empty = tuple(np.zeros(0) for _ in range(4))
            lines = effect.lines.arrays(rng(1), size) if effect else empty
            rows, bare = (spun(m.rows, m.period_s, speed, loop, *x) for x in (lines, empty))
            x, y, mine = rows[:, 1], rows[:, 0], rows[:, 0] - bare[:, 0]
        else:
            x = turned(rng(2), m, speed)
            mine = np.zeros(m.rows)
            if effect is not None:
                mine = summed(effect.lines, x, t, rng(1), size) if effect.lines.order else mine
                if effect.shape is not None:
                    over = x if effect.hidden.name in OVER_ANGLE else t
                    mine = mine + size * effect.shape(over, speed)
            y = m.scale + viscous * speed + mine
        turns.append(x)
        own.append(mine)
        seen = y + noise(rng(3), m.noise, m.rows, kind)
        response.append(np.round(seen / m.quantum) * m.quantum)
    return turns, response, own


def base_of(m: Motor, plan: list[float]) -> Array:
    """What the declared model takes up: an offset, and with two speeds a viscous torque."""
    one = np.ones(m.rows * len(plan))
    return np.column_stack([one, *([np.repeat(plan, m.rows)] if len(set(plan)) > 1 else [])])


def confounded(
    m: Motor, effect: Effect, plan: list[float], turns: list[Array], response: list[Array]
) -> tuple[str, ...]:
    """Names of the other domain, angle or time, that this log cannot tell from the true one."""
    if not effect.lines.order:
        return ()
    t = clock(m.rows, m.period_s)
    span, ahead = m.rows * m.period_s, 0.0
    order, hertz = effect.lines.order[0], effect.lines.hertz[0]
    if len(set(plan)) > 1:  # one line over all speeds cannot be the other's
        return ()
    base = np.ones((m.rows, 1))
    for x, y, speed in zip(turns, response, plan, strict=True):
        if hertz:
            rival = oracle.nearest(y, base, x, hertz / speed, span * speed)
            ahead += oracle.behind(y, base, oracle.line(t, hertz), rival)
        else:
            rival = oracle.nearest(y, base, t, order * speed, span)
            ahead += oracle.behind(y, base, oracle.line(x, order), rival)
    if ahead >= oracle.CLEAR:
        return ()
    return IN_ANGLE if hertz else ("command_disturbance",)


def make(order: Order, rng: Rng, number: int) -> Made:
    """Files, rig file, truth."""
    name = order.names[0] if order.names else ""
    geared = name in GEARED or (not name and rng.random() < 0.3)
    m = draw(rng, geared)
    effect = WHERE[name](rng, m, name) if name else None
    m.speed_log = order.two and not geared and (effect is None or effect.shape is None)
    short = order.cell == "short"
    highest, lowest = (effect.highest, effect.lowest) if effect else (12.0, 1.0)
    count = 1 if m.speed_log else effect.speeds if effect else int(rng.integers(1, 4))
    plan = speeds(rng, m, highest, lowest, count, rng.uniform(1.1, 1.6) if short else 8.0)
    if count == 1 and rng.random() < 0.3 and not short:
        plan = plan * 2  # the same speed once more
    if m.speed_log:
        m.of_speed(rng, plan[0])
    viscous = 0.2 * m.scale / max(plan)
    size, reached = 0.0, 0.0
    if effect is not None:
        unit = m.scale * (TURN if m.speed_log else 0.05)
        base = base_of(m, plan)
        size = unit
        for _ in range(3):
            _, _, own = files_of(m, effect, plan, number, order.noise, size, viscous)
            reached = oracle.ratio(np.concatenate(own), base, m.floor)
            if abs(reached / order.ratio - 1) < 0.05:
                break
            size *= order.ratio / max(reached, 1e-9)
    turns, response, _ = files_of(m, effect, plan, number, order.noise, size, viscous)
    if effect is not None:
        effect.hidden.confounded = confounded(m, effect, plan, turns, response)
        effect.hidden.raw["size"] = size
    files, rig = _tables(order, rng, m, plan, turns, response)
    drive = {"orders": m.orders, "speeds": plan, "floor": m.floor, "rows": m.rows, "period_s": m.period_s}
    return Made(files, rig, effect.hidden if effect else None, reached, drive)


def _tables(
    order: Order, rng: Rng, m: Motor, plan: list[float], turns: list[Array], response: list[Array]
) -> tuple[dict[str, str], str]:
    """The files' texts and the rig file's."""
    style = Style((order.spoil and "iso") or str(rng.choice(["s", "ms"])), _shape(order, rng))
    known = not m.speed_log and len(set(plan)) == 1 and m.wander < 1e-4 and rng.random() < 0.5
    counts = pick(rng, 2048.0, 4096.0, 16384.0)
    unit, per_turn = [("turn", 1.0), ("deg", 360.0), ("rad", TURN)][int(rng.integers(3))]
    files, last = {}, []
    more = []
    for k, (x, y) in enumerate(zip(turns, response, strict=True)):
        columns = []
        if m.speed_log:
            rpm = ("velocity", "rpm", f"{unit}/s", y * 60.0, "%.7g", (f"scale: {per_turn / 60!r}",))
            columns.append(Column(*rpm))
            words = (f"scale: {per_turn / 60!r}", "integrated: true")
            more = [f'position: {{column: rpm, unit: "{unit}", {", ".join(words)}}}']
        else:
            columns.append(Column("force", "torque", "N m", y, "%.7g"))
        if not known and not m.speed_log:
            scale = (f"scale: {per_turn / counts!r}",)
            columns.insert(0, Column("position", "encoder", unit, np.floor(x * counts), "%d", scale))
        if known:
            style = Style("none", "comma")
            more = [f'position: {{steps: [[0, {plan[0] * per_turn!r}]], integrated: true, unit: "{unit}"}}']
        t = clock(m.rows, m.period_s)
        files[f"run{k + 1}.{style.ending}"] = logfile.write(Log(t, columns, k * 900.0), style, rng)
        last = columns
    harmonics = ", ".join(str(o) for o in m.orders if o * max(plan) * m.period_s < 0.4)
    kind = "motor_cogging"
    stages = [f"name: motor, period: {per_turn!r}, harmonics: [{harmonics}], kind: {kind}"]
    if m.gear:
        driving, driven = m.gear
        stages += [f"name: wheel, of: motor, teeth: [{driving}, {driven}], harmonics: 3"]
        stages += [f"name: mesh, of: motor, teeth: [{driving}, 1], kind: gear_mesh, harmonics: 1"]
    told = logfile.told(last, style, m.period_s, more)
    answer = f'channel: velocity, unit: "{unit}/s"' if m.speed_log else "channel: force, unit: N m"
    estimate = ("viscous", "offset") if len(set(plan)) > 1 else ("offset",)
    return files, Rig("motor on a stand", told, answer, estimate, stages).text()


def _shape(order: Order, rng: Rng) -> str:
    """The order's fault, or a mark between cells."""
    if order.spoil:
        return order.spoil
    return str(rng.choice(["comma", "semicolon", "tab"]))


def closed_form(m: Motor, amplitude: float, hertz: float) -> float:
    """Speed ripple of a disturbance of the loop: |s / (s2 + p s + i)|."""
    p, i = loop_of(m)
    s = 1j * TURN * hertz
    return float(amplitude * abs(s / (s * s + p * s + i))) if not math.isclose(hertz, 0.0) else 0.0
