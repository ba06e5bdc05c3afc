"""Effects of the log itself, and declared numbers that are other ones."""

from __future__ import annotations

import re

import numpy as np

from calibration.corrected.making import Facts, Made, value
from calibration.finding import Finding

#: number of a log column in a plant file, by how findings call it
COLUMNS = {
    "effort": 0,
    "position": 1,
    "velocity": 2,
    "current": 3,
    "adc_a": 3,
    "adc_b": 3,
    "tachometers": 4,
    "tach_a": 4,
    "tach_b": 4,
}
#: finding -> the calibrated numbers of the plant file that say it
CALIBRATED = {
    "coulomb_change": "friction.coulomb",
    "viscous_change": "friction.viscous",
    "stribeck_change": "friction.stiction and friction.stribeck_rate",
    "presliding": "friction.bristle_stiffness",
    "shaft_compliance": "gear.stiffness",
}


def change(f: Finding, facts: Facts) -> Made:
    """A declared number that is another one is that number of the plant file."""
    return Made(remarks=[f"{f.name}: in the plant as axes.{facts.axis}.{CALIBRATED[f.name]}"])


def late(f: Finding, facts: Facts) -> Made:
    """channel_delay: the note says which column."""
    made = Made()
    found = re.match(r"the (.+) column is late", f.note)
    word = found.group(1) if found else ""
    column = COLUMNS.get(word)
    delay = value(f, "delay")
    if column is None:
        made.remarks.append(
            f"channel_delay: left out, the log does not say which column is late ({word or '?'})"
        )
    elif delay < 0.0:
        made.remarks.append(
            f"channel_delay: left out, {word} is {-delay:.4g} s early and a plant is never early"
        )
    else:
        made.add(f.name, facts, {"column": float(column), "delay": delay})
    return made


def lost(f: Finding, facts: Facts) -> Made:
    """sample_loss: whole packets that are missing, or samples that repeat."""
    made = Made()
    key = "repeats" if f.note.startswith("0 rows missing") else "packet_loss"
    made.add(f.name, facts, {key: value(f, "fraction")})
    return made


def wrap(f: Finding, facts: Facts) -> Made:
    """log_wrap: column and length are in the note."""
    made = Made()
    position = re.search(r"position wraps at 2\^(\d+) counts", f.note)
    other = re.search(r"(\w+) (folds|stops) at (-?\d+) counts", f.note)
    if position:
        made.add(f.name, facts, {"column": 1.0, "bits": float(position.group(1)), "mode": 0.0})
    elif other and other.group(1) in COLUMNS:
        column, what, size = other.group(1), other.group(2), int(other.group(3))
        # counts of a fold are its whole length; a signed column stops at half of that, currents are unsigned
        signed = not column.startswith("adc")
        bits = np.log2(abs(size) + (1 if size > 0 and what == "stops" else 0))
        bits += 1.0 if what == "stops" and signed else 0.0
        values = {
            "column": float(COLUMNS[column]),
            "bits": float(round(bits)),
            "mode": float(what == "stops"),
        }
        made.add(f.name, facts, values)
        if abs(bits - round(bits)) > 1e-6:
            made.remarks.append(f"log_wrap: {column} stops at {size}, written as {round(bits)} bits")
    else:
        made.remarks.append("log_wrap: left out, the finding does not say which column wraps where")
    return made
