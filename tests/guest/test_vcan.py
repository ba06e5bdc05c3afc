"""`schmidt serve` on a real SocketCAN interface and a real /dev/hidrawN, in a guest kernel that has them.

Each test boots its own guest. One that hangs is ended by boot.sh (GUEST_TIMEOUT), and its console is shown.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PROJECT = HERE.parent.parent
SPEEDS = ("0.08", "0.03")
"""The guest's processor is emulated, about fifteen times slower, and may be busy: the second is for that."""
ATTACH_SPEED = "0.05"
"""No period is checked here: the guest holds this on an idle machine, and may miss it on a busy one."""
CONFORMANCE_S, ATTACH_S = 450, 330
"""A guest is ended after so many seconds: with the limit below, both tests end within fifteen minutes."""
SHARED = {"NUMBA_CPU_NAME": "generic", "SCHMIDT_CACHE_DIR": str(PROJECT / ".cache" / "guest")}
"""One cache for both machines, for a processor both have: compiling inside would take minutes."""


def missing() -> str | None:
    if not shutil.which("qemu-system-x86_64") or not shutil.which("candump"):
        return "needs qemu-system-x86, linux-image-amd64, busybox-static, can-utils, kmod, cpio, iproute2"
    if os.geteuid() != 0:
        return "needs root to share the machine's files with the guest"
    if not (PROJECT / ".venv/bin/schmidt").exists():
        return "needs the virtual environment that make builds"
    return None


pytestmark = [
    pytest.mark.guest,
    pytest.mark.slow,
    pytest.mark.timeout(510),
    pytest.mark.skipif(missing() is not None, reason=missing() or ""),
]


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    warm = [PROJECT / ".venv/bin/schmidt", "serve", "--can", "virtual:warm", "--duration", "1"]
    subprocess.run(warm, env=os.environ | SHARED, check=True, capture_output=True, timeout=300)


def console_of(script: str, *speeds: str, limit_s: int) -> str:
    """What a guest that ran the script printed. Fails when its status is not 0, or when it took too long."""
    inside = ["env", *(f"{key}={value}" for key, value in SHARED.items()), str(HERE / script), *speeds]
    result = subprocess.run(
        [str(HERE / "boot.sh"), *inside],
        cwd=PROJECT,
        env=os.environ | {"GUEST_TIMEOUT": str(limit_s)},
        capture_output=True,
        text=True,
        errors="replace",
        timeout=limit_s + 60,
    )
    assert result.returncode == 0, result.stdout[-6000:] + result.stderr[-2000:]
    return result.stdout


def test_L1_conformance_over_socketcan_in_a_guest_kernel() -> None:
    console = console_of("serve_and_check.sh", *SPEEDS, limit_s=CONFORMANCE_S)
    assert "vcan0  221   [8]" in console, "candump saw no position frame"
    assert " 0 errors" in console


def test_programs_of_others_attach_to_vcan_and_hidraw_in_a_guest_kernel() -> None:
    console = console_of("serve_and_attach.sh", ATTACH_SPEED, limit_s=ATTACH_S)
    assert "attach: all checks passed" in console
