"""The gear table against the paper and the published table of orders (effects.md)."""

import pytest

from plant.gears import ORDERS, RATIO


def test_P2_reduction_is_the_published_360_489() -> None:
    assert round(RATIO, 3) == 360.489


@pytest.mark.parametrize(
    ("stage", "order"),
    [
        ("axis", 1), ("aux", 10.8), ("shaft2", 14.7059), ("roller", 24.5), ("shaft1", 86.1345),
        ("mesh3", 250), ("motor", 360.4886), ("mesh2", 1808.82), ("mesh1", 9733.19),
    ],
)  # fmt: skip
def test_orders_are_those_of_the_table(stage: str, order: float) -> None:
    assert ORDERS[stage] == pytest.approx(order, rel=5e-6)
