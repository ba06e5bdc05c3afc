"""Parts of the logs by hand: buffers, whole lines, rotation, a client's guiding, extremes of traces."""

import hashlib
import math
from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from bus.protocol import Device
from bus.protocol.serial import AxisSample, Packet
from host.auxiliary import (
    ABSOLUTE_ARCSEC,
    APART,
    AUXILIARY_ARCSEC,
    AUXILIARY_STEP_ARCSEC,
    BOARDS,
    RATIO,
    TIME_S,
    auxiliary,
    combine,
    unwrapped,
)  # fmt: skip
from host.logs import clientguiding
from host.logs.axis import AxisLog
from host.logs.files import BlockFile, LineFile, LogError, check_space, reason, write_file
from host.logs.journal import AsciiLogs, Journal, RotatingFile, put_aside
from host.logs.traces import Trace, extremes, overview, read
from host.rates import COUNT_ARCSEC, EFFORT_FULL, rate_arcsec_s
from host.sky.mount import STEP_ARCSEC
from host.sky.tracks import Pulse

HEADER = {"axis": "ra", "session": "test", "loop": "closed", "start_utc": "2026-02-10T14:00:00Z"}


def test_lines_wait_until_the_buffer_is_full(tmp_path: Path) -> None:
    made = LineFile(tmp_path / "a.log", 10)
    made.write("1234\n")
    assert (tmp_path / "a.log").read_text() == "" and made.lines == 1
    made.write("678°\n")
    assert (tmp_path / "a.log").read_text() == "1234\n678°\n"
    made.write("x\n")
    assert made.lines == 3 and made.hexdigest() == hashlib.sha256("1234\n678°\n".encode()).hexdigest()
    made.close()
    made.close()
    assert made.hexdigest() == hashlib.sha256("1234\n678°\nx\n".encode()).hexdigest()
    made.reopen()
    made.write("y\n")
    made.close()
    assert (tmp_path / "a.log").read_text() == "y\n"


def test_a_block_that_does_not_fit_is_cut_to_whole_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import os

    real = os.write
    for lines, left in ((True, "first\nab\n"), (False, "first\n")):
        path = tmp_path / f"{lines}.log"
        made = BlockFile(path, lines)
        assert made.write(b"first\n") == 6
        room = [5]

        def full(descriptor: int, data: bytes, room: list[int] = room) -> int:
            if not room[0]:
                raise OSError(28, "No space left on device")
            done = real(descriptor, data[: room[0]])
            room[0] -= done
            return done

        with monkeypatch.context() as patched:
            patched.setattr(os, "write", full)
            with pytest.raises(LogError, match=r"no space left on device; what is there is readable"):
                made.write(b"ab\ncd\nef\n")
        assert path.read_text() == left
        assert made.write(b"more\n") == 0 and path.read_text() == left
        made.close()


def test_reasons_are_one_line_without_a_number(tmp_path: Path) -> None:
    assert reason(OSError(2, "No such file")) == "no such file"
    assert reason(ValueError("Bad [Errno -3] things\nmore")) == "bad things"
    assert reason(ValueError("")) == "valueError"
    with pytest.raises(LogError, match="cannot be written"):
        BlockFile(tmp_path)
    write_file(tmp_path / "b" / "c.txt", "ü")
    write_file(tmp_path / "b" / "d.txt", b"\x01")
    assert (tmp_path / "b" / "c.txt").read_bytes() == "ü".encode()
    with pytest.raises(LogError, match=r"MiB free"):
        check_space(tmp_path, 1 << 60)
    check_space(tmp_path, 0)


def test_a_log_that_is_full_is_put_aside_with_its_head(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text("old\n")
    made = RotatingFile(path, 12, 2)
    for line in ("# h\n", "12345678\n", "abc\n", "defgh\n", "ij\n"):
        made.write(line)
    made.close()
    assert path.read_text() == "# h\nij\n" or path.read_text().startswith("# h\n")
    texts = [path.with_name(f"a.log.{k}").read_text() for k in (1, 2)]
    assert all(each.startswith("# h\n") and len(each) <= 13 for each in texts)
    assert not path.with_name("a.log.3").exists()
    joined = "".join([*reversed(texts), path.read_text()])
    assert [each for each in joined.split("\n") if each and each != "# h"][-3:] == ["abc", "defgh", "ij"]


def test_files_that_are_put_aside_move_up(tmp_path: Path) -> None:
    path = tmp_path / "x"
    for text in ("1", "2", "3", "4"):
        path.write_text(text)
        put_aside(path, 2)
    assert not path.exists()
    assert [path.with_name(f"x.{k}").read_text() for k in (1, 2)] == ["4", "3"]
    assert not path.with_name("x.3").exists()
    put_aside(path, 2)
    assert [path.with_name(f"x.{k}").exists() for k in (1, 2)] == [False, True]


def test_ascii_logs_and_the_journal_agree(tmp_path: Path) -> None:
    logs = AsciiLogs(tmp_path, lambda t_s: f"utc{t_s:.1f}")
    journal = Journal(logs)
    heard: list[str] = []
    journal.listeners.append(lambda entry: heard.append(entry.text))
    journal.command(1_500_000_000, "AXIS_RA", "POWER 1", "ok")
    journal.sensors(2_000_000_000, "ra=1")
    journal.status(2_500_000_000, "HOST", "on")
    journal.error(3_000_000_000, "HOST", "bad")
    logs.flush()
    assert (tmp_path / "commands.log").read_text().splitlines()[1] == "utc1.5  1.500  AXIS_RA  POWER 1  ok"
    assert (tmp_path / "sensors.log").read_text().splitlines()[1] == "utc2.0  2.000  ra=1"
    assert logs.error_entries == 1 and len(logs.files()) == 4
    assert [each.number for each in journal.entries] == [1, 2, 3] and journal.errors == 1
    assert heard == ["POWER 1: ok", "on", "bad"] and [each.text for each in journal.since(2)] == ["bad"]
    assert journal.entries[0].t_s == 1.5 and journal.entries.maxlen == 1000
    logs.close()


def test_an_axis_log_counts_its_rows_over_two_wraps(tmp_path: Path) -> None:
    made = AxisLog(tmp_path / "a.csv", HEADER, lambda rows: rows[:2])
    sample = AxisSample(*range(len(AxisSample._fields)))
    for stamp in (2**32 - 100, 5, 2**31, 2**32 - 1, 3):
        made.packet(0, Packet(Device.AXIS_RA, 0, stamp, (sample,) * 25))
    made.file.close()
    times = [float(line.split(",")[0]) for line in (tmp_path / "a.csv").read_text().splitlines()[7:]]
    assert made.rows == 10 and len(times) == 10
    unit = 1e-4
    expected = [2**32 - 100, 2**32 + 5, 2**32 + 2**31, 2**33 - 1, 2**33 + 3]
    assert times[::2] == pytest.approx([each * unit for each in expected], abs=1e-3)
    assert times[1] - times[0] == pytest.approx(0.01)
    AxisLog(tmp_path / "b.csv", HEADER, lambda _: []).packet(0, Packet(Device.AXIS_RA, 0, 0, (sample,) * 25))


def exposure(end_s: float, west: float, north: float) -> Any:
    return clientguiding._Exposure(end_s - 1.0, end_s, west, north)


def test_a_clients_pulses_belong_to_the_exposure_before_them() -> None:
    star = Some(declination_rad=math.pi / 3)
    session: Any = clientguiding._Session(Some(star=star), 0.0)  # type: ignore[arg-type]
    places = ((6.0, 1.5, 2.5), (2.0, 9.0, 9.0), (4.0, 1.0, 2.0), (8.0, 3.0, 0.0))
    session.exposures = [exposure(*each) for each in places]
    session.pulses = [
        Pulse(0, 7.0, 4.0, 0.5), Pulse(0, -7.0, 5.9, 0.1), Pulse(1, -5.0, 5.0, 1.0), Pulse(1, 5.0, 100.0,
        2.0),
        Pulse(0, 1.0, 1.9, 1.0),
    ]  # fmt: skip
    first, second, third = clientguiding._rows(session)
    assert (first.t_s, first.off) == (4.0, (0.0, 0.0))
    assert first.sent == pytest.approx((0.5 * (3.5 - 0.7), -5.0)) and first.pulses_s == pytest.approx(
        (0.4, -1.0)
    )
    assert (second.t_s, second.off, second.sent, second.pulses_s) == (6.0, (0.5, 0.5), (0.0, 0.0), (0.0, 0.0))
    assert third.off == (2.0, -2.0) and third.sent == (0.0, 10.0) and third.pulses_s == (0.0, 2.0)
    session.pulses = []
    assert clientguiding._rows(session) == []


def test_extremes_are_the_least_and_the_most_of_every_stretch() -> None:
    values = np.array([3.0, 1.0, 2.0, 9.0, 5.0, 4.0, 7.0])
    assert list(extremes(values, 3)) == [0, 1, 3, 5]
    assert list(extremes(values, 2)) == list(range(7)) and list(extremes(values, 8)) == list(range(7))
    assert list(extremes(np.array([1.0, 5.0, 2.0, 0.0]), 4)) == [1, 3]


def test_a_trace_comes_back_in_part_and_in_short(tmp_path: Path) -> None:
    path = tmp_path / "t.parquet"
    made = Trace(path, ("t_s", "x"), {"x": "arcsec"})
    rows = np.stack([np.arange(10_000) * 0.1, np.sin(np.arange(10_000.0))], axis=1)
    made.append(rows[:8192])
    made.append(rows[8192:])
    with pytest.raises(ValueError, match="columns for 2"):
        made.append(np.zeros((2, 3)))
    made.close()
    made.close()
    part = read(path, ("x", "t_s"), 1.0, 2.0)
    assert list(part) == ["t_s", "x"] and part["t_s"] == pytest.approx(np.arange(10, 21) * 0.1)
    short = overview(path, ("x",), 400)
    assert 300 < len(short["t_s"]) < 450 and short["x"].max() == rows[:, 1].max()
    import pyarrow.parquet as pq

    with pq.ParquetFile(path) as file:
        assert file.num_row_groups == 2 and file.schema_arrow.field("x").metadata == {b"unit": b"arcsec"}


def test_rates_are_of_counts_in_five_milliseconds() -> None:
    """4.608 million counts times 735:30 to a turn: 6.5333 counts are 15″/s (hardware.md 2.1)."""
    assert rate_arcsec_s(6.5333) == pytest.approx(15.0, abs=1e-3)
    assert pytest.approx(1296000 / 4608000 / 24.5) == COUNT_ARCSEC and EFFORT_FULL == 3000


def test_the_two_encoders_deviations_are_the_sources() -> None:
    """By hand: 1/sqrt 3; 15/10.8/sqrt 3 with a step of 0.9155″/sqrt 12; 5 ms times sqrt(2/12)."""
    assert pytest.approx(0.57735, abs=1e-5) == ABSOLUTE_ARCSEC
    assert pytest.approx(0.91553, abs=1e-5) == AUXILIARY_STEP_ARCSEC and RATIO == 10.8
    assert pytest.approx(math.hypot(0.801875, 0.264291), abs=1e-5) == AUXILIARY_ARCSEC
    assert pytest.approx(2.04124e-3, abs=1e-8) == TIME_S and APART == 5.0
    sigma = math.hypot(ABSOLUTE_ARCSEC, AUXILIARY_ARCSEC)
    for apart, agree in ((4.98, True), (5.02, False), (-4.98, True), (-5.02, False)):
        found = combine(round(1000 / STEP_ARCSEC), 1000 - apart * sigma)
        assert found.agree == agree and found.difference_arcsec == pytest.approx(apart * sigma, abs=0.003)
    both = combine(round(1000 / STEP_ARCSEC), 1000.5, 2 * ABSOLUTE_ARCSEC)
    assert both.estimate_arcsec == pytest.approx(1000.1, abs=0.002)
    assert both.sigma_arcsec == pytest.approx(ABSOLUTE_ARCSEC * math.sqrt(0.8))
    assert combine(None, None) == (None, None, None, None, math.inf, True)
    turn = 120000.0
    assert unwrapped(100, 3 * turn + 5.0) == pytest.approx(3 * turn + 100 * AUXILIARY_STEP_ARCSEC)
    assert unwrapped(100, 2.4 * turn) == pytest.approx(2 * turn + 100 * AUXILIARY_STEP_ARCSEC)


def test_an_auxiliary_reading_is_brought_to_the_others_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    values = {"Alarm": 0.0, "Age": 2000.0, "Position": 50.0}
    codec = Some(unpack=lambda _: values)
    monkeypatch.setattr("host.auxiliary.codecs", lambda: {"AUXILIARY_RA": codec})
    board = BOARDS["ra"]
    link: Any = Some(measurements={board: b"x"}, measured_ns={board: 1_000_000_000})
    steps = round(50 * AUXILIARY_STEP_ARCSEC / STEP_ARCSEC)
    found = auxiliary(link, "ra", steps, 1.003, 100.0)
    assert found is not None
    assert found.arcsec == pytest.approx(50.5 * AUXILIARY_STEP_ARCSEC + 100.0 * 0.005)
    assert found.sigma_arcsec == pytest.approx(math.hypot(AUXILIARY_ARCSEC, 100.0 * TIME_S))
    assert auxiliary(link, "ra", None, 1.0, 0.0) is None and auxiliary(link, "dec", steps, 1.0, 0.0) is None
    values["Alarm"] = 1.0
    assert auxiliary(link, "ra", steps, 1.0, 0.0) is None
