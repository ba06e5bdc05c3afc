"""E7: torque-velocity map and Table 2."""

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.frictionmap import friction_map
from scenarios.studies.paper.experiments.noise import Noise
from scenarios.studies.paper.published import TABLE_2
from scenarios.studies.paper.starts import Benches

REGION = (0.25, 3.0)
"""Of vs: where the Stribeck effect does most of its falling."""


def measure(benches: Benches) -> Figures:
    """Deviations of the fitted four from Table 2, percent, and how many points lie in the Stribeck region."""
    found: Figures = {}
    region = []
    noise = Noise(benches.start.seed, f"e7.{benches.start.angle_deg}")
    for preload, table in TABLE_2.items():
        friction = benches.plants[preload].axes.ra.friction
        unit = friction.coulomb.value / friction.coulomb.si  # N m to the unit in which Table 2 is read
        found_map = friction_map(benches, preload, noise)
        low, high = (share * table["stribeck_rate"] for share in REGION)
        region.append(sum(low <= point.rate <= high for point in found_map.points))
        if found_map.fit is None:
            continue
        for name, printed in table.items():
            scale = unit if name in ("coulomb", "stiction") else 1.0
            value = float(getattr(found_map.fit, name)) * scale
            found[f"{preload} {name}"] = (value / printed - 1.0) * 100.0
        found[f"{preload} exponent"] = found_map.fit.exponent
    found["region"] = float(min(region))
    return found


ROW = row("E7", measure)
