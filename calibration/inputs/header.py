"""The `# key: value` header of an axis log: required keys, the scales it may override, and their errors.

Sources of the declared scales: paper.txt sections 3.2-3.4 (encoders, log period); log-format.md (scales of
the columns). The drive behind the logs is declared in calibration/rigs.
"""

import difflib
from pathlib import Path

from calibration.errors import CalibrationInputError
from calibration.inputs.text import plain
from calibration.inputs.thresholds import LARGEST_SCALE
from plant.gears import RATIO
from plant.units import ARCSEC_PER_TURN

REQUIRED = ("format", "axis", "sample_period_s", "session", "loop", "start_utc")
#: keys with a choice of values, one of them the usual one
ALLOWED = {
    "format": ("axis-log 1",),
    "axis": ("ra", "dec"),
    "loop": ("closed", "open"),
    "preload": ("low", "high"),
}
#: header key -> (declared value, what it is)
SCALES: dict[str, tuple[float, str]] = {
    "sample_period_s": (0.010, "s between rows; log-format.md"),
    "velocity_window_s": (0.005, "s over which `velocity` counts; paper 3.3, 5 ms interrupt"),
    "tach_window_s": (0.010, "s over which `tach_a/b` count; log-format.md"),
    "position_arcsec_per_count": (ARCSEC_PER_TURN / 2**29, "arcsec; 29-bit absolute encoder"),
    "velocity_arcsec_per_count": (ARCSEC_PER_TURN / (4.608e6 * 735 / 30), "arcsec; roller 735:30, 4.608 M"),
    "adc_A_per_count": (0.0061, "A; log-format.md"),
    "tach_counts_per_turn": (4096.0, "counts per motor turn; log-format.md"),
    "aux_arcsec_per_count": (ARCSEC_PER_TURN / (2**17 * 10.8), "arcsec; 17 bit through 10.8:1"),
    "effort_full_scale": (3000.0, "effort counts at full supply; log-format.md"),
    "supply_V": (24.0, "V; paper 3.2"),
    "counter_torque": (0.10, "fraction of the effort on the other motor; paper 3.3 says 0.10 to 0.25"),
    "gear_ratio": (RATIO, "motor turns per axis turn; paper 3.2"),
}
#: header key of a declared number that Table 1 gives in a way that can be read twice, and what it is
TRAIN_STIFFNESS = "train_stiffness_Nm_per_rad"
WHAT = {
    TRAIN_STIFFNESS: "N m/rad at the axis of one motor's gear train",
    **{k: w for k, (_, w) in SCALES.items()},
}


def parse_header(path: Path, lines: list[str]) -> tuple[dict[str, str], dict[str, float], int]:
    """The header, its scales, and the index of the first line behind it; errors name the line."""
    header: dict[str, str] = {}
    at: dict[str, int] = {}
    end = next((k for k, text in enumerate(lines) if not text.startswith("#")), len(lines))
    for line, text in enumerate(lines[:end], 1):
        key, colon, value = (part.strip() for part in text[1:].partition(":"))
        if not colon:
            continue
        if key in ("axis", "format") and header.get(key, value) != value:
            what = f"'{key}' is given twice ('{header[key]}', '{value}'): one file holds one axis"
            raise CalibrationInputError(path, what, line)
        header[key], at[key] = value, line
    for key in REQUIRED:
        if key not in header:
            near = difflib.get_close_matches(key, header, n=1)
            hint = f"did you mean '{near[0]}' (line {at[near[0]]})?" if near else f"add '# {key}: ...'"
            raise CalibrationInputError(path, f"the header lacks '{key}'; {hint}", 1)
    for key, allowed in ALLOWED.items():
        if header.get(key, allowed[0]) not in allowed:
            what = f"'{key}' is '{header[key]}', must be {' or '.join(allowed)}"
            raise CalibrationInputError(path, what, at[key])
    said = {key: _number(path, key, header[key], at[key]) for key in WHAT if key in header}
    return header, {key: said.get(key, value) for key, (value, _) in SCALES.items()}, end


def _number(path: Path, key: str, text: str, line: int) -> float:
    """The header's value of a scale; one that is no positive number is an error."""
    value = plain(text)
    if value is None:
        what = f"'{key}' is '{text}', must be a plain number ({WHAT[key]})"
        raise CalibrationInputError(path, what, line)
    share = key == "counter_torque"
    if not (value > 0 or (share and value == 0)) or value > (1.0 if share else LARGEST_SCALE):
        must = "0 to 1" if share else "positive"
        raise CalibrationInputError(path, f"'{key}' is {value}, must be {must} ({WHAT[key]})", line)
    return value
