"""What the stamps and the counters themselves say (channel S): jitter, lost packets, repeated samples,
wraps."""

from __future__ import annotations

import numpy as np

from calibration.channels.frame import Frame
from calibration.finding import Finding, Parameter
from calibration.inputs.ends import piled_at
from calibration.readers.run import Array, Run
from calibration.statistics.tails import share_log10, variance_log10
from calibration.statistics.whitening import Mask

JITTER_S = 4e-5  # rms of the stamps about a straight line; an interrupt's own latency is a few microseconds
MOVING = 4e-8  # rad per row, 0.8 arcsec/s
QUICK = 4e-7  # rad per row: fast enough that a single row without motion is no chance
LOST = 0.003  # fraction of rows missing that is worth a word
RENAMED = {"adc_a": "current_a", "adc_b": "current_b", "tach_a": "motor_a", "tach_b": "motor_b"}
WHOLE = 1.0  # -log10 p of one jump that is a power of two within a tenth (a fold) or a twentieth either way
PACKET = 25  # rows per RS232 packet, log-format.md


def clock_findings(frame: Frame) -> list[Finding]:
    """Findings on stamps, gaps and repeats."""
    return [x for x in (_jitter(frame), _loss(frame)) if x is not None]


def _jitter(frame: Frame) -> Finding | None:
    left = []
    for k in range(len(frame.runs)):
        rows = (frame.run == k) & frame.present
        t, c = frame.t[rows], frame.clock[rows]
        if len(t) > 50:
            left.append(c - np.polyval(np.polyfit(t - t[0], c, 2), t - t[0]))
    if not left:
        return None
    e = np.concatenate(left)
    sigma = float(np.std(e))
    if sigma < JITTER_S:
        return None
    n = len(e)
    half = 1.96 * sigma / np.sqrt(2 * n)
    return Finding(
        "clock_jitter",
        "S",
        "clock",
        parameters={"sigma": Parameter(sigma, "s", sigma - half, sigma + half)},
        evidence=variance_log10((sigma / JITTER_S) ** 2, n),
        share=1.0 - (JITTER_S / sigma) ** 2,
    )


def _loss(frame: Frame) -> Finding | None:
    gaps = [g for v in frame.missing.values() for _, g in v]
    lost = sum(gaps)
    rows = int(frame.present.sum())
    again = _repeated(frame)
    repeats = int(again.sum())
    if repeats / max(rows, 1) >= LOST:
        for column in frame.columns.values():
            column[again] = np.nan  # a repeated row is a missing one with a wrong stamp
    fraction = lost / (lost + rows)
    if fraction < LOST and repeats / max(rows, 1) < LOST:
        return None
    whole = np.mean([g % PACKET == 0 for g in gaps]) if gaps else 0.0
    value = max(fraction, repeats / max(rows, 1))
    packets = (rows + lost) / PACKET
    half = 1.96 * np.sqrt(value * (1 - value) / max(packets, 1.0))
    gone = f"{lost} rows missing in {len(gaps)} gaps ({100 * whole:.0f} % of whole packets)"
    note = f"{gone}, {repeats} rows repeated"
    return Finding(
        "sample_loss",
        "S",
        "clock",
        evidence=share_log10(value * packets, packets, LOST),
        share=1.0,
        note=note,
        parameters={"fraction": Parameter(value, "1", max(value - half, 0.0), value + half)},
    )


def _repeated(frame: Frame) -> Mask:
    """Rows (n,) of packets that repeat the packet before them, or frozen rows while moving."""
    p = frame.columns["position"]
    shifted = np.zeros(len(p), dtype=bool)
    shifted[PACKET:] = (p[PACKET:] == p[:-PACKET]) & np.isfinite(p[PACKET:])
    for name in ("velocity", "effort", "current_a", "current_b"):
        c = frame.get(name)
        if c is not None:
            shifted[PACKET:] &= c[PACKET:] == c[:-PACKET]
    moving = np.abs(np.gradient(np.nan_to_num(p))) > MOVING
    still = np.zeros(len(p), dtype=bool)
    still[1:] = p[1:] == p[:-1]
    for name in ("velocity", "effort", "current_a"):
        c = frame.get(name)
        if c is not None:
            still[1:] &= c[1:] == c[:-1]
    near = np.convolve(moving, np.ones(61), "same") > 20
    both = (shifted | still) & near
    edges = np.flatnonzero(np.diff(both.astype(int), prepend=0, append=0))
    for start, end in edges.reshape(-1, 2):
        both[start:end] = _goes_on(p, int(start), int(end - start))
    return both


def _goes_on(p: Array, at: int, rows: int) -> bool:
    """Whether the row after `rows` unchanged ones from `at` on has moved as if the axis had never stopped:
    an axis that comes to rest shows the same row again and again, too."""
    before, after = p[max(at - 1, 0)], p[min(at + rows, len(p) - 1)]
    usual = np.nanmedian(np.abs(np.diff(p[max(at - 12, 0) : at + 1]))) if at > 1 else 0.0
    return bool(abs(after - before) > 0.3 * (rows + 1) * usual and usual > (MOVING if rows >= 5 else QUICK))


def repair_wraps(run: Run) -> Finding | None:
    """Find and undo a counter that wraps before its declared length, or a column that stops at an end; in
    place."""
    position = run.columns["position"]
    per_count = run.scales["position_arcsec_per_count"] * np.pi / 648000
    counts = position / per_count
    step = np.diff(counts)
    good = np.isfinite(step)
    if good.sum() < 10:
        return None
    usual = float(np.median(np.abs(step[good]))) + 1
    near = np.zeros(len(step))
    speed = run.columns.get("velocity")
    if speed is not None:
        near = np.nan_to_num(speed[1:]) * np.diff(run.columns["t"]) / per_count
    jump = np.where(good, step - near, 0.0)
    late = np.diff(run.columns["t"]) > 1.5 * run.scales["sample_period_s"]
    big = (np.abs(jump) > max(200 * usual, 1e5)) & ~late
    if big.any():
        sizes = np.abs(jump[big])
        power = round(float(np.log2(np.median(sizes))))
        if np.all(np.abs(sizes / 2.0**power - np.round(sizes / 2.0**power)) < 0.05):
            fix = np.concatenate(
                [[0.0], np.cumsum(np.where(big, -np.round(jump / 2.0**power) * 2.0**power, 0.0))]
            )
            run.columns["position"] = (counts + fix) * per_count
            run.notes.append(f"position wraps at 2^{power} counts")
            return Finding(
                "log_wrap",
                "S",
                "clock",
                evidence=float(big.sum()) * WHOLE,
                share=1.0,
                note=f"{run.name}: position wraps at 2^{power} counts, {int(big.sum())} times",
            )
    return _other_wraps(run)


def _other_wraps(run: Run) -> Finding | None:
    """Velocity, current or tachometer columns that fold or stop: a step of a power of two against the
    motion."""
    for name in ("velocity", "adc_a", "adc_b", "tach_a", "tach_b"):
        raw = run.raw.get(name)
        if raw is None:
            continue
        x = raw[np.isfinite(raw)]
        if len(x) < 100:
            continue
        size = _folds(x, 10 if name.startswith("adc") else 17)
        if size:
            _unfold(run, name, size)
            found, sure = f"folds at {size} counts", WHOLE * _steps(x, size)
        else:
            found, sure = _stops(x, name, run.raw["effort"][np.isfinite(raw)])
            if found:
                run.columns[RENAMED.get(name, name)] = (
                    np.where(
                        raw == x.max(),
                        np.nan,
                        np.where(raw == x.min(), np.nan, run.columns[RENAMED.get(name, name)]),
                    )
                    if not name.startswith("adc")
                    else np.where(raw == x.max(), np.nan, run.columns[RENAMED.get(name, name)])
                )
        if found:
            return Finding(
                "log_wrap", "S", "clock", evidence=sure, share=1.0, note=f"{run.name}: {name} {found}"
            )
    return None


def _unfold(run: Run, name: str, size: int) -> None:
    """Add turns of `size` counts until the column follows the encoder's own rate."""
    column = RENAMED.get(name, name)
    raw, si = run.raw[name], run.columns[column]
    big = np.abs(raw) > 10
    scale = float(np.nanmedian(si[big] / raw[big])) if big.any() else 0.0
    if scale <= 0 or name.startswith("adc"):
        run.columns[column] = np.full(len(si), np.nan) if name.startswith("adc") else si
        return
    rate = np.gradient(run.columns["position"], run.columns["t"])
    expected = rate * (run.scales["gear_ratio"] if name.startswith("tach") else 1.0)
    run.columns[column] = si + np.round((expected - si) / (size * scale)) * size * scale


def _steps(x: Array, size: float) -> float:
    """How often x steps by `size` within a tenth."""
    return float(np.sum(np.abs(np.abs(np.diff(x)) - size) < 0.1 * size))


def _folds(x: Array, length: int) -> int:
    step = np.abs(np.diff(x))
    typical = float(np.quantile(step, 0.99)) + 1
    for power in range(7, length):
        size = 2.0**power
        at = np.abs(step - size) < 0.1 * size
        if size > 8 * typical and at.sum() >= 2 and np.ptp(x) <= 1.05 * size:
            return int(size)
    return 0


def _stops(x: Array, name: str, effort: Array) -> tuple[str, float]:
    """A column that piles up at one end: noise would spread it over the neighbouring counts. What it does,
    and -log10 p that the end and its neighbour were equally likely."""
    if name.startswith("tach"):
        return "", 0.0  # a count or two at constant speed pile up by themselves
    for end, inward in ((x.max(), -1.0), (x.min(), 1.0)):
        if end == 0 or (name.startswith("adc") and (end >= 1023 or inward > 0)):
            continue  # a motor that pulls one way only has a lowest current
        power = np.log2(abs(end) + (1 if end > 0 else 0))
        if name == "velocity" and abs(power - round(power)) > 1e-9:
            continue  # a constant speed piles up too: only an end of a power of two is a stop
        at = piled_at(x, effort, float(end), float(end + inward))
        if at is not None:
            return f"stops at {int(end)} counts", share_log10(at[0], sum(at), 0.5)
    return "", 0.0
