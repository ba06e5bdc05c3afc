"""The fixture `lab` of pytest, for tests of one's own control code.

    @pytest.mark.lab(plant="high_preload", seed=3)
    def test_my_controller(lab): ...

A wheel brings it along; from a checkout: `pytest -p scenarios.lab.fixture`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from scenarios.lab.lab import Lab


def pytest_configure(config: pytest.Config) -> None:
    """Say what the mark is."""
    config.addinivalue_line("markers", "lab(network, plant, seed): which lab the fixture `lab` is")


@pytest.fixture
def lab(request: pytest.FixtureRequest) -> Iterator[Lab]:
    """A fresh `schmidt.Lab`."""
    from scenarios.lab.lab import Lab

    mark = request.node.get_closest_marker("lab")
    with Lab(*mark.args, **mark.kwargs) if mark is not None else Lab() as made:
        yield made
