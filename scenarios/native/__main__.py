"""`python -m scenarios.native`: build the compiled library, or say in one line why not."""

from __future__ import annotations

import sys
import time

from plant import ahead
from scenarios.native.build import BuildError, build, compiler


def main() -> int:
    """Build; with `--strict` a failure is exit 1."""
    start = time.perf_counter()
    try:
        if compiler() and ahead.build():  # without one, the line below says so
            print(f"schmidt: the plant's kernel compiled in {time.perf_counter() - start:.0f} s")
    except ahead.AheadError as error:
        print(f"schmidt: the plant's kernel will be compiled when it is first needed: {error}")
    start = time.perf_counter()
    try:
        if build(say=lambda line: print(f"schmidt: {line}")):
            print(f"schmidt: compiled in {time.perf_counter() - start:.0f} s")
    except BuildError as error:
        print(f"schmidt: not compiled, running plain Python: {error}")
        return 1 if "--strict" in sys.argv else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
