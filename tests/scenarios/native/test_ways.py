"""One source, two ways to run it, one digest."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from scenarios.native.build import BuildError, build

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.slow


def ways(pure: str) -> dict[str, Any]:
    done = subprocess.run(
        [sys.executable, "-m", "tests.scenarios.native.ways"],
        cwd=ROOT,
        env={**os.environ, "SCHMIDT_PURE": pure},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert not done.returncode, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.timeout(1500)
def test_plain_and_compiled_give_the_same_digests() -> None:
    try:
        build()
    except BuildError as error:
        pytest.skip(f"nothing to compare with: {error}")
    plain, native = ways("1"), ways("0")
    assert not plain["compiled"]
    assert native["compiled"]
    assert plain["digests"] == native["digests"]
    assert len(set(plain["digests"].values())) == len(plain["digests"])
