"""A current that reads something while none flows."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import VOLTS, Name
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """R times a constant, of either sign."""
    column = np.full((len(s.problem.y), 1), -s.declared["resistance"])
    return [Candidate("adc_offset", "current", column, (("offset", "A"),))]


NAME = Name(
    "adc_offset",
    (VOLTS,),
    columns,
    (),
    "read the current with the bridge switched off",
)
