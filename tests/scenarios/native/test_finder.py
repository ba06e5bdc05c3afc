"""When a compiled library is used: never one that does not fit or comes too late; and what is said of it."""

import os
import sys
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from typing import Any

import pytest

from scenarios.native import finder, stamp
from scenarios.native.finder import PURE, Finder, Rooms, compiled, ours_first, plain, use


def entries() -> list[object]:
    """Those of ours on sys.meta_path."""
    return [each for each in sys.meta_path if isinstance(each, Finder | Rooms)]


class Desk:
    """A sys.meta_path without our entries and a library of which the stamp says what a test wants."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.stamp: dict[str, object] | None = {"modules": {"schmidt_absent": "absent.so"}}
        self.reason: str | None = None
        others = [each for each in sys.meta_path if not isinstance(each, Finder | Rooms)]
        monkeypatch.setattr(sys, "meta_path", others)
        monkeypatch.setattr(finder, "read", lambda library: self.stamp)
        monkeypatch.setattr(finder, "difference", lambda stamp: self.reason)
        monkeypatch.setenv(PURE, "")


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_a_library_that_fits_is_found_by_its_modules(desk: Desk, tmp_path: Path) -> None:
    use(tmp_path)
    found = sys.meta_path[0]
    assert isinstance(found, Finder) and compiled()
    assert found.find_spec("json") is None
    spec = found.find_spec("schmidt_absent")
    assert spec is not None and isinstance(spec.loader, ExtensionFileLoader)
    assert spec.origin == str(tmp_path / "absent.so")
    use(tmp_path)
    assert len(entries()) == 1  # once
    assert plain() and not compiled()


def test_what_is_compiled_already_cannot_be_plain(desk: Desk, tmp_path: Path) -> None:
    found: Any = Finder({"sys": tmp_path / "sys.so"})
    sys.meta_path.insert(0, found)
    assert not plain() and compiled()


def test_one_that_does_not_fit_is_said_once(
    desk: Desk, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk.reason = "was built before x.py changed"
    use(tmp_path)
    said = "schmidt: the compiled library was built before x.py changed; running plain (`make compiled`)\n"
    assert capsys.readouterr().err == said
    assert not entries() and os.environ[PURE] == "1"
    use(tmp_path)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    "stamp_", [None, {}, {"modules": "none"}, {"modules": {}}, {"modules": {"sys": "sys.so"}}]
)
def test_none_an_empty_one_or_a_late_one_is_left_without_a_word(
    desk: Desk, stamp_: dict[str, object] | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk.stamp = stamp_
    use(tmp_path)
    assert not entries() and capsys.readouterr().err == "" and os.environ[PURE] == ""


@pytest.mark.parametrize(
    ("stamp_", "reason", "said"),
    [(None, None, "is not there"), ({}, "is old", "is old"),
     ({"modules": {"sys": "sys.so"}}, None, "comes too late: import scenarios before the other rooms")],
)  # fmt: skip
def test_who_insists_on_it_is_told_why_not(
    desk: Desk, stamp_: Any, reason: str | None, said: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(PURE, "0")
    desk.stamp, desk.reason = stamp_, reason
    with pytest.raises(ImportError) as caught:
        use(tmp_path)
    tail = "; `make compiled` builds it, SCHMIDT_PURE=1 does without"
    assert str(caught.value) == f"the compiled library {said}{tail}"
    monkeypatch.setenv(PURE, "1")
    use(tmp_path)
    assert not entries()


def test_our_rooms_are_found_here_and_nobody_else_s(desk: Desk) -> None:
    ours_first()
    ours_first()
    rooms = sys.meta_path[0]
    assert isinstance(rooms, Rooms) and len(entries()) == 1
    for name in ("plant", "calibration"):
        spec = rooms.find_spec(name)
        assert spec is not None and spec.submodule_search_locations
    assert rooms.find_spec("json") is None


def write(root: Path, **files: str) -> None:
    for name, text in files.items():
        path = root / name.replace("__", "/").replace("_py", ".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_a_stamp_lists_what_is_compiled_and_what_that_imports(tmp_path: Path) -> None:
    lines = ("import json", "import plant.units", "from host.sky import mount", "from . import near")
    text = "\n".join(lines)
    write(tmp_path, bus__can__a_py=text, plant__units_py="", host__sky__mount_py="", host__other_py="")
    write(tmp_path, bus__can__b_py="here = __file__\n", scenarios__native__modules_py="")
    expected = ["bus/can/a.py", "host/sky/mount.py", "plant/units.py", stamp.CHOICE]
    assert stamp.sources(tmp_path) == expected
    made = stamp.make(tmp_path)
    assert stamp.difference(made, tmp_path) is None
    write(tmp_path, plant__units_py="x = 1\n")
    assert stamp.difference(made, tmp_path) == "was built before plant/units.py changed"
    fresh = stamp.make(tmp_path)
    write(tmp_path, bus__can__c_py="", bus__can__d_py="")
    assert stamp.difference(fresh, tmp_path) == "was built before bus/can/c.py came"


def test_a_stamp_of_another_python_or_version_does_not_fit(tmp_path: Path) -> None:
    assert stamp.difference({"suffix": ".old.so"}, tmp_path) == "was built for another Python (.old.so)"
    assert (
        stamp.difference({"suffix": stamp.suffix(), "sources": 3}, tmp_path)
        == "has a stamp of another version"
    )
    assert stamp.read(tmp_path) is None and stamp.digest(tmp_path / "none") == ""
    (tmp_path / stamp.STAMP).write_text("{")
    assert stamp.read(tmp_path) is None
    (tmp_path / "a").write_text("abc")  # FIPS 180-2, appendix B.1
    assert stamp.digest(tmp_path / "a").startswith("ba7816bf8f01cfea")
