"""ESPHome's driver for the MCP2515 as it is, from its wheel on PyPI. Nothing of it is kept here."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest


def unpacked(folder: Path, wheel: str, parts: tuple[str, ...]) -> None:
    """Components of a wheel (name, version and hash) below `folder`; skips without a package index."""
    (folder / "wanted.txt").write_text(wheel + "\n")
    words = ["-m", "pip", "download", "-q", "--no-deps", "--require-hashes", "--ignore-requires-python"]
    asked = subprocess.run(
        [sys.executable, *words, "-d", str(folder), "-r", str(folder / "wanted.txt")], capture_output=True
    )
    wheels = list(folder.glob("*.whl"))
    if not wheels:
        pytest.skip(f"the driver's package cannot be had: {asked.stderr.decode().strip()[-200:]}")
    with zipfile.ZipFile(wheels[0]) as package:
        for name in package.namelist():
            if name.startswith(tuple(f"esphome/components/{part}/" for part in parts)):
                package.extract(name, folder)
