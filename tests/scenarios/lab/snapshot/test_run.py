"""Whole runs: on from a snapshot, every file and the digest are those of the run that was not interrupted."""

import os
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios.lab.snapshot.file import read
from scenarios.lab.snapshot.freeze import SnapshotError
from scenarios.lab.snapshot.run import Order
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.plants import plant_model
from scenarios.run import run as runner
from tests.scenarios.conftest import ROOT, SHORT, Command

FAULTS = """
faults:
  - bit_errors: {probability: 2 %}
    at: 300 ms
    until: 900 ms
  - sensor_noise: {sensor: ra.incremental, deviation: 2}
    at: 600 ms
    until: 1.3 s
  - hang: {node: DISPLAY}
    at: 500 ms
    until: 1 s
  - reset: {node: FOCUS, every: 700 ms}
    at: 200 ms
  - emergency_stop: {}
    at: 1.2 s
    until: 1.6 s
"""


def nothing(*_: object) -> None:
    pass


def first(folder: Path, at_s: float) -> tuple[runner.Result, Path]:
    scenario = convert(parse(SHORT + FAULTS, folder / "short.yaml"))
    model = plant_model(scenario.plant, folder)
    order = Order(round(at_s * 1e9), folder / "a.snapshot")
    way = runner.Way(report=False, snapshot=order)
    return runner.run(scenario, model, folder / "one", nothing, way), order.file


def again(file: Path, folder: Path, order: Order | None = None) -> runner.Result:
    whole = read(file)
    scenario, model = whole["scenario"], whole["model"]
    way = runner.Way(report=False, begun=whole, snapshot=order)
    return runner.run(scenario, model, folder, nothing, way)


def same_files(one: Path, two: Path) -> None:
    names = {path.name for path in one.iterdir() if path.suffix in (".log", ".csv")}
    assert len(names) == 7
    for name in names:
        assert (one / name).read_bytes() == (two / name).read_bytes(), name


@pytest.mark.slow
@settings(max_examples=6, deadline=None)
@given(st.floats(0.0, 2.9))
def test_on_from_a_snapshot_is_the_whole_run(at_s: float) -> None:
    """At any instant: programme, faults that are on or to come, frames on the bus, files half written."""
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as name:
        folder = Path(name)
        result, file = first(folder, at_s)
        resumed = again(file, folder / "two")
        assert resumed.summary["trace_digest"] == result.summary["trace_digest"]
        same_files(folder / "one", folder / "two")
        for key in ("frames", "frame_errors", "overruns", "dropped", "simulated_s", "steps", "bus_load"):
            assert resumed.summary[key] == result.summary[key]


def test_a_snapshot_of_a_run_that_began_with_one(tmp_path: Path) -> None:
    result, file = first(tmp_path, 0.7)
    order = Order(1_500_000_000, tmp_path / "b.snapshot")
    again(file, tmp_path / "two", order)
    last = again(order.file, tmp_path / "three")
    assert last.summary["trace_digest"] == result.summary["trace_digest"]
    same_files(tmp_path / "one", tmp_path / "three")


def test_no_snapshot_is_taken_of_what_is_over(tmp_path: Path) -> None:
    _, file = first(tmp_path, 0.7)
    with pytest.raises(SnapshotError, match=r"a snapshot at 0\.1 s: the run is at 0\.7 s already"):
        again(file, tmp_path / "two", Order(100_000_000, tmp_path / "b.snapshot"))
    assert not (tmp_path / "b.snapshot").exists()


def test_the_command(schmidt: Command, short: Path, tmp_path: Path) -> None:
    one = schmidt("run", short, "--out", tmp_path / "one", "--no-report", "--snapshot-at", "1.234")
    assert one.returncode == 0, one.stderr
    two = schmidt("run", "--from", tmp_path / "one/snapshot", "--out", tmp_path / "two", "--no-report")
    assert two.returncode == 0, two.stderr
    same_files(tmp_path / "one", tmp_path / "two")
    digests = {text.split("digest ")[1][:16] for text in (one.stdout, two.stdout)}
    assert len(digests) == 1


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--from", "nowhere.snapshot"], "No such file"),
        (["--from", "short.yaml"], "no snapshot"),
        (["--from", "nowhere.snapshot", "--seed", "2"], "nothing else"),
        ([], "Missing argument"),
        (["short.yaml", "--snapshot", "s"], "needs --snapshot-at"),
        (["short.yaml", "--snapshot-at", "1000", "--no-report"], "no snapshot"),
        (
            ["short.yaml", "--snapshot-at", "1", "--snapshot", "."],
            ".: cannot be written: it is no regular file",
        ),
        (
            ["short.yaml", "--snapshot-at", "1", "--snapshot", "pipe"],
            "pipe: cannot be written: it is no regular",
        ),
    ],
)
def test_what_cannot_be_is_one_line(schmidt: Command, short: Path, words: list[str], reason: str) -> None:
    if "pipe" in words:
        os.mkfifo(short.parent / "pipe")
    done = schmidt("run", *words)
    assert done.returncode == 2
    assert reason in done.stderr
    assert "Traceback" not in done.stderr
    assert "pipe" not in words or (short.parent / "pipe").is_fifo()  # nothing stands in its place


def test_a_damaged_file_is_refused(tmp_path: Path) -> None:
    _, file = first(tmp_path, 0.5)
    data = file.read_bytes()
    for wrong in (data[: len(data) // 2], data[1:], b""):
        file.write_bytes(wrong)
        with pytest.raises(SnapshotError, match=r"a\.snapshot: "):
            read(file)


@pytest.mark.slow
def test_a_board_of_ones_own_is_in_it_while_its_file_stays(tmp_path: Path, schmidt_process: Command) -> None:
    """The page's example; the class comes from the file, whose digest the snapshot carries."""
    blocks = re.findall(r"```\w+\n(.*?)```", (ROOT / "docs" / "guides" / "new-board.md").read_text(), re.S)
    for name, text in zip(("mirror.dbc", "mirror.py", "mirror.yaml"), blocks, strict=False):
        (tmp_path / name).write_text(text)
    file, one = tmp_path / "mirror.yaml", tmp_path / "one"
    first = schmidt_process("run", file, "--out", one, "--no-report", "--snapshot-at", "1.1")
    again = schmidt_process("run", "--from", one / "snapshot", "--out", tmp_path / "two", "--no-report")
    assert again.returncode == 0, first.stderr + again.stderr
    same_files(one, tmp_path / "two")
    (tmp_path / "mirror.py").write_text(blocks[1].replace("heater = 0", "heater = 1"))
    refused = schmidt_process("run", "--from", one / "snapshot", "--out", tmp_path / "three", "--no-report")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "mirror.py has changed" in refused.stderr
