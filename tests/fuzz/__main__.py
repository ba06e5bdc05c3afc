"""`python -m tests.fuzz [--inputs N] [--door NAME] [--seed S]`: the long run."""

import argparse
import time
import warnings

import scenarios  # noqa: F401  (before the other rooms, so that the library can be used)
from scenarios.progress import shown
from tests.fuzz.doors import ALONE, DOORS, attack
from tests.fuzz.left import Left


def main() -> None:
    warnings.simplefilter("error")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=1_000_000)
    parser.add_argument("--door", choices=sorted(DOORS | ALONE), action="append")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    doors = list(asked.door or DOORS | ALONE)
    with shown("fuzzing", len(doors) * asked.inputs) as show:
        for number, door in enumerate(doors):
            start = time.perf_counter()

            def heard(done: int, door: str = door, before: int = number * asked.inputs) -> None:
                show(before + done, door)

            Left.heard = heard
            found = attack(door, asked.inputs, asked.seed)
            seconds = time.perf_counter() - start
            tick = ", all boards tick" if door in DOORS else ""
            print(f"{door}: {asked.inputs} inputs in {seconds:.0f} s{tick}; {found}", flush=True)


if __name__ == "__main__":
    main()
