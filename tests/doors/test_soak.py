"""A random client at a served network: what was acknowledged was done, and the logs have no gap."""

from pathlib import Path

import pytest

from tests.doors.soak import growth, soak


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_minute_with_a_random_client(tmp_path: Path) -> None:
    made, text = soak(tmp_path, 0.7, 20, seed=2)
    print(text)
    assert made.lost == []
    assert made.asked > 50 and made.slews > 0


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_half_an_hour_with_a_random_client(tmp_path: Path) -> None:
    made, text = soak(tmp_path, 30, 50)
    print(text)
    assert made.lost == []
    assert growth(made.memory) < 0.05
