"""Recorded runs and the view of a real bus, on plain objects: what is written, and what is shown."""

from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.can.length import frame_bits
from bus.protocol import Device, pack_heartbeat, pack_tach
from bus.protocol.report import pack_report, unpack_report
from bus.protocol.serial import AxisSample, pack_packet
from host.console.heard import HeardBus
from host.console.runs import RecordedRuns
from host.console.views import KEPT, words
from host.logs.journal import Journal

HEADERS = {
    axis: {"axis": axis, "session": "test", "loop": "closed", "start_utc": "2026-02-10T14:00:00Z"}
    for axis in ("ra", "dec")
}


def runs(folder: Path, lines: tuple[str, ...] = ("AXIS_RA", "AXIS_DEC")) -> RecordedRuns:
    return RecordedRuns(folder, HEADERS, Journal(None), lines)


def test_a_run_begins_and_ends_when_it_is_polled(tmp_path: Path) -> None:
    made = runs(tmp_path)
    made.start()
    assert not made.recording and made.logs("ra") == []
    made.poll()
    assert made.recording and made.logs("ra") == [], "one that is recorded is not finished"
    sample = AxisSample(*range(len(AxisSample._fields)))
    made.receive(1, "AXIS_RA", pack_packet(Device.AXIS_RA, 0, 1000, [sample] * 25))
    made.receive(1, "FOCUS", b"nobody listens")
    made.start()
    made.poll()
    first = made.logs("ra")
    assert first == [tmp_path / "ra-001.csv"] and made.logs("dec") == [tmp_path / "dec-001.csv"]
    text = first[0].read_text().splitlines()
    assert text[0] == "# format: axis-log 1" and len(text) == 7 + 25
    assert len((tmp_path / "dec-001.csv").read_text().splitlines()) == 7
    made.stop()
    made.poll()
    assert not made.recording
    assert [each.name for each in made.logs("dec")] == ["dec-001.csv", "dec-002.csv"]
    again = runs(tmp_path)
    again.start()
    again.poll()
    assert (tmp_path / "ra-003.csv").exists()
    again.close()
    assert len(again.logs("ra")) == 3 and not again.recording
    assert again.command("ra", tmp_path / "out")[3:] == [
        "calibrate", *(str(tmp_path / f"ra-00{k}.csv") for k in (1, 2, 3)), "--out", str(tmp_path / "out"),
    ]  # fmt: skip


def test_nothing_is_recorded_of_lines_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no RS232 line of an axis board"):
        runs(tmp_path, ()).start()
    made = runs(tmp_path, ("AXIS_DEC",))
    made.start()
    made.poll()
    assert [each.name for each in tmp_path.iterdir()] == ["dec-001.csv"]
    made.close()


def heard(**links: Any) -> tuple[HeardBus, Any]:
    link = {"heard_ns": {}, "heartbeats": {}, "bad_reports": 0} | links
    client: Any = Some(devices=(Device.AXIS_RA, Device.FOCUS), now_ns=10_000_000_000, link=Some(**link))
    return HeardBus(client), client


def test_a_node_is_silent_active_or_passive() -> None:
    made, client = heard()
    assert made.look().nodes == [
        ("AXIS_RA", False, "silent", 0, 0, 0.0),
        ("FOCUS", False, "silent", 0, 0, 0.0),
    ]
    link = client.link
    link.heard_ns = {Device.AXIS_RA: 6_500_000_000, Device.FOCUS: 6_499_999_999}
    link.heartbeats = {device: pack_heartbeat(device, 1, 5, 0, 127) for device in client.devices}
    assert made.look().nodes == [
        ("AXIS_RA", True, "active", 127, 0, 0.0),
        ("FOCUS", False, "silent", 0, 0, 0.0),
    ]
    link.heartbeats = {Device.AXIS_RA: pack_heartbeat(Device.AXIS_RA, 1, 5, 0, 128)}
    link.heard_ns[Device.FOCUS] = 10_000_000_000
    assert made.look().nodes == [
        ("AXIS_RA", True, "passive", 128, 0, 0.0),
        ("FOCUS", False, "silent", 0, 0, 0.0),
    ]


def test_the_load_is_of_the_last_whole_second() -> None:
    """Frames' own bits over those of a second at 1 Mbit/s."""
    made, client = heard()
    client.link.heard_ns = {Device.AXIS_RA: client.now_ns}
    client.link.heartbeats = {Device.AXIS_RA: pack_heartbeat(Device.AXIS_RA, 1, 5, 0, 0)}
    ra, focus = (pack_tach(device, 0, 1, 2) for device in (Device.AXIS_RA, Device.FOCUS))
    report = pack_report([ra, ra, focus])
    bits = [frame_bits(each) for each in unpack_report(report)]
    made.take(5_000_000_000, report)  # the time before it
    made.take(5_400_000_000, report)
    made.take(5_999_999_999, report)
    assert made.look().load == 0.0
    made.take(7_000_000_000, report)
    now = made.look()
    assert now.load == pytest.approx(3 * sum(bits) / 2e6)
    assert now.nodes[0].load == pytest.approx(3 * (bits[0] + bits[1]) / 2e6)
    made.take(8_000_000_000, report)
    assert made.look().load == pytest.approx(sum(bits) / 1e6)


def test_the_last_frames_are_kept_with_their_senders() -> None:
    made, _ = heard(bad_reports=3)
    made.take(1, b"no report")
    made.take(2, pack_report([pack_tach(Device.AXIS_RA, 0, 1, 2), pack_tach(0x7E, 0, 1, 2)]))
    now = made.look()
    assert [(t_ns, sender, identifier) for t_ns, sender, identifier, _ in now.frames] == [
        (2, "AXIS_RA", 0x200 + Device.AXIS_RA), (2, "0x7e", 0x27E),
    ]  # fmt: skip
    assert now.frames[0][3] == pack_tach(Device.AXIS_RA, 0, 1, 2) and now.errors == {"bad reports": 3}
    for k in range(40):
        made.take(k, pack_report([pack_tach(Device.FOCUS, 0, k, 2)]))
    assert len(made.look().frames) == KEPT == 25 and made.look().frames[-1][0] == 39
    with pytest.raises(ValueError, match="this is no emulated bus: nothing can be broken from here"):
        made.wish("power FOCUS off").result(0)
    assert (made.boards, made.kinds, now.running) == ((), [], [])


def test_a_frame_is_told_in_its_signals() -> None:
    said = words(0x200 + Device.MOTOR_RA_A, pack_tach(Device.MOTOR_RA_A, 0, 4096, -7))
    assert "Device" not in said.replace("DeviceType", "") and "4096" in said and "-7" in said
    assert words(0x7FF, b"") == "not in the protocol"
