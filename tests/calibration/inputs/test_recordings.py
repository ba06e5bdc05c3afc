"""Columns out of MF4 and MCAP files that are made here: rows of the first column, others as last seen."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.recordings import RECORDINGS, read_mcap, read_mf4

NAN = float("nan")


def mcap(path: Path, messages: list[tuple[str, float, Any]], encoding: str = "json") -> Path:
    """A file of (topic, s since 2026, content) in that order."""
    writer_of = pytest.importorskip("mcap.writer")
    with path.open("wb") as stream:
        writer = writer_of.Writer(stream)
        writer.start()
        channels: dict[str, int] = {}
        for topic, second, content in messages:
            if topic not in channels:
                channels[topic] = writer.register_channel(topic, encoding, 0)
            stamp = 1_767_225_600_000_000_000 + round(second * 1e9)
            writer.add_message(channels[topic], stamp, json.dumps(content).encode(), stamp)
        writer.finish()
    return path


def told(path: Path, wanted: list[str]) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        RECORDINGS[path.suffix](path, wanted)
    return str(caught.value)


MESSAGES: list[tuple[str, float, Any]] = [
    ("/other", 0.0, {"x": 1}),
    ("/drive", 1.0, {"angle": 0.5, "motor": {"amps": 2}}),
    ("/slow", 1.5, {"volts": 24.0}),
    ("/drive", 2.0, {"angle": 0.75, "motor": {"amps": 3}}),
    ("/drive", 3.0, {"angle": 1.25, "motor": {"amps": -1}}),
    ("/slow", 3.0, {"volts": 23.5}),
    ("/drive", 4.0, {"angle": 2.0, "motor": {"amps": 0}}),
]


def test_fields_of_one_topic_are_rows_and_a_slower_one_is_held(tmp_path: Path) -> None:
    file = mcap(tmp_path / "a.mcap", MESSAGES)
    (columns,) = read_mcap(file, ["time", "/drive.angle", "/drive.motor.amps", "/slow.volts"])
    assert list(columns) == ["time", "/drive.angle", "/drive.motor.amps", "/slow.volts"]
    assert columns["time"] == pytest.approx([0.0, 1.0, 2.0, 3.0])
    assert columns["/drive.angle"].tolist() == [0.5, 0.75, 1.25, 2.0]
    assert columns["/drive.motor.amps"].tolist() == [2.0, 3.0, -1.0, 0.0]
    assert np.array_equal(columns["/slow.volts"], [NAN, 24.0, 23.5, 23.5], equal_nan=True)


def test_rows_are_those_of_the_first_column(tmp_path: Path) -> None:
    (columns,) = read_mcap(mcap(tmp_path / "a.mcap", MESSAGES), ["/slow.volts", "/drive.angle", "time"])
    assert columns["time"] == pytest.approx([0.0, 1.5])
    assert columns["/drive.angle"].tolist() == [0.5, 1.25]


def test_a_field_that_is_missing_in_a_message_is_held(tmp_path: Path) -> None:
    rows: list[tuple[str, float, Any]] = [
        ("/a", 0.0, {"x": 1, "y": 5}), ("/a", 1.0, {"x": 2}), ("/a", 2.0, {"x": 3, "y": "high"}),
        ("/a", 3.0, {"x": 4, "y": 6}),
    ]  # fmt: skip
    (columns,) = read_mcap(mcap(tmp_path / "a.mcap", rows), ["/a.x", "/a.y"])
    assert columns["/a.y"].tolist() == [5.0, 5.0, 5.0, 6.0]


def test_what_is_not_there_is_said_with_what_is(tmp_path: Path) -> None:
    file = mcap(tmp_path / "a.mcap", MESSAGES)
    text = told(file, ["time", "/drive.angle", "/drive.speed"])
    assert "/drive.speed" in text and "is not in the file, which has /drive, /other, /slow" in text
    assert "needs a column beside time" in told(file, ["time"])
    many = mcap(tmp_path / "b.mcap", [(f"/t{k:02}", 0.0, {"x": 1}) for k in range(25)])
    assert "/t19" in told(many, ["/x.y"]) and "/t20" not in told(many, ["/x.y"])  # twenty are enough
    packed = mcap(tmp_path / "c.mcap", MESSAGES, "protobuf")
    assert "is not in the file" in told(packed, ["/drive.angle"])


def test_what_is_broken_is_one_line(tmp_path: Path) -> None:
    for name, words in (("a.mcap", "is no MCAP file"), ("a.mf4", "is no MDF file")):
        (tmp_path / name).write_bytes(b"nothing of the kind" * 20)
        assert words in told(tmp_path / name, ["x"]) and "\n" not in told(tmp_path / name, ["x"])


def test_channels_of_an_mdf_file_have_the_rows_of_the_first(tmp_path: Path) -> None:
    asammdf = pytest.importorskip("asammdf")
    t, slow = np.array([10.0, 10.5, 11.0, 11.5]), np.array([10.5, 11.5])
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array([1.0, 2.0, 4.0, 8.0]), t, name="angle")])
        file.append([asammdf.Signal(np.array([24.0, 23.0]), slow, name="volts")])
        file.append([asammdf.Signal(np.array([9.0, 9.0]), slow, name="angle")])  # of several the first
        file.save(tmp_path / "a.mf4", overwrite=True)
    (columns,) = read_mf4(tmp_path / "a.mf4", ["time", "angle", "volts"])
    assert columns["time"].tolist() == [0.0, 0.5, 1.0, 1.5]
    assert columns["angle"].tolist() == [1.0, 2.0, 4.0, 8.0]
    assert np.array_equal(columns["volts"], [NAN, 24.0, 24.0, 23.0], equal_nan=True)
    assert "which has angle, volts" in told(tmp_path / "a.mf4", ["speed"])
