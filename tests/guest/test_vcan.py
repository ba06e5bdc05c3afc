"""`schmidt serve` on a real SocketCAN interface, in a guest kernel that has one."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PROJECT = HERE.parent.parent
SPEEDS = ("0.08", "0.03")
"""The guest's processor is emulated, about fifteen times slower, and may be busy: the second is for that."""

pytestmark = [pytest.mark.guest, pytest.mark.slow, pytest.mark.timeout(1800)]


def missing() -> str | None:
    if not shutil.which("qemu-system-x86_64") or not shutil.which("candump"):
        return "needs qemu-system-x86, linux-image-amd64, busybox-static, can-utils, kmod, cpio, iproute2"
    if os.geteuid() != 0:
        return "needs root to share the machine's files with the guest"
    if not (PROJECT / ".venv/bin/schmidt").exists():
        return "needs the virtual environment that make builds"
    return None


@pytest.mark.skipif(missing() is not None, reason=missing() or "")
def test_L1_conformance_over_socketcan_in_a_guest_kernel() -> None:
    # One cache for both machines, for a processor both have: compiling inside would take minutes.
    shared = {"NUMBA_CPU_NAME": "generic", "SCHMIDT_CACHE_DIR": str(PROJECT / ".cache" / "guest")}
    warm = [PROJECT / ".venv/bin/schmidt", "serve", "--can", "virtual:warm", "--duration", "1"]
    subprocess.run(warm, env=os.environ | shared, check=True, capture_output=True, timeout=300)
    settings = [f"{key}={value}" for key, value in shared.items()]
    inside = ["env", *settings, str(HERE / "serve_and_check.sh"), *SPEEDS]
    result = subprocess.run(
        [str(HERE / "boot.sh"), *inside], cwd=PROJECT, capture_output=True, text=True, timeout=1700
    )
    assert result.returncode == 0, result.stdout[-6000:] + result.stderr[-2000:]
    assert "vcan0  221   [8]" in result.stdout, "candump saw no position frame"
    assert " 0 of what must hold failed" in result.stdout


@pytest.mark.skipif(missing() is not None, reason=missing() or "")
def test_programs_of_others_attach_to_vcan_and_hidraw_in_a_guest_kernel() -> None:
    shared = {"NUMBA_CPU_NAME": "generic", "SCHMIDT_CACHE_DIR": str(PROJECT / ".cache" / "guest")}
    warm = [PROJECT / ".venv/bin/schmidt", "serve", "--can", "virtual:warm", "--duration", "1"]
    subprocess.run(warm, env=os.environ | shared, check=True, capture_output=True, timeout=300)
    inside = ["env", *(f"{key}={value}" for key, value in shared.items())]
    result = subprocess.run(
        [str(HERE / "boot.sh"), *inside, str(HERE / "serve_and_attach.sh"), SPEEDS[0]],
        cwd=PROJECT,
        capture_output=True,
        text=True,
        timeout=1700,
    )
    assert result.returncode == 0, result.stdout[-6000:] + result.stderr[-2000:]
    assert "all checks passed" in result.stdout
