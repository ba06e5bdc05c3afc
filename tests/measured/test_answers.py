"""Every measured log gets the right names or the right class. Skipped where the data folder is absent."""

from pathlib import Path

import pytest

from tests.measured.__main__ import answer
from tests.measured.cases import CASES, DATA
from tests.measured.truth import RIGHT

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data/measured is absent: no measured data"),
]


@pytest.mark.parametrize("key", [c.key for c in CASES])
def test_a_measured_log_is_answered_right(tmp_path: Path, key: str) -> None:
    found = answer(key, tmp_path)
    assert found.judged == RIGHT, f"{found.said}: {found.why}"
