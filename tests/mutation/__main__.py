"""Runs tests on the mutants of a room: `python -m tests.mutation ROOM [--only PATH] [--sample N]`.

A mutant meets the tests that execute its line, the quickest first, up to the first that fails. Coverage has
told which these are. Everything is imported and collected once; each mutant is a forked child.
"""

import argparse
import os
import re
from collections.abc import Callable, Container
from functools import partial
from pathlib import Path

import pytest

from tests.mutation.covering import Covering
from tests.mutation.operators import Mutant, mutants
from tests.mutation.ratchet import fallen, key, reasons, tighten
from tests.mutation.rooms import AIMS, UNCOMPILED, judging, modules
from tests.mutation.sample import drawn, interval
from tests.mutation.session import Test, forked, outcomes, run
from tests.mutation.trial import Bench


def options() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("room", choices=AIMS)
    parser.add_argument("--only", default="", help="modules whose path contains this")
    parser.add_argument("--ratchet", action="store_true", help="fail below floor.yaml")
    parser.add_argument("--tighten", action="store_true", help="raise floor.yaml to what is measured")
    parser.add_argument("--part", default="1/1", help="K/N: the K-th of N parts of the modules")
    parser.add_argument("--tests", default="", help="of those that may notice, files whose path this matches")
    parser.add_argument("--seconds", type=float, default=10, help="of tests at most, for each mutant")
    parser.add_argument("--jobs", type=int, choices=(1, 2), default=1, help="children at a time")
    parser.add_argument("--out", type=Path, help="file for the survivors")
    parser.add_argument("--sample", type=int, help="so many mutants, drawn at random over all modules")
    parser.add_argument("--seed", type=int, default=1, help="of that sample")
    asked = parser.parse_args()
    if asked.sample is not None and (asked.sample < 1 or asked.ratchet or asked.tighten):
        parser.error("a sample has at least one mutant, and a floor is that of all")
    return asked


class Loop:
    """A pytest plug-in: mutants, where the tests would run."""

    def __init__(self, asked: argparse.Namespace, covering: Covering) -> None:
        self.asked, self.covering = asked, covering
        self.shares: dict[str, float] = {}
        self.broken: list[str] = []
        self.total = self.killed = 0

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self.bench = Bench(session.items)
        every = self.within(self.covering.of_room())
        if not forked(partial(self.bench.patched, compile("", "", "exec"), every)):
            self.broken.append(self.asked.room)
            return True
        first, parts = (int(number) for number in self.asked.part.split("/"))
        paths = [each for each in modules(self.asked.room) if self.asked.only in each]
        known = reasons()
        cases = {path: unexplained(path, known) for path in paths[first - 1 :: parts]}
        if self.asked.sample:
            cases = drawn(cases, self.asked.sample, self.asked.seed)
        for path, some in cases.items():
            self.module(path, some)
        aim = AIMS[self.asked.room]
        self.tell(f"in all {self.killed} of {self.total} killed: "
                  f"{100 * self.killed / max(self.total, 1):.1f} %, aim {aim} %")  # fmt: skip
        if self.asked.sample and self.total:
            low, high = interval(self.killed, self.total)
            self.tell(f"of all mutants {low:.1f} to {high:.1f} % (seed {self.asked.seed})")
        return True

    def tell(self, text: str) -> None:
        print(text, flush=True)
        if self.asked.out:
            with self.asked.out.open("a", encoding="utf-8") as file:
                file.write(text + "\n")

    def module(self, path: str, cases: list[Mutant]) -> None:
        """These mutants of one module."""
        if not cases:
            return
        anew = partial(self.bench.anew, compile(cases[0].source, os.path.abspath(path), "exec"))
        every = self.within(self.covering.of_module(path))
        if every and any(self.imported(path, each) for each in cases) and not forked(partial(anew, every)):
            self.broken.append(path)
            return
        started, alive = _spent(), 0
        works = (self.work(path, each) for each in cases)
        for place, passed in outcomes(works, self.asked.jobs):
            if passed:
                alive += 1
                self.tell(f"    {path}:{cases[place].label}")
        self.total, self.killed = self.total + len(cases), self.killed + len(cases) - alive
        self.shares[path] = 100 * (1 - alive / len(cases))
        took = _spent() - started
        self.tell(f"{path}: {len(cases) - alive} of {len(cases)} killed ({took:.0f} s of the processor)")

    def imported(self, path: str, mutant: Mutant) -> bool:
        """Whether an import runs the line, so that functions that are there do not tell all."""
        return not mutant.inside or self.covering.imported(path, mutant.lines)

    def work(self, path: str, mutant: Mutant) -> Callable[[], bool]:
        """What a child does with a mutant; no test, no work. What runs at import is tried there first."""
        names = self.covering.executing(path, mutant.lines) if mutant.inside else []
        here, everywhere = self.within(names), self.within(self.covering.of_module(path))

        def passed() -> bool:
            code = compile(mutant.tree(), os.path.abspath(path), "exec")
            if not self.imported(path, mutant):
                return not here or self.bench.patched(code, here)
            if here and not forked(partial(self.bench.patched, code, here)):
                return False
            return not everywhere or self.bench.anew(code, everywhere)

        return passed

    def within(self, names: list[str]) -> dict[str, Test]:
        """As many of these tests as the time allows, at least one."""
        left, found = self.asked.seconds, dict[str, Test]()
        for name in names:
            if found and (left := left - self.covering.tests[name].time) < 0:
                break
            found[name] = self.covering.tests[name]
        return found


def unexplained(path: str, known: Container[str]) -> list[Mutant]:
    """The mutants of a module, but for those whose survival has a reason that is known."""
    source = Path(path).read_text(encoding="utf-8")
    return [each for each in mutants(source) if key(path, each.label) not in known]


def _spent() -> float:
    """Processor time of the children, s."""
    return os.times().children_user + os.times().children_system


def main() -> None:
    """Run, print survivors as they come, and the score."""
    asked = options()
    if asked.room in UNCOMPILED:
        os.environ["NUMBA_DISABLE_JIT"] = "1"
    files = [each for each in judging(asked.room) if re.search(asked.tests, each)]
    covering = Covering(asked.room, files, asked.seconds)
    if not covering.tests:
        raise SystemExit(f"{asked.tests or asked.room}: no test that is quick enough")
    loop = Loop(asked, covering)
    run(sorted({name.partition("::")[0] for name in covering.tests}), [loop])
    if loop.broken or not loop.shares:
        raise SystemExit(
            f"{', '.join(loop.broken) or 'all'}: tests fail without any mutation; repair them first"
        )
    if asked.tighten:
        tighten(loop.shares)
    if asked.ratchet and (less := fallen(loop.shares)):
        raise SystemExit("\n".join(less))


if __name__ == "__main__":
    main()
