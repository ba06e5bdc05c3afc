"""Guide logs and tables of a drive at constant rate: what the mount's worm leaves in them."""

import math

import numpy as np

from tests.blind.drives.order import Order
from tests.blind.world import logfile, oracle, phd2, sky
from tests.blind.world.logfile import Column, Log, Style
from tests.blind.world.made import TURN, Array, Hidden, Made, Rng, clock, pick, wide
from tests.blind.world.rigtext import Rig
from tests.blind.world.sky import Error, Sky
from tests.blind.world.worms import BEFORE_THE_WORM, MOUNTS, UNKNOWN_MOUNTS, worms_of

HOUR_S = 3600.0
DRAWS = 6
STANDS_OUT = 4.0
"""Least amplitude over that of the noise alone at the same period; chance passes it in some 1e-7 of draws."""


def hidden_of(
    rng: Rng, name: str, period_s: float, before_s: float, seconds: float, parts_s: tuple[float, ...] = ()
) -> Error | None:
    """What the order's name hides. parts_s: other periods that the mount's name allows."""
    if name == "worm":
        return sky.worm(rng, period_s)
    if name == "before":  # a wheel before the worm, which the rig file declares
        return sky.worm(rng, before_s, "transfer")
    if name == "outside_period":
        return sky.stray(rng, period_s, parts_s)
    return sky.flops(rng, seconds) if name == "outside_flop" else None


def loudness(rng: Rng, s: Sky, t: Array, period_s: float, kind: str) -> float:
    """Amplitude that the air and the feet alone show at a period: rms over draws of them."""
    step = float(t[1] - t[0])
    draws = [amplitude(t, sky.air(rng, s, len(t), step, kind), period_s) for _ in range(DRAWS)]
    return oracle.rms(np.array(draws))


def scaled(rng: Rng, s: Sky, error: Error, t: Array, order: Order) -> float:
    """Set the error's size to a ratio over the seeing, beyond an offset and a drift, and to what stands out
    of coloured noise at its period; the ratio reached."""
    base, floor = np.column_stack([np.ones(len(t)), t]), s.seeing
    factor = order.ratio / max(oracle.ratio(error.at(t), base, floor), 1e-12)
    if error.periods:
        least = STANDS_OUT * loudness(rng, s, t, error.periods[0], order.noise)
        factor = max(factor, least / error.amplitudes[0])
    error.amplitudes = [a * factor for a in error.amplitudes]
    error.jumps = [(when, a * factor) for when, a in error.jumps]
    error.hidden.raw["size"] = factor
    return oracle.ratio(error.at(t), base, floor)


def seconds_of(order: Order, rng: Rng, period_s: float) -> float:
    """15 min to 3 h; at least three turns of what is hidden, or one and a bit where power shall lack."""
    if order.cell == "short":
        return period_s * float(rng.uniform(1.2, 1.7))
    return max(wide(rng, HOUR_S / 4, 3 * HOUR_S), 3.2 * period_s if order.names else 0.0)


def make_log(order: Order, rng: Rng, _number: int) -> Made:
    """A guide log, mostly without a rig file."""
    mount, period_s = MOUNTS[int(rng.integers(len(MOUNTS)))]
    before_s = period_s * pick(rng, *BEFORE_THE_WORM)
    name = order.names[0] if order.names else ""
    s, g = sky.draw(rng), phd2.draw(rng)
    if name != "before" and rng.random() < 0.25:
        mount = UNKNOWN_MOUNTS[int(rng.integers(len(UNKNOWN_MOUNTS)))]
    seconds = seconds_of(order, rng, before_s if name == "before" else period_s)
    error = hidden_of(rng, name, period_s, before_s, seconds, worms_of(mount))
    reached = scaled(rng, s, error, clock(int(seconds / 2), 2.0), order) if error else 0.0
    lines, begun = ["PHD2 version 2.6.13, Log version 2.5. Log enabled at 2024-03-09 20:14:31", ""], 0.0
    parts = [1.0] if rng.random() < 0.6 or order.cell == "short" else [rng.uniform(0.55, 0.8), 1.0]
    for part, before in zip(parts, [0.0, *parts], strict=False):
        some, t, _ = phd2.section(rng, s, g, mount, error, order.noise, begun, seconds * (part - before))
        lines += some
        begun += float(t[-1]) + rng.uniform(20.0, 90.0)
    rig = None
    if name == "before" or rng.random() < 0.2:
        stages = [f"name: worm, period_s: {period_s:.6g}", f"name: transfer, period_s: {before_s:.6g}"]
        rig = "\n".join(["rig: mount", "format: phd2", "stages:", *(f"  - {{{x}}}" for x in stages), ""])
    drive = {
        "mount": mount,
        "worm_s": period_s,
        "before_s": before_s,
        "seconds": seconds,
        **vars(s),
        **vars(g),
    }
    hidden: Hidden | None = error.hidden if error else None
    return Made({"guide.csv": "\n".join(lines)}, rig, hidden, reached, drive)


def make_table(order: Order, rng: Rng, _number: int) -> Made:
    """A position at constant rate: a rotary table or a mount against an encoder or the sky, in a table."""
    period_s = wide(rng, 20.0, 900.0)
    before_s = period_s * pick(rng, *BEFORE_THE_WORM)
    name = order.names[0] if order.names else ""
    target = before_s if name == "before" else period_s
    least = (1.2, 1.7) if order.cell == "short" else (4.0, 40.0)
    seconds = target * wide(rng, *least)
    step = target / wide(rng, 25.0, 200.0)
    unit, size = [
        ("arcsec", wide(rng, 0.02, 2.0)),
        ("deg", wide(rng, 1e-5, 1e-3)),
        ("um", wide(rng, 0.02, 5.0)),
    ][int(rng.integers(3))]
    s = Sky(step, size, rng.uniform(0.0, 0.6), step * wide(rng, 0.5, 4.0), 0.0, 0.0, 0.0)
    error = hidden_of(rng, name, period_s, before_s, seconds)
    reached = scaled(rng, s, error, clock(int(seconds / step), step), order) if error else 0.0
    files: dict[str, str] = {}
    style = Style(str(rng.choice(["s", "ms", "iso"])), str(rng.choice(["comma", "semicolon", "tab"])))
    last: list[Column] = []
    count, begun = 1 if name == "outside_flop" else int(rng.integers(1, 4)), 0.0
    for k in range(count):
        t = clock(int(seconds / step), step)
        y = sky.air(rng, s, len(t), step, order.noise) + size * rng.uniform(-4, 4) * t / seconds
        y = y + (error.at(begun + t) if error else 0.0) + size * rng.uniform(-50, 50)
        last = [Column("position", "error", unit, y, "%.7g")]
        files[f"run{k + 1}.{style.ending}"] = logfile.write(Log(t, last, begun), style, rng)
        begun += seconds + rng.uniform(0.1, 3.0) * period_s
    stages = [
        f"name: worm, period_s: {period_s:.6g}, harmonics: 4",
        f"name: transfer, period_s: {before_s:.6g}",
    ]
    answer = f"channel: position, unit: {unit}"
    rig = Rig("drive at constant rate", logfile.told(last, style, step, []), answer, (), stages).text()
    drive = {"worm_s": period_s, "before_s": before_s, "seconds": seconds, "files": count, "floor": size}
    return Made(files, rig, error.hidden if error else None, reached, drive)


def open_loop(text: str) -> tuple[Array, Array]:
    """t s and px of a guide log's drive error: raw distance plus earlier corrections, dithers taken out."""
    t, y, sent = [], [], 0.0
    for line in text.splitlines():
        if line.startswith("INFO: DITHER by"):
            sent += float(line.split("by")[1].split(",")[0])
        cells = line.split(",")
        if len(cells) > 10 and cells[2] == '"Mount"':
            t.append(float(cells[1]))
            y.append(float(cells[5]) + sent)
            sent += float(cells[7])
    return np.array(t), np.array(y)


def amplitude(t: Array, y: Array, period_s: float) -> float:
    """Of a sine of that period beside an offset, a drift and a bend; least squares."""
    x = t / t[-1]
    base = np.column_stack(
        [np.ones(len(t)), x, x * x, np.cos(TURN * t / period_s), np.sin(TURN * t / period_s)]
    )
    a, b = np.linalg.lstsq(base, y, rcond=None)[0][3:]
    return math.hypot(float(a), float(b))
