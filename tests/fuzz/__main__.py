"""`python -m tests.fuzz [--inputs N] [--door NAME] [--seed S]`: the long run."""

import argparse
import time

from tests.fuzz.doors import DOORS, attack


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=1_000_000)
    parser.add_argument("--door", choices=sorted(DOORS), action="append")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    for door in asked.door or DOORS:
        start = time.perf_counter()
        found = attack(door, asked.inputs, asked.seed)
        seconds = time.perf_counter() - start
        print(f"{door}: {asked.inputs} inputs in {seconds:.0f} s, all boards tick; {found}", flush=True)


if __name__ == "__main__":
    main()
