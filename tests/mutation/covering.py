"""Which test executes which line of a room, and how long it takes: one run under coverage, kept in `out/`.

What a fixture of a module or of more executes, and its time, is every test's that asks for it.
"""

import json
import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import coverage
import pytest

from tests.mutation.rooms import mirrors, modules
from tests.mutation.session import Test, forked, run, too_long

IMPORT = ""
"""Coverage's context while no test runs."""
FIXTURE = "fixture "
"""Before a fixture's place and name, it is the context while that is set up."""


class Recorder:
    """A pytest plug-in: a context for each test and each fixture of more than one; times of what passes."""

    def __init__(self, room: str, longest_s: float) -> None:
        self.longest_s = longest_s
        self.measured = coverage.Coverage(include=modules(room), data_file=None, config_file=False)
        self.context = IMPORT
        self.times: dict[str, Test] = {}
        self.failed: set[str] = set()
        self.measured.start()

    @contextmanager
    def within(self, context: str, fixtures: tuple[str, ...] = ()) -> Iterator[None]:
        """Lines and time are this context's, not the one's around it."""
        outer, self.context = self.context, context
        self.measured.switch_context(context)
        wall, cpu = time.monotonic(), time.process_time()
        try:
            yield
        finally:
            wall, cpu = time.monotonic() - wall, time.process_time() - cpu
            known, around = (self.times.get(each, Test(0.0, 0.0)) for each in (context, outer))
            self.times[context] = Test(known.wall + wall, known.cpu + cpu, fixtures)
            self.times[outer] = Test(around.wall - wall, around.cpu - cpu)
            self.context = outer
            self.measured.switch_context(outer)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        signal.signal(signal.SIGPROF, too_long)
        signal.setitimer(signal.ITIMER_PROF, self.longest_s)
        with self.within(item.nodeid, tuple(getattr(item, "fixturenames", ()))):
            result = yield
        signal.setitimer(signal.ITIMER_PROF, 0)
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[None]:
        if fixturedef.scope == "function":
            return (yield)
        with self.within(f"{FIXTURE}{fixturedef.baseid} {fixturedef.argname}"):
            return (yield)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if not report.passed:
            self.failed.add(report.nodeid)

    def found(self) -> dict[str, list[Any]]:
        """Times, fixtures and lines by module, of every test and fixture that did not fail."""
        self.measured.stop()
        data, lines = self.measured.get_data(), dict[str, dict[str, list[int]]]()
        for file in data.measured_files():
            for line, contexts in data.contexts_by_lineno(file).items():
                for context in contexts:
                    lines.setdefault(context, {}).setdefault(os.path.relpath(file), []).append(line)
        names = (self.times.keys() | lines.keys()) - self.failed
        return {name: [*self.times.get(name, Test(0, 0)), lines.get(name, {})] for name in names}


def _times(files: list[str]) -> dict[str, float]:
    return {each: Path(each).stat().st_mtime for each in files}


class Covering:
    """The map of a room by these files of tests, made anew where one has changed.

    longest_s: a test that takes more of the processor is left out.
    """

    def __init__(self, room: str, files: list[str], longest_s: float) -> None:
        store, code = Path("out/mutation", room.replace("/", "-") + ".json"), _times(modules(room))
        kept = json.loads(store.read_text(encoding="utf-8")) if store.exists() else {}
        if kept.get("code") != code:
            kept = {"code": code, "files": {}, "found": {}}
        now = _times(files)
        changed = [each for each in files if kept["files"].get(each) != now[each]]
        if changed:
            store.parent.mkdir(parents=True, exist_ok=True)
            kept["files"].update(now)
            forked(lambda: self._record(Recorder(room, longest_s), changed, kept, store))
            kept = json.loads(store.read_text(encoding="utf-8"))
        known: dict[str, list[Any]] = kept["found"]
        self.tests: dict[str, Test] = {}
        self._lines: dict[tuple[str, int], set[str]] = {}
        above = {name: each for name, each in known.items() if name.startswith(FIXTURE)}
        for name, (wall, cpu, fixtures, lines) in known.items():
            if name.partition("::")[0] in files:
                asked = [key.removeprefix(FIXTURE).rpartition(" ") for key in above]
                shared = [
                    each
                    for (base, _, fixture), each in zip(asked, above.values(), strict=True)
                    if fixture in fixtures and name.startswith(base)
                ]
                wall, cpu = (own + sum(each[k] for each in shared) for k, own in ((0, wall), (1, cpu)))
                self.tests[name] = Test(wall, cpu)
                for found in (lines, *(each[3] for each in shared)):
                    self._take(name, found)
        self._take(IMPORT, known.get(IMPORT, [0, 0, (), {}])[3])

    def _take(self, name: str, lines: dict[str, list[int]]) -> None:
        for path, each in lines.items():
            for line in each:
                self._lines.setdefault((path, line), set()).add(name)

    @staticmethod
    def _record(recorder: Recorder, changed: list[str], kept: dict[str, Any], store: Path) -> bool:
        run(changed, [recorder])
        found, known = recorder.found(), kept["found"]
        for path, lines in known.get(IMPORT, [0, 0, (), {}])[3].items():
            found[IMPORT][3].setdefault(path, []).extend(lines)
        old = {k: v for k, v in known.items() if not k.removeprefix(FIXTURE).startswith(tuple(changed))}
        store.write_text(json.dumps({**kept, "found": {**old, **found}}), encoding="utf-8")
        return True

    def imported(self, path: str, lines: range) -> bool:
        """Whether a line runs while no test does."""
        return any(IMPORT in self._lines.get((path, line), ()) for line in lines)

    def executing(self, path: str, lines: range) -> list[str]:
        """Tests that execute one of the lines, the quickest first."""
        return self._sorted(set[str]().union(*(self._lines.get((path, line), ()) for line in lines)))

    def of_module(self, path: str) -> list[str]:
        """Tests that execute any line of the module while they run, or mirror it; the quickest first."""
        own = {test for test in self.tests if mirrors(path, test.partition("::")[0])}
        return self._sorted(own.union(*(names for (each, _), names in self._lines.items() if each == path)))

    def of_room(self) -> list[str]:
        """All tests, the quickest first."""
        return self._sorted(set(self.tests))

    def _sorted(self, names: set[str]) -> list[str]:
        return sorted(names & self.tests.keys(), key=lambda name: (self.tests[name].time, name))
