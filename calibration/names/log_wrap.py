"""A counter that wraps before its declared length, or a column that stops at an end."""

from dataclasses import replace

import numpy as np

from calibration.finding import UNKNOWN, Parameter, of_columns
from calibration.inputs.axislog import COLUMNS as LOGGED
from calibration.inputs.run import Run
from calibration.inputs.stuck import piled_at
from calibration.names.channel_delay import COLUMNS
from calibration.names.name import Array, Beside, Facts, Finding, Made, Name, as_found
from calibration.statistics.tails import share_log10
from plant.units import ARCSEC

#: what a column that folds looks like: between sensors; in torque, volts or command; in any of them
OF_SENSORS = ("encoder_eccentricity", "roller_ratio", "roller_slip", "channel_delay", "sample_loss")
OF_FORCES = ("adc_gain", "magnet_weakening", "supply_sag", "command_disturbance", "friction_asymmetry")
OF_SHAPES = ("structural_mode", "damaged_tooth", UNKNOWN)
WHOLE_BITS = 1e-6  # off a whole number of bits, share of one, from where on it is said. ASSUMPTION
EXACT_BITS = 1e-9  # part of a bit, for a column of whole counts: rounding. arithmetic
OFF_POWER = 0.05  # part of a wrap's size, that a jump may be off it: the motion of a row. ASSUMPTION
FEWEST_STEPS = 10  # rows from which a motion is told. ASSUMPTION
FEWEST_ROWS = 100  # rows of a column, before its folds and ends are looked at. ASSUMPTION
CLEAR_COUNTS = 10  # counts beyond which a column's scale is told. ASSUMPTION
ADC_END = 1023  # counts at which the currents' converter ends. definition: 10 bits (log-format.md)
# -log10 p of one jump that is a power of two within a tenth (a fold) or a twentieth either way. arithmetic
WHOLE = 1.0


def repair_wraps(run: Run) -> Finding | None:
    """Undo, in place, a counter that wraps before its declared length, or a column that stops at an end."""
    position = run.columns["position"]
    per_count = run.scales["position_arcsec_per_count"] * ARCSEC
    counts = position / per_count
    step = np.diff(counts)
    good = np.isfinite(step)
    if good.sum() < FEWEST_STEPS:
        return None
    usual = float(np.median(np.abs(step[good]))) + 1
    waited = np.diff(run.columns["t"])
    near = np.nan_to_num(run.columns.get("velocity", np.zeros(len(counts)))[1:]) * waited / per_count
    jump, late = np.where(good, step - near, 0.0), waited > 1.5 * run.scales["sample_period_s"]
    big = (np.abs(jump) > max(200 * usual, 1e5)) & ~late
    if big.any():
        sizes = np.abs(jump[big])
        power = round(float(np.log2(np.median(sizes))))
        if np.all(np.abs(sizes / 2.0**power - np.round(sizes / 2.0**power)) < OFF_POWER):
            fix = np.cumsum(np.where(big, np.round(jump / 2.0**power) * 2.0**power, 0.0))
            run.columns["position"] = (counts - np.concatenate([[0.0], fix])) * per_count
            run.notes.append(f"position wraps at 2^{power} counts")
            note = f"{run.name}: position wraps at 2^{power} counts, {int(big.sum())} times"
            return of_columns(NAME.name, _in_plant("position", power), float(big.sum()) * WHOLE, note=note)
    return _other_wraps(run)


def _other_wraps(run: Run) -> Finding | None:
    """Other columns that fold, by a step of a power of two against the motion, or stop."""
    for name in ("velocity", "adc_a", "adc_b", "tach_a", "tach_b"):
        raw, unsigned = run.raw.get(name, np.zeros(0)), name.startswith("adc")
        x = raw[np.isfinite(raw)]
        if len(x) < FEWEST_ROWS:
            continue
        size, times = _folds(x, 10 if unsigned else 17)
        if size:
            _unfold(run, name, size)
            told, note = _in_plant(name, round(np.log2(size))), f"{run.name}: {name} folds at {size} counts"
            return of_columns(NAME.name, told, WHOLE * times, note=note)
        end, sure = _stops(x, name, run.raw["effort"][np.isfinite(raw)])
        if end:
            # a signed column stops at half of its whole length, currents are unsigned
            told = _in_plant(name, np.log2(abs(end) + (end > 0)) + (not unsigned), stops=True)
            at_end = (raw == x.max()) | ((raw == x.min()) & (not unsigned))
            column = LOGGED[name].called or name
            run.columns[column] = np.where(at_end, np.nan, run.columns[column])
            return of_columns(NAME.name, told, sure, note=f"{run.name}: {name} stops at {end} counts")
    return None


def _unfold(run: Run, name: str, size: int) -> None:
    """Add turns of `size` counts until the column follows the encoder's own rate."""
    column = LOGGED[name].called or name
    raw, si = run.raw[name], run.columns[column]
    big = np.abs(raw) > CLEAR_COUNTS
    scale = float(np.nanmedian(si[big] / raw[big])) if big.any() else 0.0
    if name.startswith("adc"):
        run.columns[column] = np.full(len(si), np.nan)
    elif scale > 0:
        rate = np.gradient(run.columns["position"], run.columns["t"])
        expected = rate * (run.scales["gear_ratio"] if name.startswith("tach") else 1.0)
        run.columns[column] = si + np.round((expected - si) / (size * scale)) * size * scale


def _folds(x: Array, length: int) -> tuple[int, float]:
    """The power of two (counts; 0: none) that x steps by within a tenth, and how often."""
    step = np.abs(np.diff(x))
    typical = float(np.quantile(step, 0.99)) + 1
    for power in range(7, length):
        size = 2.0**power
        at = np.abs(step - size) < 0.1 * size
        if size > 8 * typical and at.sum() >= 2 and np.ptp(x) <= 1.05 * size:
            return int(size), float(at.sum())
    return 0, 0.0


def _stops(x: Array, name: str, effort: Array) -> tuple[int, float]:
    """A column that piles up at one end: noise would spread it over the neighbouring counts. Which end
    (counts; 0: none), and -log10 p that the end and its neighbour were equally likely."""
    if name.startswith("tach"):
        return 0, 0.0  # a count or two at constant speed pile up by themselves
    for end, inward in ((x.max(), -1.0), (x.min(), 1.0)):
        if end == 0 or (name.startswith("adc") and (end >= ADC_END or inward > 0)):
            continue  # a motor that pulls one way only has a lowest current
        power = np.log2(abs(end) + (1 if end > 0 else 0))
        if name == "velocity" and abs(power - round(power)) > EXACT_BITS:
            continue  # a constant speed piles up too: only an end of a power of two is a stop
        at = piled_at(x, effort, float(end), float(end + inward))
        if at is not None:
            return int(end), share_log10(at[0], sum(at), 0.5)
    return 0, 0.0


def _in_plant(column: str, bits: float, stops: bool = False) -> dict[str, Parameter]:
    found = {"column": float(COLUMNS[column]), "bits": float(bits), "mode": float(stops)}
    return {name: Parameter(x, "1") for name, x in found.items()}


def to_plant(f: Finding, facts: Facts) -> Made:
    """A plant's counters have whole bits."""
    if "column" not in f.parameters:
        return Made(remarks=[f"{f.name}: left out, the finding does not say which column wraps where"])
    bits = f.parameters["bits"].value
    whole = {**f.parameters, "bits": Parameter(float(round(bits)), "1")}
    made = as_found(replace(f, parameters=whole), facts)
    if abs(bits - round(bits)) > WHOLE_BITS:
        made.remarks.append(f"{f.name}: {f.note}, written as {round(bits)} bits")
    return made


NAME = Name(
    to_plant=to_plant,
    name="log_wrap",
    experiment="read the counter at its full length",
    repairs=("wrap", "signed", "saturation"),
    beside=Beside(consequences={"S": (*OF_SENSORS, *OF_FORCES, *OF_SHAPES)}),
)
