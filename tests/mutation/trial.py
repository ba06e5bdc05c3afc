"""Whether tests pass although a module is another: run in a forked child, it leaves nothing behind.

A mutant inside a function changes the code of the functions that are there. Any other one needs every module
of ours imported anew, and so does a function that runs at import.
"""

import gc
import importlib.abc
import importlib.machinery
import importlib.util
import os
import resource
import signal
import sys
from collections.abc import Iterator, Sequence
from types import CodeType, FunctionType, ModuleType
from typing import Any

import pytest

from tests.mutation.session import Test, run

OURS = ("bus", "boards", "plant", "host", "calibration", "scenarios", "tests", "docs", "schmidt")
MOST_BYTES = 4 << 30
"""Of memory: a mutant that never ends does not take the machine's."""
COMPILED_S = 8.0
"""Of the processor, for what numba compiles anew once all is imported again. ASSUMPTION: a few kernels."""


class Substitute(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Gives one module other code than its file has."""

    def __init__(self, name: str, code: CodeType) -> None:
        self.name, self.code = name, code

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        return importlib.util.spec_from_loader(fullname, self) if fullname == self.name else None

    def exec_module(self, module: ModuleType) -> None:
        module.__file__ = self.code.co_filename
        exec(self.code, module.__dict__)


def limit(test: Test, more_s: float = 0.0) -> None:
    """End this process if the test takes several times what it takes without a mutation, and `more_s`."""
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, 0.5 + more_s + 10 * test.cpu)
    signal.alarm(60 + round(20 * test.wall))


class Chosen:
    """A pytest plug-in: these tests in this order, each within its time."""

    def __init__(self, tests: dict[str, Test]) -> None:
        self.tests = tests

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        order = {name: place for place, name in enumerate(self.tests)}
        items[:] = sorted(
            (each for each in items if each.nodeid in order), key=lambda each: order[each.nodeid]
        )

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        limit(self.tests[item.nodeid], COMPILED_S)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            os._exit(1)


def codes(code: CodeType) -> Iterator[CodeType]:
    """A code and those inside it."""
    yield code
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield from codes(each)


class Bench:
    """Collected tests, and the functions that are there."""

    def __init__(self, items: Sequence[pytest.Item]) -> None:
        self.items = {each.nodeid: each for each in items}
        self.functions: dict[str, list[FunctionType]] = {}
        gc.collect()
        for each in gc.get_objects():
            if type(each) is FunctionType:
                self.functions.setdefault(each.__code__.co_filename, []).append(each)
        gc.freeze()

    def patched(self, code: CodeType, tests: dict[str, Test]) -> bool:
        """Whether the tests pass with the functions of `code`; raises where they are no match."""
        found = [((each.co_qualname, each.co_firstlineno), each) for each in codes(code)]
        new = dict(found)
        if len(new) < len(found):
            return self.anew(code, tests)
        try:
            for function in self.functions.get(code.co_filename, ()):
                old = function.__code__
                function.__code__ = new.get((old.co_qualname, old.co_firstlineno), old)
        except ValueError:  # other free variables
            return self.anew(code, tests)
        resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        items = [self.items[name] for name in tests]
        for item, following in zip(items, [*items[1:], None], strict=False):
            limit(tests[item.nodeid])
            runner: Any = item.config.pluginmanager.get_plugin("runner")  # pytest's own
            if any(report.failed for report in runner.runtestprotocol(item, log=False, nextitem=following)):
                return False
        return True

    def anew(self, code: CodeType, tests: dict[str, Test]) -> bool:
        """Whether the tests pass when everything of ours is imported again, one module from `code`."""
        name = os.path.relpath(code.co_filename).removesuffix(".py").replace("/", ".")
        for each in list(sys.modules):
            if each.split(".")[0] in OURS and each.split(".")[:2] != ["tests", "mutation"]:
                del sys.modules[each]
        sys.meta_path.insert(0, Substitute(name, code))
        files = dict.fromkeys(test.partition("::")[0] for test in tests)
        signal.alarm(600)
        return run(list(files), [Chosen(tests)]) == 0
