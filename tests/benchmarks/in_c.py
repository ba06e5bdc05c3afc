"""The night with both axis boards in C against Python, in turn: `python -m tests.benchmarks.in_c`.

Both run in this process, a second of each after the other, in an order that changes. Both see the same
machine.
"""

import sys
import tempfile
import time
from math import comb
from pathlib import Path

from scenarios.lab.session import Session
from scenarios.native import compiled
from tests.benchmarks import network

ROUNDS = 300
CONFIDENCE = 0.99
_SECOND_NS = 1_000_000_000


def ratios(rounds: int) -> list[float]:
    """CPU time of a second with Python boards over one with C boards, round by round."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        made = [Path(folder) / name for name in ("python", "c")]
        for each in made:
            each.mkdir()
        python, in_c = (network.session(each, in_c=k == 1) for k, each in enumerate(made))
        for k in range(-2, rounds):  # two that count for nothing
            order = (python, in_c) if k % 2 else (in_c, python)
            spent = {id(session): _second(session) for session in order}
            if k >= 0:
                found.append(spent[id(python)] / spent[id(in_c)])
        for session in (python, in_c):
            session.recorder.close()
    return found


def _second(session: Session) -> float:
    begun = time.process_time()
    session.advance(session.network.queue.now_ns + _SECOND_NS)
    return time.process_time() - begun


def interval(values: list[float], confidence: float = CONFIDENCE) -> tuple[float, float, float]:
    """Median and its interval by the sign test, which asks nothing of the distribution."""
    ordered, count = sorted(values), len(values)
    outside, place = 0.0, 0
    while outside + 2 * comb(count, place) / 2**count < 1 - confidence:
        outside += 2 * comb(count, place) / 2**count
        place += 1
    middle = (ordered[(count - 1) // 2] + ordered[count // 2]) / 2
    place = max(place - 1, 0)
    return middle, ordered[place], ordered[-1 - place]


def main(words: list[str]) -> int:
    """Print the figure; 1 if the interval does not lie above 1."""
    values = ratios(int(words[0]) if words else ROUNDS)
    middle, low, high = interval(values)
    way = "compiled" if compiled() else "plain"
    print(f"{way}: night over night in C {middle:.3f}, {CONFIDENCE:.0%} interval {low:.3f} to {high:.3f}")
    return 0 if low > 1 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
