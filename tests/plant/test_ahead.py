"""The kernel compiled beforehand: the just-in-time one to the bit, and never of another source."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from plant import ahead, builder, compiled
from plant.model import load
from plant.plant import Plant

STEPS = (1, 10, 0, 7, 200, 3000)


def test_an_edited_source_has_another_library(tmp_path: Path) -> None:
    room = tmp_path / "plant"
    shutil.copytree(ahead.ROOM, room, ignore=shutil.ignore_patterns("library", "__pycache__"))
    assert ahead.fingerprint(room) == ahead.fingerprint()
    step = room / "kernels" / "step.py"
    step.write_text(step.read_text() + "# changed\n")
    assert ahead.fingerprint(room) != ahead.fingerprint()


def test_without_a_library_there_is_no_kernel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ahead, "LIBRARY", tmp_path)
    ahead._library.cache_clear()
    try:
        assert ahead.find("advance") is None
        assert ahead.find("control_loop") is None
    finally:
        ahead._library.cache_clear()


def test_what_cannot_be_built_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ahead, "LIBRARY", tmp_path / "library")

    def fail(_: Path) -> Path:
        raise OSError("no compiler")

    monkeypatch.setattr(builder, "_compile", fail)
    with pytest.raises(builder.AheadError, match="OSError: no compiler"):
        builder.build()
    assert not (tmp_path / "library").exists()


def test_a_new_library_takes_the_place_of_old_ones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its folder may have to be made; what else lies there stays."""
    folder = tmp_path / "some" / "library"
    monkeypatch.setattr(ahead, "LIBRARY", folder)

    def compiled_into(place: Path) -> Path:
        made = place / "any.so"
        made.write_bytes(b"code")
        return made

    monkeypatch.setattr(builder, "_compile", compiled_into)
    assert builder.build()
    assert not builder.build(), "nothing to do the second time"
    assert [each.read_bytes() for each in folder.iterdir()] == [b"code"]
    ahead.file().rename(folder / f"{ahead.NAME}-old.so")
    (folder / "other.txt").touch()
    assert builder.build()
    assert {each.name for each in folder.iterdir()} == {ahead.file().name, "other.txt"}


@pytest.mark.slow
def test_it_is_the_just_in_time_kernel_to_the_bit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ahead, "LIBRARY", tmp_path / "library")
    ahead._library.cache_clear()
    try:
        assert builder.build()
        assert not builder.build(), "nothing to do the second time"
        before = ahead.find("advance")
    finally:
        ahead._library.cache_clear()
    assert before is not None
    just_in_time = compiled._njit(compiled.KERNELS["advance"], _nrt=False)
    plant = Plant(load(), 1)
    plant.ra.drive(0, 0.4, 0.1)
    plant.dec.drive(0, 0.05, 0.3)
    one, other = plant.world.copy(), plant.world.copy()
    for steps in STEPS:
        before(one, steps)
        just_in_time(other, steps)
        assert one.tobytes() == other.tobytes()
    assert not np.array_equal(one, plant.world), "it moved"
