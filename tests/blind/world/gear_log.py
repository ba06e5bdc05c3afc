"""A case of two sensors: what is hidden between them, the files, the rig file."""

from collections.abc import Callable

import numpy as np

from tests.blind.drives.order import Order
from tests.blind.world import gears, logfile, oracle
from tests.blind.world.gears import Gear, Twist
from tests.blind.world.logfile import Column, Log, Style
from tests.blind.world.made import TURN, Array, Hidden, Made, Rng, clock, pick
from tests.blind.world.rigtext import Rig

Draw = Callable[[Rng, Gear], tuple[Hidden, Twist]]


def play(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """A gap between the teeth."""
    return Hidden("play", "K", ("reversal", "velocity")), Twist(gap=g.out_step)


def eccentric(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """The output's sensor off its centre: once, sometimes twice per output turn."""
    sines = [(1.0, g.out_step, rng.uniform(0, TURN))]
    if rng.random() < 0.5:
        sines.append((2.0, 0.4 * g.out_step, rng.uniform(0, TURN)))
    hidden = Hidden("encoder_eccentricity", "K", ("axis_angle",), ("gear_eccentricity",), stage="output")
    return hidden, Twist(sines=sines)


def input_wave(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """The motor's side: once or twice per motor turn."""
    sines = [(g.ratio * pick(rng, 1.0, 2.0), g.out_step, rng.uniform(0, TURN))]
    alike = ("encoder_eccentricity", "gear_mesh")
    stage = "output" if g.ratio == 1.0 else "motor"
    return Hidden("gear_eccentricity", "K", ("axis_angle", "motor_angle"), alike, stage=stage), Twist(
        sines=sines
    )


def wind_up(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """Teeth and shafts that bend with the torque, which the log has."""
    return Hidden("shaft_compliance", "K", ("current",)), Twist(wind=g.out_step)


def slip(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """A coupling that slips, one to three times a file."""
    slips = [
        (float(x), g.out_step * pick(rng, -1.0, 1.0))
        for x in rng.uniform(0.15, 0.85, int(rng.integers(1, 4)))
    ]
    return Hidden("roller_slip", "K", ("time",)), Twist(slips=slips)


def late(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """The output's column is late."""
    return Hidden("channel_delay", "S", ("clock",)), Twist(late_s=g.period_s)


def scale(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """Another ratio than the declared one: a wheel that is too small."""
    return Hidden("roller_ratio", "K", ("axis_angle",)), Twist(scale=g.out_step)


def thermal(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """A sensor that drifts with the temperature, which the log has."""
    return Hidden("encoder_thermal_drift", "S", ("temperature",)), Twist(warm=g.out_step / 10)


def bump(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """A dent in a rack or a tape: one place of the travel."""
    place = (rng.uniform(-0.25, 0.25) * g.travel, rng.uniform(0.02, 0.06) * g.travel, g.out_step)
    return Hidden("outside_bump", "K", ("axis_angle",)), Twist(bump=place)


def shake(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """A sensor on a bracket that swings at a frequency of its own."""
    hertz = rng.uniform(20.0, 60.0) / g.seconds
    return Hidden("outside_shake", "K", ("time",), ("command_disturbance",)), Twist(shake=(hertz, g.out_step))


def cubic(rng: Rng, g: Gear) -> tuple[Hidden, Twist]:
    """A coupling that stiffens: more than in proportion to the torque."""
    return Hidden("outside_stiffening", "K", ("current",)), Twist(cubic=g.out_step)


WHERE: dict[str, Draw] = {
    "play": play, "encoder_eccentricity": eccentric, "gear_eccentricity": input_wave, "roller_slip": slip,
    "shaft_compliance": wind_up, "channel_delay": late, "roller_ratio": scale,
    "encoder_thermal_drift": thermal,
    "outside_bump": bump, "outside_shake": shake, "outside_stiffening": cubic,
}  # fmt: skip
TRIES = 4
BETWEEN = 0.3  # of the floor: what may be lost between two readings
LEAST_LATE = 0.4  # of a row: less is a matter of how stamps are read
LOADED = ("shaft_compliance", "outside_stiffening")


def make(order: Order, rng: Rng, number: int) -> Made:
    """Files, rig file, truth."""
    g = gears.draw(rng)
    name = order.names[0] if order.names else ""
    if name in ("gear_eccentricity",) and g.ratio > 1.0:
        g.travel = min(g.travel, 60.0 / g.ratio)  # the sweeps' rows resolve the motor's turn
    if name == "encoder_eccentricity":
        g.travel = max(g.travel, 1.3)
    if order.cell == "short":
        g.files, g.seconds = 1, g.seconds / 12
    long = order.spoil.startswith("long")
    if long:
        g.every = int(pick(rng, 1.0, 2.0, 5.0))
    hidden, unit = WHERE[name](rng, g) if name else (None, Twist())
    xs = [gears.motion(np.random.default_rng([number, 1, k]), g) for k in range(g.files)]
    while long and max(gears.between(g, x) for x in xs) > BETWEEN * g.floor:
        xs = [x / 2 for x in xs]  # shorter sweeps: a straight line between two readings is the motion
    loads = [gears.torque(np.random.default_rng([number, 2]), g, x) for x in xs]
    span = g.files * g.seconds
    begun = [k * (g.seconds + 5.0) for k in range(g.files)]
    warm = [
        gears.temperature(np.random.default_rng([number, 3]), clock(len(x), g.period_s), b, span)
        for x, b in zip(xs, begun, strict=True)
    ]

    def outputs(w: Twist) -> list[Array]:
        parts = zip(xs, loads, warm, begun, strict=True)
        return [gears.output(w, g, x, u, k, b, g.seconds) for x, u, k, b in parts]

    joined = np.concatenate(xs)
    base = np.column_stack([np.repeat(np.eye(g.files), [len(x) for x in xs], axis=0)])
    if name != "roller_ratio":
        base = np.column_stack([base, joined])
    size, reached = 1.0, 0.0
    for _ in range(TRIES if hidden else 0):
        own = np.concatenate(outputs(unit.times(size))) - joined
        reached = oracle.ratio(own, base, g.floor)
        if abs(reached / order.ratio - 1.0) < 0.05:
            break
        size *= float(np.clip(order.ratio / max(reached, 1e-9), 0.02, 50.0))
        size = max(size, LEAST_LATE) if name == "channel_delay" else size
    ys = outputs(unit.times(size) if hidden else Twist())
    if hidden is not None:
        hidden.raw = {"size": size, "gap": unit.gap * size, "late_s": unit.late_s * size}
    files, rig = _tables(order, rng, g, (xs, ys, loads, warm), begun, name)
    drive = {**vars(g), "floor": g.floor}
    return Made(files, rig, hidden, reached, drive)


def _tables(
    order: Order, rng: Rng, g: Gear, parts: tuple[list[Array], ...], begun: list[float], name: str
) -> tuple[dict[str, str], str]:
    """The files' texts and the rig file's."""
    shape = order.spoil or str(rng.choice(["comma", "tab", "semicolon"]))
    shape = "comma" if shape == "iso" else shape
    style = Style("iso" if order.spoil else str(rng.choice(["s", "ms"])), shape)
    unit, per = [("turn", 1.0), ("deg", 360.0), ("rad", TURN), ("arcmin", 21600.0)][int(rng.integers(4))]
    with_load = name in LOADED or rng.random() < 0.4
    with_warm = name == "encoder_thermal_drift" or rng.random() < 0.3
    files: dict[str, str] = {}
    last: list[Column] = []
    for k, (x, y, load, warm) in enumerate(zip(*parts, strict=True)):
        noise = (
            rng.standard_t(3, len(x)) / np.sqrt(3) if order.noise == "heavy" else rng.standard_normal(len(x))
        )
        seen = np.floor(y / g.out_step + g.noise * noise + rng.random())
        counts = np.floor(x / g.in_step + rng.random())
        last = [
            Column("position", "motor", unit, counts, "%d", (f"scale: {g.in_step * per!r}",)),
            Column("position2", "output", unit, seen, "%d", (f"scale: {g.out_step * per!r}",), g.every),
        ]
        if with_load:
            pull = g.load * (load + g.load_noise * rng.standard_normal(len(x)))
            last.append(Column("effort", "torque", "N m", pull, "%.6g"))
        if with_warm:
            last.append(Column("temperature", "housing", "degC", np.round(warm, 1), "%.1f"))
        t = clock(len(x), g.period_s)
        files[f"run{k + 1}.{style.ending}"] = logfile.write(Log(t, last, begun[k]), style, rng)
    declared = ", ratio: 1.0" if name == "roller_ratio" or rng.random() < 0.4 else ""
    stages = [f"name: output, period: {per!r}, harmonics: 3"]
    if g.ratio > 1.0:
        stages.append(f"name: motor, period: {per / g.ratio!r}, harmonics: 2")
    told = logfile.told(last, style, g.period_s, [])
    answer = f'channel: position2, unit: "{unit}"{declared}'
    return files, Rig("gear with two sensors", told, answer, ("offset",), stages).text()
