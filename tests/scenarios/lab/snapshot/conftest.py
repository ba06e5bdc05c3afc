"""Snapshots are of the plain source: compiled instances cannot be taken apart."""

from pathlib import Path

import pytest

from scenarios.native import compiled


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if compiled() and item.path.is_relative_to(Path(__file__).parent):
            item.add_marker(pytest.mark.skip(reason="snapshots are taken of the plain source"))
