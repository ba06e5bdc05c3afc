"""Runs the tests of every target on mutants: `python -m tests.mutation [--room ROOM] [--part K/N]`.

Mutants run in forked children, so that numpy and pytest are imported once; a changed source takes its
module's place at import. Whole rooms take days of one core: nightly.yml runs samples of them in parts.
"""

import argparse
import importlib.abc
import importlib.machinery
import importlib.util
import os
import random
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from types import CodeType, ModuleType

import can
import cantools
import hypothesis
import numpy as np
import pytest

from tests.mutation.operators import mutants
from tests.mutation.ratchet import fallen, key, reasons, tighten
from tests.mutation.targets import AIMS, TARGETS, modules

TIMEOUT_S = 600
"""Tests without a mutation, however busy the machine."""
WARM = (can, cantools, np)
"""Imported once, before the children are forked."""


class FewExamples:
    """A pytest plug-in: few and always the same examples, whatever a conftest file has chosen."""

    def pytest_collection(self) -> None:
        hypothesis.settings.load_profile("mutation")


class Substitute(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Gives one module other code than its file has."""

    def __init__(self, name: str, code: CodeType) -> None:
        self.name, self.code = name, code

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        return importlib.util.spec_from_loader(fullname, self) if fullname == self.name else None

    def exec_module(self, module: ModuleType) -> None:
        exec(self.code, module.__dict__)


def survives(path: str, source: str, tests: tuple[str, ...], timeout_s: float = TIMEOUT_S) -> bool:
    """Whether the tests pass although `path` holds `source`."""
    child = os.fork()
    if not child:
        signal.alarm(round(timeout_s))
        name = path.removesuffix(".py").replace("/", ".")
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        code = 1
        try:
            sys.meta_path.insert(0, Substitute(name, compile(source, path, "exec")))
            quiet = ["-W", "ignore::pytest.PytestAssertRewriteWarning", "--override-ini", "addopts="]
            plain = ["--assert=plain", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:anyio"]
            arguments = ["-x", "-q", *plain, "-m", "not slow and not guest", *quiet]
            code = int(pytest.main([*arguments, *tests], plugins=[FewExamples()]))
        finally:
            os._exit(code)
    return os.waitpid(child, 0)[1] == 0


def main() -> None:
    """Run, print survivors as they come, and the score."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--room", choices=AIMS, help="every module of this room, not only the targets")
    parser.add_argument("--only", default="", help="targets whose path contains this")
    parser.add_argument(
        "--ratchet", action="store_true", help="fail where less is killed than floor.yaml says"
    )
    parser.add_argument("--tighten", action="store_true", help="raise floor.yaml to what is measured")
    parser.add_argument("--part", default="1/1", help="K/N: the K-th of N parts of each target's mutants")
    parser.add_argument("--sample", type=int, default=0, help="at most so many mutants of each target")
    parser.add_argument("--out", type=Path, help="file for the survivors")
    options = parser.parse_args()
    part, parts = (int(number) for number in options.part.split("/"))
    hypothesis.settings.register_profile(
        "mutation", max_examples=15, deadline=None, database=None, derandomize=True
    )
    lines: list[str] = []

    def tell(text: str) -> None:
        lines.append(text)
        print(text, flush=True)
        if options.out:
            options.out.write_text("\n".join(lines) + "\n", encoding="utf-8")

    total = killed = 0
    known, shares = reasons(), dict[str, float]()
    for path, tests in (modules(options.room) if options.room else TARGETS).items():
        if options.only not in path:
            continue
        source = Path(path).read_text(encoding="utf-8")
        started = time.monotonic()
        if not survives(path, source, tests):
            raise SystemExit(f"{path}: its tests fail without any mutation; repair them first")
        longest_s = 60 + 5 * (time.monotonic() - started)
        cases = [case for case in mutants(source) if key(path, case[0]) not in known][part - 1 :: parts]
        if not cases:
            continue
        if options.sample and len(cases) > options.sample:
            cases = random.Random(path).sample(cases, options.sample)
        alive = 0
        for label, changed in cases:
            if survives(path, changed, tests, longest_s):
                alive += 1
                tell(f"    {path}:{label}")
        total, killed = total + len(cases), killed + len(cases) - alive
        shares[path] = 100 * (1 - alive / len(cases))
        took = time.monotonic() - started
        tell(f"{path}: {len(cases) - alive} of {len(cases)} killed ({took:.0f} s)")
    aim = f", aim {AIMS[options.room]} %" if options.room else ""
    tell(f"in all {killed} of {total} killed: {100 * killed / max(total, 1):.1f} %{aim}")
    if options.tighten:
        tighten(shares)
    if options.ratchet and (less := fallen(shares)):
        raise SystemExit("\n".join(less))


if __name__ == "__main__":
    main()
