"""The kit as its user runs it: pytest in a process of its own, on an emulated wire called `kit`."""

import os
import subprocess
import sys
from pathlib import Path


def run_kit(conftest: str, folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run the checks of a display in `folder`; `conftest` publishes the wire."""
    (folder / "conftest.py").write_text(conftest)
    usual = "-q -p bus.kit -c /dev/null -p no:cacheprovider --can schmidt:kit --board display:0x51"
    return subprocess.run(
        [sys.executable, "-m", "pytest", *usual.split(), "--can-stamps", "0", *options, str(folder)],
        capture_output=True, text=True, check=False, env=os.environ | {"SCHMIDT_PURE": "1"},
    )  # fmt: skip
