"""How tests run here: in forked children, plainly, with few examples that are always the same."""

import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import NamedTuple

import hypothesis
import pytest

AGAIN_S = 0.05
"""Of the processor, until a test that takes too long is ended after all."""
_QUIET = ["-W", "ignore::pytest.PytestAssertRewriteWarning", "--override-ini", "addopts=", "-q", "-s"]
_PLAIN = ["--assert=plain", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:anyio"]


class Test(NamedTuple):
    """What a test takes, s: on the clock, and of the processor. fixtures: names of those it asks for."""

    wall: float
    cpu: float
    fixtures: tuple[str, ...] = ()

    @property
    def time(self) -> float:
        """What counts, s: the processor's. A busy machine stretches the other up to twenty times."""
        return max(self.cpu, self.wall / 20)


def too_long(_: int, frame: FrameType | None) -> None:
    """Let the test that runs fail; a little later within coverage, which would never open its lock."""
    if frame is not None and "coverage" in Path(frame.f_code.co_filename).parts:
        signal.setitimer(signal.ITIMER_PROF, AGAIN_S)
    else:
        pytest.fail("takes too long")


class FewExamples:
    """A pytest plug-in: few examples, none made smaller, whatever a conftest file has chosen."""

    def pytest_collection(self) -> None:
        hypothesis.settings.register_profile(
            "mutation", max_examples=15, deadline=None, database=None, derandomize=True,
            phases=(hypothesis.Phase.explicit, hypothesis.Phase.generate),
        )  # fmt: skip
        hypothesis.settings.load_profile("mutation")


def run(files: Sequence[str], plugins: Sequence[object]) -> int:
    """Exit status of pytest on these files."""
    quick = ["-m", "not slow and not long and not guest"]
    return int(pytest.main([*quick, *_PLAIN, *_QUIET, *files], plugins=[FewExamples(), *plugins]))


def fork(work: Callable[[], bool]) -> int:
    """Process identifier of a child that does the work, says nothing and exits with 0 if it is true."""
    sys.stdout.flush()
    child = os.fork()
    if not child:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        good = False
        try:
            good = work()
        finally:
            os._exit(0 if good else 1)
    return child


def forked(work: Callable[[], bool]) -> bool:
    """Whether the work was true in a child; false if it died."""
    return os.waitpid(fork(work), 0)[1] == 0


def outcomes(works: Iterable[Callable[[], bool]], jobs: int) -> Iterator[tuple[int, bool]]:
    """Place of each work and whether it was true, as children end; so many run at a time."""
    running: dict[int, int] = {}
    for place, work in enumerate(works):
        running[fork(work)] = place
        while len(running) == jobs:
            yield _ended(running)
    while running:
        yield _ended(running)


def _ended(running: dict[int, int]) -> tuple[int, bool]:
    child, status = os.wait()
    return running.pop(child), status == 0
