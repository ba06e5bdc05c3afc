"""The telescope's own axes, as their rig files declare them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from calibration.inputs.declaration import Rig
from calibration.inputs.rigfile import load_rig

RIGS = Path(__file__).parent.parent / "rigs"


@cache
def telescope(axis: str) -> Rig:
    """The declared drive of "ra" or "dec"."""
    return load_rig(RIGS / f"schmidt_{axis}.yaml")
