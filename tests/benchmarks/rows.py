"""Rows of docs/results/speed.md: `python -m tests.benchmarks.rows`, minutes of a quiet machine."""

import os
import subprocess
import sys

from scenarios.native.build import BuildError, build
from tests.benchmarks import in_c, serving


def main() -> int:
    """Print them as they stand there; 1 if one is missed."""
    plain = os.environ | {"SCHMIDT_PURE": "1"}
    words = [sys.executable, "-m", in_c.__name__]
    done = subprocess.run(words, env=plain, capture_output=True, text=True, check=False)
    name = (
        "the plain night's CPU time over that with both axis boards in C (`python -m tests.benchmarks.in_c`)"
    )
    print(f"| {name} | {done.stdout.strip().partition(' in C ')[2]} | > 1 |")
    try:
        build()
        native = True
    except BuildError as error:
        print(f"only the plain way is measured: {error}", file=sys.stderr)
        native = False
    missed = done.returncode != 0
    for step_ms in (5, 20):  # an interrupt of the boards; a host's loop of fifty turns a second
        found = serving.stepped(30, native, step_ms)
        rates = {way: each["times_real_time"] for way, each in found.items()}
        figures = ", ".join(f"{way} {rate:.0f} ×" for way, rate in rates.items())
        print(
            f"| a host in another process steps by {step_ms} ms: times real time, CPU | {figures} | ≥ 30 × |"
        )
        missed |= min(rates.values()) < 30
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
