"""Mutation runs: every module of a room has tests, mutants change what they say, and floors are held."""

import os
import signal
from pathlib import Path
from types import FrameType

import pytest

from tests.mutation import ratchet
from tests.mutation.operators import mutants
from tests.mutation.ratchet import fallen, floors, key, reasons
from tests.mutation.rooms import AIMS, BESIDES, judging, mirrors, modules, room_of
from tests.mutation.session import forked, outcomes, too_long
from tests.mutation.trial import Bench

BOTH = "value > LIMIT and value > least"
SOURCE = """\
LIMIT = 3
def over(value,
         least=0):
    if value > LIMIT and (
            value > least):
        return 1
    return 2
"""


@pytest.mark.parametrize("room", AIMS)
def test_a_room_has_modules_and_tests_and_they_are_there(room: str) -> None:
    assert modules(room) and judging(room)
    assert all(Path(each).is_file() for each in judging(room))
    assert all(Path(each).exists() for each in BESIDES.get(room, ()))


def test_every_module_that_is_named_is_there_and_in_a_room() -> None:
    for path in [*floors(), *(each.partition(":")[0] for each in reasons())]:
        assert Path(path).is_file() and room_of(path), path


def test_a_survivor_with_a_reason_is_a_mutant_still() -> None:
    known = reasons()
    for path in {each.partition(":")[0] for each in known}:
        labels = {key(path, each.label) for each in mutants(Path(path).read_text(encoding="utf-8"))}
        assert {each for each in known if each.startswith(f"{path}:")} <= labels


def test_a_module_is_mirrored_by_the_test_of_its_name_or_else_by_its_folder() -> None:
    assert mirrors("bus/can/bits.py", "tests/bus/can/test_bits.py")
    assert not mirrors("bus/can/bits.py", "tests/bus/can/test_wire.py")
    assert mirrors("bus/can/length.py", "tests/bus/can/test_wire.py")
    assert not mirrors("bus/can/length.py", "tests/bus/time/test_queue.py")


def test_a_mutant_knows_the_lines_of_its_statement_and_whether_a_function_runs_it() -> None:
    found = {each.label.partition(": ")[2]: (each.lines, each.inside) for each in mutants(SOURCE)}
    assert found == {
        "constant: 3 -> 4 in: LIMIT = 3": (range(1, 2), False),
        "constant: 0 -> 1 in: least=0):": (range(2, 4), False),
        f"negate: if {BOTH}: -> if not ({BOTH}):": (range(4, 6), True),
        f"boolean: {BOTH} -> value > LIMIT or value > least": (range(4, 6), True),
        "compare: value > LIMIT -> value >= LIMIT": (range(4, 6), True),
        "compare: value > least -> value >= least": (range(4, 6), True),
        "constant: 1 -> 2 in: return 1": (range(6, 7), True),
        "constant: 2 -> 3 in: return 2": (range(7, 8), True),
    }  # fmt: skip


def test_without_a_test_that_is_quick_enough_nothing_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else pytest, without a file, would collect all there are."""
    pytest.importorskip("coverage")
    from tests.mutation.__main__ import main

    monkeypatch.setattr("sys.argv", ["mutation", "bus", "--tests", "nowhere"])
    with pytest.raises(SystemExit, match="nowhere: no test"):
        main()


def test_a_share_below_its_floor_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.mutation.ratchet.floors", lambda: {"a.py": 90.0})
    assert fallen({"a.py": 90.0, "b.py": 0.0}) == []
    assert fallen({"a.py": 89.9}) == ["a.py: 89.9 % killed, was 90 %"]


def test_a_survivor_is_known_without_its_line() -> None:
    assert key("a.py", "12: compare: a < b -> a <= b") == key("a.py", "99: compare: a < b -> a <= b")


def test_a_function_that_is_there_does_what_its_mutant_does() -> None:
    source = Path(ratchet.__file__).read_text(encoding="utf-8")
    mutant = next(each for each in mutants(source) if "share < floor -> share <= floor" in each.label)

    def changed() -> bool:
        before = ratchet.fallen({"a.py": 0.0})
        Bench([]).patched(compile(mutant.tree(), ratchet.__file__, "exec"), {})
        return not before and bool(ratchet.fallen({"a.py": 0.0}))

    assert forked(changed)
    assert not ratchet.fallen({"a.py": 0.0})


def test_a_child_that_dies_or_fails_is_a_mutant_killed() -> None:
    works = (
        lambda: True,
        lambda: False,
        lambda: bool(1 // 0),
        lambda: os.kill(os.getpid(), signal.SIGKILL) is None,
    )
    for jobs in (1, 2):
        assert dict(outcomes(works, jobs)) == {0: True, 1: False, 2: False, 3: False}


TESTS = """\
import pytest
import here

@pytest.fixture(scope="module")
def made():
    return here.shared()

def test_one(made):
    assert here.own() == made

def test_two(made):
    assert made == 1
"""
CODE = """\
ONE = 1
def shared():
    return ONE
def own():
    return ONE
"""


def test_what_a_shared_fixture_executes_is_every_tests_that_asks_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("coverage")
    from tests.mutation.covering import Covering

    for name, text in {"bus/here.py": CODE, "tests/bus/test_here.py": TESTS}.items():
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path / "bus")
    found = Covering("bus", ["tests/bus/test_here.py"], 1.0)
    one, two = (f"tests/bus/test_here.py::test_{each}" for each in ("one", "two"))
    assert sorted(found.executing("bus/here.py", range(3, 4))) == [one, two]
    assert found.executing("bus/here.py", range(5, 6)) == [one]
    assert found.imported("bus/here.py", range(1, 2)) and not found.imported("bus/here.py", range(3, 4))


@pytest.mark.parametrize("place", ["test_some.py", "site-packages/coverage/collector.py"])
def test_a_test_that_takes_too_long_ends_where_no_lock_is_held(place: str) -> None:
    """What raises within coverage leaves its lock shut, and the run waits for ever."""
    held: dict[str, FrameType] = {}
    exec(compile("import sys\nframe = sys._getframe()", place, "exec"), held)
    old = signal.signal(signal.SIGPROF, signal.SIG_IGN)
    try:
        if "coverage" in place:
            too_long(signal.SIGPROF, held["frame"])
            assert signal.getitimer(signal.ITIMER_PROF)[0] > 0
        else:
            with pytest.raises(pytest.fail.Exception):
                too_long(signal.SIGPROF, held["frame"])
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, old)
