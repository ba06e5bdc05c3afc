"""Commands that say what is there: what they print, what they need and what they hand on."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result

from boards.canopen.dictionary import type_of
from bus.conformance import Settings
from plant.effects import REGISTRY
from scenarios.commands import describing
from scenarios.lab import wiring

pytest.importorskip("canopen.objectdictionary.eds")


def call(command: Any, *words: object) -> Result:
    return CliRunner().invoke(command, [str(each) for each in words])


def test_the_checks_get_what_the_words_say(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def command(*given: Any) -> int:
        asked[:] = given
        return 7

    monkeypatch.setitem(sys.modules, "scenarios.commands.checking", SimpleNamespace(command=command))
    assert call(describing.conformance).exit_code == 7
    assert asked == [None, None, (), Settings(), None, None]  # motion and flood have to be asked for
    words = (
        "s.yaml --can socketcan:can0 --json f.json --board axis:0x11 --motion --flood --canopen "
        "--speed 2 --tolerance 1 --stamps 0 --network serial"
    )
    call(describing.conformance, *words.split())
    settings = Settings(motion=True, flood=True, canopen=True, speed=2.0, period_tolerance=1.0, stamps_s=0.0)
    expected = ["socketcan:can0", Path("f.json"), ("axis:0x11",), settings, Path("s.yaml"), "serial"]
    assert asked == expected


@pytest.mark.parametrize("words", [("--tolerance", "0"), ("--tolerance", "1.01"), ("--stamps", "-0.1")])
def test_tolerances_have_bounds(words: tuple[str, ...]) -> None:
    done = call(describing.conformance, *words)
    assert done.exit_code == 2 and "is not in the range" in done.output


def test_a_data_sheet_is_written_per_type_of_board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """CiA 306: a section FileInfo with the file's name, and the objects."""
    monkeypatch.setattr("boards.canopen.canopen_dbc", lambda devices: f"dbc of {len(devices)}")
    done = call(describing.eds, tmp_path, "--network", "serial")
    assert done.exit_code == 0
    files = [Path(line) for line in done.output.splitlines()]
    names = [file.name for file in files]
    kinds = {type_of(board)[0].lower() for board in wiring.network(network_name="serial").boards.values()}
    assert names == [*(f"{kind}.eds" for kind in sorted(kinds)), "canopen.dbc"]
    assert sorted(tmp_path.iterdir()) == sorted(files)
    text = (tmp_path / "axis.eds").read_text()
    assert "FileName=axis.eds" in text and "[1000]" in text and "CreationDate=01-01-2026" in text
    assert files[-1].read_text() == "dbc of 5"


def test_the_protocol_is_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bus.protocol.page.page", lambda: "the page")
    assert call(describing.protocol).output == "the page\n"


@pytest.mark.parametrize("name", ["gear_mesh", next(k for k, v in REGISTRY.items() if v.stages)])
def test_an_effect_is_described(name: str) -> None:
    effect = REGISTRY[name]
    first, second, *rest = call(describing.effects, name).output.splitlines()
    assert first == f"{name}: {effect.equation}"
    assert second == f"channel {effect.channel}, seen over {effect.domain}"
    assert [line for line in rest if line.startswith("stages: ")] == (
        [f"stages: {', '.join(effect.stages)}"] if effect.stages else []
    )
    assert len([line for line in rest if line.startswith("  ")]) == len(effect.parameters)


def test_effects_are_listed_by_name_channel_and_domain() -> None:
    lines = call(describing.effects).output.splitlines()
    assert [line.split()[:2] for line in lines] == [[each.name, each.channel] for each in REGISTRY.values()]
    assert all(line.endswith(each.equation) for line, each in zip(lines, REGISTRY.values(), strict=True))


@pytest.fixture
def needed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    found: list[str] = []
    monkeypatch.setattr(describing, "need", lambda *extras: found.extend(extras))
    return found


def test_an_fmu_is_told(needed: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def write(model: Any, *given: Any) -> Any:
        asked[:] = given
        parameters = [SimpleNamespace(name=name) for name in ("a", "", "b")]
        return SimpleNamespace(model=model, parameters=parameters, switchable=["x", ""])

    monkeypatch.setitem(sys.modules, "plant.fmu", SimpleNamespace(write=write))
    done = call(describing.fmu, "--axis", "dec", "--out", "d.fmu", "--plant", "low-preload")
    assert done.output.startswith("d.fmu: FMI 3.0, axis dec of ")
    assert done.output.endswith(", 2 parameters, effects to switch: 1\n")
    assert (asked, needed) == (["dec", 1, Path("d.fmu"), 3], ["fmu"])
    call(describing.fmu, "--axis", "ra", "--out", "d.fmu", "--seed", 5, "--fmi", 2)
    assert asked == ["ra", 5, Path("d.fmu"), 2]


def test_a_run_is_exported(needed: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    made = SimpleNamespace(export=lambda folder, file: f"{folder} {file} 12")
    monkeypatch.setitem(sys.modules, "scenarios.run.mcapfile", made)
    done = call(describing.export, "run", "--mcap", "out.mcap")
    assert done.output == "out.mcap: run out.mcap 12 messages\n" and needed == ["recordings", "parquet"]


@pytest.mark.parametrize(("command", "words", "missing"), [
    (describing.fmu, ("--axis", "ra"), "--out"), (describing.fmu, ("--out", "x"), "--axis"),
    (describing.export, ("run",), "--mcap"), (describing.eds, (), "FOLDER"),
])  # fmt: skip
def test_what_is_written_needs_a_place(command: Any, words: tuple[str, ...], missing: str) -> None:
    done = call(command, *words)
    assert done.exit_code == 2 and "Missing " in done.output and missing in done.output
