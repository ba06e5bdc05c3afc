"""Ten browsers at once: all are served, no board suffers; how many ticks were late is printed."""

from pathlib import Path

import pytest

from tests.host.console.conftest import CHROMIUM
from tests.host.console.crowd import crowd, late

needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")


def test_late_ticks_are_counted_between_two_looks() -> None:
    before = {"ticks": 100, "on_time": 0.9}
    assert late(before, {"ticks": 300, "on_time": 0.95}) == (200, 5)
    assert late({"ticks": 0, "on_time": None}, {"ticks": 10, "on_time": 1.0}) == (10, 0)


@pytest.mark.slow
@needs_chromium
@pytest.mark.timeout(300)
def test_three_browsers_for_a_moment(tmp_path: Path) -> None:
    print(crowd(tmp_path, 3, 2.0))


@pytest.mark.long
@needs_chromium
@pytest.mark.timeout(900)
def test_ten_browsers_for_a_minute(tmp_path: Path) -> None:
    print(crowd(tmp_path, 10, 60.0))
