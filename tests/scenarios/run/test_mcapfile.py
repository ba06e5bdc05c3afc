"""A small run made by hand, message by message, as MCAP has it."""

import json
import re
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from mcap.reader import make_reader

from host.logs.traces import Trace
from scenarios.run import mcapfile

START_S = 1_770_732_000
"""2026-02-10T14:00:00Z in seconds since 1970: `date -d 2026-02-10T14:00:00Z +%s`."""
LATE_S = 9_000.0
"""Far enough for a millionth of a time to show."""
SUMMARY: dict[str, Any] = {
    "scenario": "by hand", "seed": 7, "plant": "bare", "trace_digest": "abc", "simulated_s": 9_001.0,
    "start_utc": "2026-02-10T14:00:00.250Z",
    "steps": [{"name": "up", "action": "power_on", "start_s": 1.5, "end_s": 2.5, "failed": ""}],
    "faults": [{"name": "stuck", "at_s": 4.0, "first_s": None, "arguments": {"level": 3}, "on": ""}],
    "expectations": [{"name": "few", "passed": True, "value": 2, "limit": 3, "unit": "steps"}],
}  # fmt: skip
CANDUMP = """\
(0.000010) can0 211#1100000005000000
(0.000020) can0 211#R
(0.000030) can0 6A5#0102
(0.000040) can0 211#11
(0.000050) can0 00000211#1100000005000000
(0.000060) can0 091#11FF000000000000
(9000.123456) can0 211#1100000005000000
"""


class Told(NamedTuple):
    at_ns: int
    topic: str
    values: dict[str, Any]


def made(folder: Path) -> Path:
    """A run's folder. Its traces have times that doubles do not hold exactly."""
    (folder / "summary.json").write_text(json.dumps(SUMMARY))
    (folder / "can.log").write_text(CANDUMP)
    (folder / "commands.log").write_text(
        "# utc  t_s  node\n2026-02-10T14:00:01.250Z  1.0  AXIS_RA  PING  ok  after  two tries\n"
        f"2026-02-10T16:30:00.250Z  {LATE_S}  DOME  STOP\n"
    )
    (folder / "errors.log").write_text("")
    (folder / "axis-ra.csv").write_text(
        f"# format: axis-log 1\nt,setpoint,velocity\n,1,6\n1.5,nan,7\n{LATE_S},15.5,8\n"
    )
    trace = Trace(folder / "truth-ra.parquet", ("t_s", "angle", "rate"), {})
    trace.append(np.array([[0.0, 1.0, 2.0], [LATE_S, 3.0, np.inf]]))
    trace.close()
    return folder


def exported(folder: Path) -> tuple[list[Told], dict[str, Any], dict[str, str]]:
    """Messages, schemas by topic, and what is said of the run."""
    file = folder / "run.mcap"
    count = mcapfile.export(folder, file)
    told, schemas = [], {}
    with file.open("rb") as stream:
        reader = make_reader(stream)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None and schema.name == channel.topic
            assert message.publish_time == message.log_time
            schemas[channel.topic] = json.loads(schema.data)
            told.append(Told(message.log_time, channel.topic, json.loads(message.data)))
        assert reader.get_header().library == "schmidt"
        about = next(reader.iter_metadata()).metadata
    assert count == len(told)
    return told, schemas, about


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Told], dict[str, Any], dict[str, str]]:
    return exported(made(tmp_path_factory.mktemp("whole")))


def after(seconds: float) -> int:
    """UTC in ns at a simulated time; the run began a quarter of a second late."""
    return START_S * 10**9 + round((seconds + 0.25) * 1e6) * 1000


Whole = tuple[list[Told], dict[str, Any], dict[str, str]]


def of(whole: Whole, topic: str) -> list[tuple[int, dict[str, Any]]]:
    return [(each.at_ns, each.values) for each in whole[0] if each.topic == topic]


def test_messages_stand_in_the_order_of_time_and_the_run_is_named(whole: Whole) -> None:
    times = [each.at_ns for each in whole[0]]
    assert times == sorted(times)
    assert whole[2] == {"scenario": "by hand", "seed": "7", "plant": "bare", "trace_digest": "abc"}


def test_a_frame_has_its_signals_and_its_units(whole: Whole) -> None:
    rows = of(whole, "/can/AXIS_RA/MOTION")
    assert [at_ns for at_ns, _ in rows] == [after(0.00001), after(9000.123456)]
    assert {row["Device"] for _, row in rows} == {0x11}
    fields = whole[1]["/can/AXIS_RA/MOTION"]["properties"]
    assert fields["Device"] == {"type": "number"}
    assert fields["Velocity"] == {"type": "number", "description": "unit counts/5ms"}


def test_frames_that_say_nothing_known_are_bytes(whole: Whole) -> None:
    """A remote frame, one that nobody has, one that is too short, an extended one, an opcode that is none."""
    assert of(whole, "/can/other") == [
        (after(0.00002), {"identifier": "211", "data": ""}),
        (after(0.00003), {"identifier": "6A5", "data": "0102"}),
        (after(0.00004), {"identifier": "211", "data": "11"}),
        (after(0.00005), {"identifier": "211", "data": "1100000005000000"}),
        (after(0.00006), {"identifier": "91", "data": "11ff000000000000"}),
    ]
    assert whole[1]["/can/other"]["properties"] == {
        name: {"type": "string"} for name in ("identifier", "data")
    }


def test_rows_of_logs_and_traces_keep_what_is_a_number(whole: Whole) -> None:
    assert of(whole, "/axis/ra") == [
        (after(0.0), {"setpoint": 1.0, "velocity": 6.0}),  # without a time
        (after(1.5), {"t": 1.5, "velocity": 7.0}),
        (after(LATE_S), {"t": LATE_S, "setpoint": 15.5, "velocity": 8.0}),
    ]
    assert of(whole, "/truth/ra") == [
        (after(0.0), {"t_s": 0.0, "angle": 1.0, "rate": 2.0}),
        (after(LATE_S), {"t_s": LATE_S, "angle": 3.0}),
    ]


def test_lines_of_a_text_log_are_fields_the_last_of_which_may_have_blanks(whole: Whole) -> None:
    first, last = of(whole, "/commands")
    assert first == (
        after(1.0),
        {
            "utc": "2026-02-10T14:00:01.250Z", "t_s": 1.0, "node": "AXIS_RA", "command": "PING",
            "result": "ok  after  two tries",
        },
    )  # fmt: skip
    assert (last[0], last[1]["command"], "result" in last[1]) == (after(LATE_S), "STOP", False)
    fields = whole[1]["/commands"]["properties"]
    assert (fields["t_s"], fields["node"]) == ({"type": "number"}, {"type": "string"})
    assert whole[1]["/commands"]["type"] == "object"
    assert of(whole, "/errors") == []


def test_the_summary_stands_where_it_belongs_in_time(whole: Whole) -> None:
    steps, faults, verdicts = (of(whole, f"/{topic}") for topic in ("steps", "faults", "verdicts"))
    assert steps == [(after(1.5), SUMMARY["steps"][0])]
    assert faults == [(after(4.0), {"name": "stuck", "at_s": 4.0, "arguments": '{"level": 3}', "on": ""})]
    assert verdicts == [(after(9001.0), SUMMARY["expectations"][0])]


def test_a_log_is_read_once_packed_or_not(tmp_path: Path) -> None:
    made(tmp_path)
    (tmp_path / "can.log.zst").write_bytes(b"not looked at")
    told, _, _ = exported(tmp_path)
    assert sum(each.topic.startswith("/can/") for each in told) == 7


@pytest.mark.parametrize(("name", "words"), [
    ("can.log", ": is a directory"), ("commands.log", ": is a directory"),
])  # fmt: skip
def test_a_file_that_cannot_be_read_says_why(name: str, words: str, tmp_path: Path) -> None:
    path = made(tmp_path) / name
    path.unlink()
    path.mkdir()
    with pytest.raises(ValueError, match=f"^{re.escape(f'{path}: is not as a run has left it{words}')}$"):
        mcapfile.export(tmp_path, tmp_path / "run.mcap")


@pytest.mark.parametrize("word", ["start_utc", "seed", "simulated_s"])
def test_what_a_summary_lacks_is_named(word: str, tmp_path: Path) -> None:
    path = made(tmp_path) / "summary.json"
    path.write_text(json.dumps({name: each for name, each in SUMMARY.items() if name != word}))
    words = f"{path}: is not as a run has left it: '{word}' is missing"
    with pytest.raises(ValueError, match=f"^{re.escape(words)}$"):
        mcapfile.export(tmp_path, tmp_path / "run.mcap")


def test_what_is_wrong_otherwise_has_no_reason_of_pythons(tmp_path: Path) -> None:
    path = made(tmp_path) / "commands.log"
    path.write_text("2026-02-10  x  DOME  STOP  ok\n")
    with pytest.raises(ValueError, match=r"commands\.log: is not as a run has left it$"):
        mcapfile.export(tmp_path, tmp_path / "run.mcap")


@pytest.mark.parametrize(("text", "words"), [
    ("", ":1: is not JSON, as a run leaves it"), ('{"a": 1,\n!', ":2: is not JSON, as a run leaves it"),
])  # fmt: skip
def test_a_summary_that_is_no_json_is_named_with_its_line(text: str, words: str, tmp_path: Path) -> None:
    path = made(tmp_path) / "summary.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=f"^{re.escape(f'{path}{words}')}$"):
        mcapfile.summary_of(tmp_path)


def test_a_summary_that_is_no_text_is_named(tmp_path: Path) -> None:
    path = made(tmp_path) / "summary.json"
    path.write_bytes(b"\xff")
    with pytest.raises(ValueError, match=f"^{re.escape(f'{path}: ')}"):
        mcapfile.summary_of(tmp_path)


def test_a_folder_of_something_else_is_said_to_be_none(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no summary.json: give the output folder of schmidt run$"):
        mcapfile.summary_of(tmp_path)


def test_a_file_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No such file or directory") as caught:
        mcapfile.export(made(tmp_path), tmp_path / "none" / "run.mcap")
    assert caught.value.filename == str(tmp_path / "none" / "run.mcap")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux' full disk")
def test_a_disk_that_is_full_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space left") as caught:
        mcapfile.export(made(tmp_path), Path("/dev/full"))
    assert caught.value.filename == "/dev/full"


def test_sources_are_closed_with_the_files(tmp_path: Path) -> None:
    folder = made(tmp_path)
    with ExitStack() as files:
        sources = mcapfile.sources(folder, SUMMARY, files)
        firsts = [next(each, None) for each in sources]
        assert [first.source.topic if first else "" for first in firsts] == [
            "/can/AXIS_RA/MOTION", "/axis/ra", "/truth/ra", "/commands", "", "/steps", "/faults", "/verdicts",
        ]  # fmt: skip
    assert [next(each, None) for each in sources[:4]] == [None] * 4
