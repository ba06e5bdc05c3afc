"""Two rows of docs/results/speed.md: `python -m tests.benchmarks.rows`, minutes of a quiet machine."""

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
    rates = {way: each["times_real_time"] for way, each in serving.stepped(30, native).items()}
    figures = ", ".join(f"{way} {rate:.0f} ×" for way, rate in rates.items())
    print(f"| a network stepped by a host in another process, times real time by CPU | {figures} | ≥ 30 × |")
    return int(done.returncode != 0 or min(rates.values()) < 30)


if __name__ == "__main__":
    sys.exit(main())
