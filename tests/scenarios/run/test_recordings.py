"""Recordings for other tools: a run's frames in their formats, a run as MCAP, columns back from both."""

import json
import re
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest
from jsonschema import Draft202012Validator
from pyarrow import parquet

from calibration.errors import CalibrationInputError
from calibration.inputs.recordings import read_mcap, read_mf4
from scenarios import options as parts
from scenarios.commands import describing
from scenarios.lab.prepare import prepare
from scenarios.run import run as runner
from scenarios.run.mcapfile import Entry, Source, _of_summary, export

SCENARIO = """name: recorded
plant: low-preload-bridge
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
  - set_rate: {axis: ra, rate: 100 arcsec/s, for: 1 s}
faults:
  - node_off: {node: MOTOR_DEC_A}
    at: 1.5 s
    until: 2 s
"""
START_S = 1770732000.0
"""2026-02-10T14:00:00Z in seconds since 1970: `date -d 2026-02-10T14:00:00Z +%s`."""


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The same run with each kind of log."""
    found = {}
    for kind in ("text", "candump", "zstd", "mf4", "blf", "asc"):
        folder = tmp_path_factory.mktemp(kind)
        (folder / "s.yaml").write_text(SCENARIO + f"logs: {{can: {kind}}}\n")
        result = runner.run(
            *prepare(folder / "s.yaml"), folder / "out", lambda *_: None, runner.Way(report=False)
        )
        assert result.passed
        found[kind] = folder / "out"
    return found


def digest(folder: Path) -> str:
    return str(json.loads((folder / "summary.json").read_text())["trace_digest"])


@pytest.mark.parametrize("kind", ["mf4", "blf", "asc"])
def test_the_frames_are_those_of_the_text_log(folders: dict[str, Path], kind: str) -> None:
    with can.LogReader(str(folders["text"] / "can.log")) as log:
        plain = list(log)
    with can.LogReader(str(folders[kind] / f"can.{kind}")) as log:
        other = list(log)
    assert [(m.arbitration_id, bytes(m.data)) for m in other] == [
        (m.arbitration_id, bytes(m.data)) for m in plain
    ]
    late = np.array([m.timestamp for m in other]) - [m.timestamp for m in plain]
    # asc counts from its first frame, whose own time its head gives in whole milliseconds of local time
    assert np.ptp(late) < 1.1e-5 if kind == "blf" else np.ptp(late) < 2e-6
    if kind == "mf4":
        assert abs(late[0] - START_S) < 1e-3
    assert (folders[kind] / "can.log").read_bytes() == (folders["text"] / "can.log").read_bytes()


def test_the_digest_is_the_same_whatever_the_format(folders: dict[str, Path]) -> None:
    assert len({digest(folder) for folder in folders.values()}) == 1


def foxglove_takes(properties: dict[str, Any]) -> dict[str, Any]:
    """As its parser of JSON schemas reads them: one known type each, with what is in objects and arrays."""
    for name, one in properties.items():
        kind = one.get("type")
        if kind == "object":
            foxglove_takes(one["properties"])
        elif kind == "array":
            foxglove_takes({name: one["items"]})
            assert one["items"]["type"] != "array", name
        else:
            assert kind in ("boolean", "string", "number", "integer"), f"{name}: unsupported type {kind}"
    return properties


def messages(file: Path) -> dict[str, list[tuple[int, dict[str, Any]]]]:
    from mcap.reader import make_reader

    found: dict[str, list[tuple[int, dict[str, Any]]]] = {}
    checks: dict[int, Draft202012Validator] = {}
    with file.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            assert schema is not None
            assert schema.encoding == "jsonschema"
            content = json.loads(message.data)
            if schema.id not in checks:
                whole = json.loads(schema.data)
                foxglove_takes(whole["properties"])
                checks[schema.id] = Draft202012Validator(whole | {"additionalProperties": False})
            checks[schema.id].validate(content)
            found.setdefault(channel.topic, []).append((message.log_time, content))
    return found


def test_a_run_is_one_mcap_file(folders: dict[str, Path], tmp_path: Path) -> None:
    file = tmp_path / "night.mcap"
    count = export(folders["text"], file)
    found = messages(file)
    assert sum(map(len, found.values())) == count
    frames = Counter(m.arbitration_id for m in can.LogReader(str(folders["text"] / "can.log")))
    assert len(found["/can/AXIS_RA/MOTION"]) == frames[0x211]
    assert sum(len(each) for topic, each in found.items() if topic.startswith("/can/")) == sum(
        frames.values()
    )
    truth = parquet.read_table(folders["text"] / "truth-ra.parquet")
    assert [row["angle"] for _, row in found["/truth/ra"]] == truth["angle"].to_pylist()
    first = found["/truth/ra"][0]
    assert first[0] == round(START_S) * 1_000_000_000 + round(truth["t_s"][0].as_py() * 1e9)
    log = (folders["text"] / "axis-ra.csv").read_text().splitlines()
    assert len(found["/axis/ra"]) == sum(line[0].isdigit() for line in log)
    summary = json.loads((folders["text"] / "summary.json").read_text())
    assert [row for _, row in found["/verdicts"]] == summary["expectations"]
    assert [row["action"] for _, row in found["/steps"]] == ["power_on", "set_rate"]
    assert found["/commands"][0][1]["command"] == "PING"
    packed = tmp_path / "packed.mcap"
    assert export(folders["zstd"], packed) == count


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("truth-ra.parquet", b"no parquet"), ("can.log", b"\xff"), ("can.log", b"(0.1) can0\n"),
        ("commands.log", b"2026-02-10\n"),
        ("axis-ra.csv", b"t,setpoint\nx,1\n"), ("axis-dec.csv", b"a,b\n1,2\n"),
        *(("summary.json", {word: wrong}) for word in ("start_utc", "simulated_s", "steps", "faults")
          for wrong in ("x", [1])),
    ],
)  # fmt: skip
def test_a_file_that_no_run_has_left_so_is_named(
    folders: dict[str, Path], tmp_path: Path, name: str, text: bytes | dict[str, Any]
) -> None:
    folder = tmp_path / "run"
    shutil.copytree(folders["text"], folder)
    if isinstance(text, dict):
        text = json.dumps(json.loads((folder / name).read_text()) | text).encode()
    (folder / name).write_bytes(text)
    with pytest.raises(
        ValueError, match=re.escape(f"{folder / name}: is not as a run has left it")
    ) as caught:
        export(folder, tmp_path / "run.mcap")
    assert "\n" not in str(caught.value)
    assert not re.search(r"Error|char \d|literal|object", str(caught.value)), "Python's words"


def test_a_fault_stands_where_it_first_acted() -> None:
    acted = {"name": "node_off", "at_s": 1.0, "first_s": 1.5, "on": "frame 334#34"}
    never = {"name": "node_off", "at_s": 2.0, "first_s": None, "on": ""}
    summary = {"simulated_s": 3.0, "steps": [], "expectations": [], "faults": [never, acted]}
    faults = list(_of_summary(summary)[1])
    source = Source("/faults", faults[0].source.properties)
    assert set(acted) <= set(source.properties)
    assert faults == [Entry(1_500_000_000, source, acted), Entry(2_000_000_000, source, never)]


def test_arguments_of_a_fault_are_json_as_each_kind_has_its_own() -> None:
    given = {"node": ["FOCUS", "TEMP"], "level": 0.5}
    fault = {"name": "a", "arguments": given, "at_s": 0, "first_s": None}
    (entry,) = _of_summary({"simulated_s": 3.0, "faults": [fault]})[1]
    assert foxglove_takes(entry.source.properties)["arguments"] == {"type": "string"}
    assert json.loads(entry.values["arguments"]) == given


def test_columns_come_back_from_mcap(folders: dict[str, Path], tmp_path: Path) -> None:
    file = tmp_path / "night.mcap"
    export(folders["text"], file)
    wanted = ["time", "/axis/ra.position", "/axis/ra.t", "/can/AXIS_RA/MOTION.Velocity"]
    (got,) = read_mcap(file, wanted)
    rows = [line.split(",") for line in (folders["text"] / "axis-ra.csv").read_text().splitlines()]
    numbers = np.array([[float(row[0]), float(row[3])] for row in rows if row[0][0].isdigit()])
    np.testing.assert_array_equal(got["/axis/ra.position"], numbers[:, 1])
    np.testing.assert_allclose(got["time"], numbers[:, 0] - numbers[0, 0], atol=1e-9)
    found = messages(file)
    motion = [(at, row["Velocity"]) for at, row in found["/can/AXIS_RA/MOTION"]]
    held = [[v for at, v in motion if at <= row_at][-1:] or [np.nan] for row_at, _ in found["/axis/ra"]]
    assert len({v for (v,) in held}) > 10
    np.testing.assert_array_equal(got["/can/AXIS_RA/MOTION.Velocity"], np.ravel(held))
    with pytest.raises(CalibrationInputError, match=r"/axis/ra.speed.*is not in the file"):
        read_mcap(file, ["/axis/ra.speed"])
    (tmp_path / "none.mcap").write_bytes(b"not one")
    with pytest.raises(CalibrationInputError, match="no MCAP file"):
        read_mcap(tmp_path / "none.mcap", wanted)


def test_columns_come_back_from_mf4(tmp_path: Path) -> None:
    from asammdf import MDF, Signal

    t = np.arange(0.0, 2.0, 0.01)
    fast = Signal(np.sin(t), t, name="angle")
    slow = Signal(np.arange(20.0), np.arange(20) * 0.1 + 0.005, name="torque")
    with MDF() as made:
        made.append([fast])
        made.append([slow])
        made.save(tmp_path / "rig.mf4")
    (got,) = read_mf4(tmp_path / "rig.mf4", ["time", "angle", "torque"])
    np.testing.assert_array_equal(got["time"], t)
    np.testing.assert_array_equal(got["angle"], np.sin(t))
    assert np.isnan(got["torque"][0])
    assert got["torque"][[1, 10, 11]].tolist() == [0.0, 0.0, 1.0]
    with pytest.raises(CalibrationInputError, match=r"speed.*is not in the file, which has angle, torque"):
        read_mf4(tmp_path / "rig.mf4", ["speed"])
    (tmp_path / "none.mf4").write_bytes(b"not one")
    with pytest.raises(CalibrationInputError, match="no MDF file"):
        read_mf4(tmp_path / "none.mf4", ["angle"])


def test_a_part_that_is_missing_is_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    real = parts.find_spec
    monkeypatch.setattr(parts, "find_spec", lambda name: None if name in ("mcap", "llvmlite") else real(name))
    for command, arguments, extra in (
        (describing.export, [str(tmp_path), "--mcap", "x.mcap"], "recordings"),
        (describing.fmu, ["--axis", "ra", "--out", "x.fmu"], "fmu"),
    ):
        with pytest.raises(ValueError, match=rf"extra {extra}\); .* -m pip install"):
            command.main(arguments, standalone_mode=False)
    assert "(extra recordings)" in parts.advice("asammdf")  # calibrate's reader imports it when it is asked
