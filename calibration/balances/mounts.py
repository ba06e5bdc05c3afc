"""Periodic parts of mounts that guide logs name: worms by their wheels, transfer gears before the worms."""

import re
from dataclasses import dataclass

from calibration.inputs.declaration import Rig
from calibration.inputs.run import Run
from calibration.inputs.train import SHAFT

ENCODER = "encoder_eccentricity"  # its stage's kind: what the drive follows runs out of true, no gear

SIDEREAL_DAY_S = 86164.0905  # s, by definition of the sidereal day


@dataclass(frozen=True)
class Part:
    """One periodic part: what it is called, turns per second while tracking, whether it is a worm, and the
    effect by which it shows."""

    name: str
    rate: float
    worm: bool = True
    effect: str = SHAFT


#: mount name in the log -> teeth of its RA worm wheel (makers' data sheets; the periods listed in the PHD2
#: project's wiki, "Mount Worm Period Info", are the sidereal day over these)
MOUNTS = (
    (r"astro.?physics|\bAP ?(900|1100|1200|1600)|GTO", (225,)),
    (r"HEQ5|Sirius|SkyScan.*HEQ", (135, 180)),
    (r"Celestron.*AVX/", (180, 144)),  # one driver for the whole family
    (r"EQ6|AZ-?EQ|Atlas|CGEM|CPC|LX200|EM-?200|EM-?400", (180,)),
    (r"EQ8", (435,)),
    (r"GM-?8", (180,)),
    (r"G11|Gemini|Losmandy", (360,)),
    (r"CEM60|CEM40", (216,)),
    (r"CEM70", (248,)),  # owners' logs: 348 s
    (r"CEM120", (360,)),
    (r"\bAVX|Advanced VX|CEM25", (144,)),
    (r"iEQ45", (256,)),
    (r"CGX|CGE", (180,)),
    (r"Paramount|MYT|TheSkyX|TheSky", (576, 375, 320)),
)
#: mount name in the log -> (wheel, driven, driving teeth of the transfer gear before the worm). The HEQ5 has
#: 47:9, the EQ6 47:12 (owners' manuals of the belt conversions that replace them); with wheels of 135 and 180
#: teeth both drive gears turn once in 122.2 s.
TRANSFERS = ((r"EQ6|HEQ5|Sirius|Atlas", ((180, 47, 12), (135, 47, 9))),)
# teeth of further wheels of mounts in use (makers' datasheets): count
FURTHER = (130, 192, 288, 359)
#: tried when no mount is named
COMMON = tuple(sorted({*FURTHER, *(n for _, teeth in MOUNTS for n in teeth)}))


def _name(runs: list[Run]) -> str:
    return " ".join(r.header.get("mount", "") for r in runs)


def known_mount(runs: list[Run]) -> tuple[int, ...]:
    """Teeth that go with the mount's name in the log; empty when the name is not known."""
    name = _name(runs)
    return next((teeth for pattern, teeth in MOUNTS if re.search(pattern, name, re.IGNORECASE)), ())


def parts(runs: list[Run], rig: Rig | None) -> list[Part]:
    """Every periodic part that is known: from the rig, the mount's name, else usual wheels."""
    if rig is not None and rig.stages:
        return [
            Part(s.name, 1.0 / s.period_s, effect=s.kind if s.kind == ENCODER else SHAFT)
            for s in rig.stages
            if s.period_s
        ]
    wheels = known_mount(runs) or COMMON
    found = [Part(f"worm of a {n}-tooth wheel", n / SIDEREAL_DAY_S) for n in wheels]
    name = _name(runs)
    for pattern, gears in TRANSFERS:
        if re.search(pattern, name, re.IGNORECASE):
            rates = {round(n * up / down / SIDEREAL_DAY_S, 9) for n, up, down in gears if n in wheels}
            found += [Part(f"transfer gear of {1 / rate:.1f} s", rate, worm=False) for rate in sorted(rates)]
    return found
