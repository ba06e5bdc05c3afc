"""The grid step against a ten times finer one: rates, angles and torques of manoeuvres agree.

Open-loop manoeuvres, so that quantisation does not decide the path; the figures are documented in
FIDELITY.md.
"""

import numpy as np
import pytest

from plant import model
from plant.grid import TRUTH_COLUMNS
from plant.plant import Plant
from plant.units import ARCSEC
from tests.plant.bench import SECOND

RATE, ANGLE = (TRUTH_COLUMNS.index(c) for c in ("rate", "angle"))


# (start s, duty A, duty B)
HELD = (
    (0, 0.75, 0.075),
    (3, 0.95, 0.095),
    (5, 0.5, 0.12),
    (6.5, 0.12, 0.6),
    (9, 0.1, 0.3),
)  # counter torque on
COASTING = (
    (0, 0.75, 0.075),
    (3, 0.95, 0.0),
    (5, 0.0, 0.0),
    (7, 0.08, 0.8),
    (10, 0.0, 0.2),
)  # teeth part and rattle


def run(name: str, grid_us: float, manoeuvre: tuple[tuple[float, float, float], ...]) -> np.ndarray:
    """Return truth at 10 ms of a manoeuvre of 12 s."""
    plant = Plant(model.with_value(model.load(name), "numerics.grid", grid_us), 1)
    rows: list[np.ndarray] = []
    plant.record(lambda axis, part: rows.append(part) if axis == "ra" else None)
    for start_s, duty_a, duty_b in manoeuvre:
        plant.ra.drive(round(start_s * SECOND) + 65_000, duty_a, duty_b)
    plant.advance(12 * SECOND)
    plant.record(None)
    return np.concatenate(rows)


@pytest.mark.parametrize("name", ["low_preload", "low_preload_bridge"])
@pytest.mark.parametrize(("manoeuvre", "bound"), [(HELD, 5e-5), (COASTING, 5e-3)], ids=["held", "coasting"])
def test_grid_is_converged_against_a_ten_times_finer_one(
    name: str, manoeuvre: tuple[tuple[float, float, float], ...], bound: float
) -> None:
    """Rms error of the rate over its peak. Rattling teeth depend on every impact, so coasting gets a wider
    bound.
    """
    coarse, fine = run(name, 500.0, manoeuvre), run(name, 50.0, manoeuvre)
    top = np.abs(fine[:, RATE]).max()
    assert fine[:, RATE].max() > 3000 * ARCSEC  # the manoeuvre moves, and reverses
    assert fine[:, RATE].min() < -1000 * ARCSEC
    error = np.sqrt(((coarse[:, RATE] - fine[:, RATE]) ** 2).mean()) / top
    assert error < bound
    assert abs(coarse[-1, ANGLE] - fine[-1, ANGLE]) < bound * np.ptp(fine[:, ANGLE])


def test_second_order_on_a_smooth_stretch() -> None:
    """Between two events, halving the step divides the error by about four."""

    def final(grid_us: float) -> float:
        plant = Plant(model.with_value(model.load(), "numerics.grid", grid_us), 1)
        plant.ra.drive(0, 0.9, 0.09)
        plant.advance(4 * SECOND)
        return plant.ra.truth(4 * SECOND)[0]

    reference = final(25.0)
    errors = [abs(final(grid) - reference) for grid in (1000.0, 500.0, 250.0)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[0] / errors[2] > 4.0
