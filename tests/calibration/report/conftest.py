"""Figures of a test are kept as they are, and closed behind it."""

from collections.abc import Iterator
from typing import Any

import matplotlib.pyplot as plt
import pytest

from calibration.report import plots


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Any]]:
    """Those that were drawn, in order."""
    kept: list[Any] = []

    def keep(fig: Any) -> bytes:
        kept.append(fig)
        return b"figure"

    monkeypatch.setattr(plots, "drawn", keep)
    yield kept
    plt.close("all")
