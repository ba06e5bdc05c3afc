"""Worm periods of mounts on sale, and what turns before the worm.

Source: PHD2 project's wiki, "Mount Worm Period Info" (periods in seconds, as their owners entered them), and
the gist of the AVX's gears for PEMPro. A wheel of n teeth turns its worm once in 86164.09 s over n.
"""

SIDEREAL_DAY_S = 86164.0905
#: name in PHD2's line `Mount = `, worm's period s
MOUNTS: tuple[tuple[str, float], ...] = (
    ("AstroPhysicsV2", 382.95), ("AstroPhysicsV2", 382.95), ("Celestron AVX (ASCOM)", 598.36),
    ("CGEM (ASCOM)", 478.689), ("Celestron CPC (ASCOM)", 478.689), ("Gemini Telescope .NET", 239.34),
    ("Losmandy GM8", 478.69), ("EQMOD HEQ5/6", 638.25), ("EQMOD HEQ5/6", 478.69),
    ("EQMOD ASCOM HEQ5/6", 478.69), ("iOptron CEM25P", 598.36), ("iOptron CEM40", 398.91),
    ("iOptron CEM70", 347.44), ("iOptron CEM120", 239.35), ("Takahashi EM-400", 478.69),
    ("EQMOD EQ8", 198.08),
)  # fmt: skip
#: parts before the worm of an HEQ5, an AVX: their turns over the worm's
BEFORE_THE_WORM = (9.0 / 47.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 3.0)
UNKNOWN_MOUNTS = ("On-camera", "INDI Mount", "Serial")


def worms_of(mount: str) -> tuple[float, ...]:
    """Periods that a mount's name allows, s; of an unknown one, all."""
    of = {period for name, period in MOUNTS if name == mount or mount in UNKNOWN_MOUNTS}
    return tuple(sorted(of))
