"""Logs: the axis log's format to the letter, the four ASCII logs, traces, log effects, full disks."""

import itertools
import os
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.protocol import Device
from bus.protocol.serial import NO_SETPOINT, AxisSample, Packet
from host.logs import distort, traces
from host.logs.axis import AxisLog
from host.logs.files import LineFile, LogError, check_space
from host.logs.journal import AsciiLogs

HEADER = {"axis": "ra", "session": "night", "loop": "closed", "start_utc": "2026-02-10T14:00:00Z"}
RANDOM = np.random.default_rng(1)
SAMPLE = AxisSample(-12, 268435456, 7, 100, 20, 5, -5, 77, round(6.533333 * 65536))


def packet(stamp: int, sample: AxisSample = SAMPLE, sequence: int = 0) -> Packet:
    return Packet(Device.AXIS_RA, sequence, stamp, (sample,) * 25)


def test_axis_log_is_version_1_to_the_letter(tmp_path: Path) -> None:
    """log-format.md: header keys, column names and order, one row per sample, 10 ms apart."""
    log = AxisLog(
        tmp_path / "ra.csv", {**HEADER, "preload": "low", "counter_torque": "0.10", "supply_V": "24"}
    )
    log.packet(0, packet(5000))
    log.file.close()
    lines = (tmp_path / "ra.csv").read_text().splitlines()
    header = dict(line[2:].split(": ", 1) for line in lines if line.startswith("#"))
    assert header == {
        "format": "axis-log 1", "axis": "ra", "sample_period_s": "0.010", "session": "night",
        "loop": "closed",
        "start_utc": "2026-02-10T14:00:00Z", "preload": "low", "counter_torque": "0.10", "supply_V": "24",
    }  # fmt: skip
    rows = [line.split(",") for line in lines if not line.startswith("#")]
    assert ",".join(rows[0]) == "t,setpoint,effort,position,velocity,adc_a,adc_b,tach_a,tach_b,aux"
    assert len(rows) == 26
    assert [float(row[0]) for row in rows[1:3]] == pytest.approx([0.5, 0.51])
    assert float(rows[1][1]) == pytest.approx(15.0, abs=1e-4)  # 6.5333 counts per 5 ms (hardware.md 2.1)
    assert rows[1][2:] == ["-12", "268435456", "7", "100", "20", "5", "-5", "77"]


def test_axis_log_leaves_the_set_point_empty_in_open_loop(tmp_path: Path) -> None:
    log = AxisLog(tmp_path / "ra.csv", {**HEADER, "loop": "open"})
    log.packet(0, packet(0, SAMPLE._replace(setpoint=NO_SETPOINT)))
    log.file.close()
    assert (tmp_path / "ra.csv").read_text().splitlines()[-1].split(",")[1] == ""


def test_axis_log_carries_the_board_stamp_over_its_wrap(tmp_path: Path) -> None:
    log = AxisLog(tmp_path / "ra.csv", HEADER)
    log.packet(0, packet(2**32 - 1000))
    log.packet(0, packet(1500))
    log.file.close()
    times = [float(line.split(",")[0]) for line in (tmp_path / "ra.csv").read_text().splitlines()[7:]]
    assert np.all(np.diff(times) > 0)
    assert times[25] - times[0] == pytest.approx(0.25)


def test_axis_log_refuses_unknown_and_missing_header_keys(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="unknown"):
        AxisLog(tmp_path / "a.csv", {**HEADER, "colour": "blue"})
    with pytest.raises(ValueError, match="session"):
        AxisLog(tmp_path / "a.csv", {"axis": "ra"})


def test_H6_four_ascii_logs_with_utc_and_time(tmp_path: Path) -> None:
    logs = AsciiLogs(tmp_path, lambda t: f"2026-02-10T14:00:{t:06.3f}Z")
    logs.command(1_500_000_000, "AXIS_RA", "POWER 1", "ok 0")
    logs.status(0, "FOCUS", "state 1")
    logs.sensors(0, "ra_deg=1")
    assert logs.error_entries == 0
    logs.error(2_000_000_000, "DISPLAY", "silent")
    assert logs.error_entries == 1
    for file in logs.files():
        file.close()
    names = ("commands", "status", "sensors", "errors")
    texts = {name: (tmp_path / f"{name}.log").read_text() for name in names}
    assert texts["commands"].splitlines()[1] == "2026-02-10T14:00:01.500Z  1.500  AXIS_RA  POWER 1  ok 0"
    for text in texts.values():
        assert text.isascii() or "…" in text
        assert re.match(r"# utc  t_s", text)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full on this system")
def test_a_full_disk_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "commands.log").symlink_to("/dev/full")
    file = LineFile(tmp_path / "commands.log")
    file.write("hello\n")
    with pytest.raises(LogError, match="no space left") as caught:
        file.flush()
    assert "\n" not in str(caught.value)
    file.close()  # must not raise again


@given(room=st.integers(0, 200), lines=st.lists(st.text("abc", max_size=20), min_size=1, max_size=20))
def test_a_disk_that_fills_up_leaves_whole_lines(
    tmp_path_factory: pytest.TempPathFactory, room: int, lines: list[str]
) -> None:
    """Whatever fits, the file ends with a whole line."""
    path = tmp_path_factory.mktemp("full") / "log"
    file = LineFile(path, buffer_bytes=16)
    real, used = os.write, [0]

    def write(descriptor: int, data: bytes) -> int:
        if used[0] >= room:
            raise OSError(28, "No space left on device")
        done = real(descriptor, data[: room - used[0]])
        used[0] += done
        return done

    text = "".join(line + "\n" for line in lines)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "write", write)
        try:
            for line in lines:
                file.write(line + "\n")
            file.flush()
        except LogError:
            assert len(text) > room
    file.close()
    left = path.read_text()
    assert text.startswith(left)
    assert left == "" or left.endswith("\n")


def test_room_is_asked_for_before_it_is_needed(tmp_path: Path) -> None:
    check_space(tmp_path, 1)
    with pytest.raises(LogError, match="no space left"):
        check_space(tmp_path, 1 << 60)


def test_traces_stream_and_read_back_by_window(tmp_path: Path) -> None:
    trace = traces.Trace(tmp_path / "a.parquet", ("t_s", "x"), {"t_s": "s", "x": "rad"})
    for start in range(0, 100_000, 1000):
        t = np.arange(start, start + 1000) * 0.01
        trace.append(np.stack([t, np.sin(t)], axis=1))
    trace.close()
    trace.close()
    back = traces.read(tmp_path / "a.parquet", ("x",), 10.0, 20.0)
    assert back["t_s"][0] == pytest.approx(10.0)
    assert len(back["x"]) == 1001
    assert back["x"] == pytest.approx(np.sin(back["t_s"]))
    with pytest.raises(ValueError, match="columns"):
        trace.append(np.zeros((3, 5)))


def test_an_overview_is_short_and_keeps_every_peak(tmp_path: Path) -> None:
    trace = traces.Trace(tmp_path / "a.parquet", ("t_s", "x", "y"), {})
    t = np.arange(200_000) * 0.01
    x = np.sin(t / 50)
    x[123_457] = 7.0
    for start in range(0, len(t), 1000):
        part = slice(start, start + 1000)
        trace.append(np.stack([t[part], x[part], -x[part]], axis=1))
    trace.close()
    rows = traces.overview(tmp_path / "a.parquet", ("x", "y"), points=2000)
    assert 1500 < len(rows["t_s"]) < 2500
    assert rows["x"].max() == 7.0
    assert rows["x"].min() == pytest.approx(-1.0, abs=1e-4)
    assert np.all(np.diff(rows["t_s"]) > 0)
    assert np.all(rows["x"] == -rows["y"])


ROWS = [(index * 0.01, SAMPLE._replace(velocity=index, effort=-index * 100)) for index in range(25)]


def test_sample_loss_loses_whole_packets_and_repeats_samples() -> None:
    lose = distort.sample_loss(np.random.default_rng(1), packet_loss=0.3, repeats=0.2)
    results = [lose(list(ROWS)) for _ in range(2000)]
    assert {len(rows) for rows in results} == {0, 25}
    assert np.mean([not rows for rows in results]) == pytest.approx(0.3, abs=0.04)  # 4 sigma
    kept = [rows for rows in results if rows]
    repeated = np.mean([a[1] == b[1] for rows in kept for a, b in itertools.pairwise(rows)])
    assert repeated == pytest.approx(0.2, abs=0.02)


def test_clock_jitter_moves_stamps_only() -> None:
    jitter = distort.clock_jitter(np.random.default_rng(1), deviation=0.001)
    off = np.array(
        [t - u for _ in range(400) for (t, _), (u, _) in zip(jitter(list(ROWS)), ROWS, strict=True)]
    )
    assert off.std() == pytest.approx(0.001, rel=0.05)
    assert [sample for _, sample in jitter(list(ROWS))] == [sample for _, sample in ROWS]


@given(value=st.integers(-3000, 3000), bits=st.integers(4, 12))
def test_log_wrap_keeps_the_low_bits_or_clips(value: int, bits: int) -> None:
    row = [(0.0, SAMPLE._replace(effort=value))]
    wrapped = distort.log_wrap(RANDOM, column=0.0, bits=bits, mode=0.0)(row)[0][1].effort
    clipped = distort.log_wrap(RANDOM, column=0.0, bits=bits, mode=1.0)(row)[0][1].effort
    assert (wrapped - value) % (1 << bits) == 0
    assert -(1 << (bits - 1)) <= wrapped < 1 << (bits - 1)
    assert clipped == min(max(value, -(1 << (bits - 1))), (1 << (bits - 1)) - 1)
