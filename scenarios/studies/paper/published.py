"""Table 2 and the run-down's inertia as printed."""

TABLE_2 = {
    "low": {"viscous": 6700.0, "coulomb": 229.0, "stiction": 621.0, "stribeck_rate": 4e-4},
    "high": {"viscous": 11300.0, "coulomb": 217.0, "stiction": 1490.0, "stribeck_rate": 7e-4},
}
"""Table 2, about the RA axis: N m s/rad, N m, N m, rad/s."""
INERTIA = 1760.0
"""kg m2: 1.76e6 N mm s2 from the run-down test."""
