"""`python -m scenarios.native`: build the compiled library, or say in one line why not."""

import sys
import time

from plant import builder
from scenarios.native.build import BuildError, build, compiler
from scenarios.progress import stages

USUAL_S = {
    "the plant's kernel": 8.0,
    "translating to C": 20.0,
    "compiling": 90.0,
    "holding it against Python": 8.0,
}
"""CPU seconds. Source: measured on one core of a server, gcc; the pace at hand is measured."""


def main() -> int:
    """Build; with `--strict` a failure is exit 1."""
    start = time.perf_counter()
    try:
        with stages("compiling once, runs are then faster", USUAL_S) as stage:
            try:
                new = compiler() and builder.build()  # without one, the line below says so
            except builder.AheadError as error:
                print(f"schmidt: the plant's kernel will be compiled when it is first needed: {error}")
                new = False
            new |= build(say=lambda line: print(f"schmidt: {line}"), stage=stage)
        if new:
            print(f"schmidt: compiled in {time.perf_counter() - start:.0f} s")
    except BuildError as error:
        print(f"schmidt: not compiled, running plain Python: {error}")
        return 1 if "--strict" in sys.argv else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
