"""The bus page of a host on real boards: what it hears against what is on the wire."""

import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from bus.protocol import Device, pack_heartbeat
from bus.protocol.report import pack_report
from host.client import SILENCE_NS, Client
from host.console.heard import HeardBus
from host.console.runs import RecordedRuns
from host.console.views import words
from host.link import HidLink
from host.logs.journal import Journal
from scenarios.doors.busview import EmulatedBus
from tests.doors.process import PROGRAM, ROOT, Serving
from tests.host.console.conftest import opened, press
from tests.host.telescope.conftest import Rig
from tests.ports import free_ports

WAIT_S = 60.0


def test_nodes_load_and_frames_are_those_of_the_wire() -> None:
    rig = Rig()
    try:
        wire = rig.served.network.wire
        plug = rig.served.usb.plug("test")
        link = HidLink(lambda _t, _report: None)
        client = Client(link, Journal(None), tuple(Device[name] for name in rig.served.network.boards))
        heard = HeardBus(client)
        on_wire: dict[int, set[bytes]] = {}
        wire.tap(lambda _t, frame, _s: on_wire.setdefault(frame.identifier, set()).add(frame.data))
        start_s = rig.served.now_ns * 1e-9
        busy_s = wire.load * start_s
        for _ in range(100):
            rig.served.run_until(rig.served.now_ns + 50_000_000)
            for t_ns, report in plug.reports():
                link.receive(t_ns, report)
                heard.take(t_ns, report)
            client.now_ns = rig.served.now_ns
        end_s = rig.served.now_ns * 1e-9
        load = (wire.load * end_s - busy_s) / (end_s - start_s)
        now = heard.look()
        assert 0.9 * load < now.load <= 1.01 * load
        shares = {node.name: node.load for node in now.nodes}
        assert sum(shares.values()) == pytest.approx(now.load) and shares["POSITION_RA"] > 0.01
        seen = EmulatedBus(rig.served)
        seen.look()
        rig.served.run_until(rig.served.now_ns + 1_000_000_000)
        told = seen.look()
        sent = {node.name: node.load for node in told.nodes}
        assert sum(sent.values()) == pytest.approx(told.load, rel=0.02)  # the rest: frames that were cut
        assert sent["POSITION_RA"] == pytest.approx(shares["POSITION_RA"], rel=0.1)
        assert {n.name for n in now.nodes if n.powered and n.state == "active"} == {
            name for name, board in rig.served.network.boards.items() if board.on and name != "GATEWAY"
        } | ({"GATEWAY"} if int(Device.GATEWAY) in link.heard_ns else set())
        assert len(now.frames) == 25 and now.errors == {"bad reports": 0}
        assert all(data in on_wire[number] and words(number, data) for _, _, number, data in now.frames)
    finally:
        rig.host.close()


def test_a_scaled_signal_has_the_digits_of_its_scale() -> None:
    """995 hundredths of a degree, which is 9.950000000000001 in binary."""
    assert "Temperature 9.95," in words(0x274, bytes.fromhex("7400e303f401c600"))


@pytest.mark.parametrize(
    ("tec", "said"), [(0, "active"), (127, "active"), (128, "passive"), (255, "passive")]
)
def test_a_boards_error_state_is_what_its_heartbeat_says_and_silence_is_shown(tec: int, said: str) -> None:
    link = HidLink(lambda _t, _report: None)
    client = Client(link, Journal(None), (Device.FOCUS, Device.DISPLAY))
    heard = HeardBus(client)
    beat = pack_heartbeat(Device.FOCUS, 1, 5, 0, tec)
    link.receive(1_000, pack_report([bytes((beat[0] | 0x80,)) + beat[1:]]))
    client.now_ns = 1_000 + SILENCE_NS
    assert [(n.name, n.powered, n.state, n.tec) for n in heard.look().nodes] == [
        ("FOCUS", True, said, tec), ("DISPLAY", False, "silent", 0),
    ]  # fmt: skip
    client.now_ns += 1
    assert not any(node.powered for node in heard.look().nodes)


def test_nothing_can_be_broken_on_a_real_bus() -> None:
    heard = HeardBus(Client(HidLink(lambda _t, _report: None), Journal(None), ()))
    assert not heard.boards and not heard.kinds and not heard.look().running
    with pytest.raises(ValueError, match="no emulated bus"):
        heard.wish("fault clear 1").result(0)


def test_without_an_axis_line_there_is_nothing_to_record(tmp_path: Path) -> None:
    runs = RecordedRuns(tmp_path, {"ra": {}, "dec": {}}, Journal(None), ["FOCUS"])
    with pytest.raises(ValueError, match="--serial AXIS_RA=PORT"):
        runs.start()
    runs.poll()
    assert not runs.recording and not list(tmp_path.iterdir())


@pytest.fixture
def program(tmp_path: Path) -> Iterator[Any]:
    """The boards in one process, the host program in another on two of their cables, as on real ones."""
    socket, first, port = tmp_path / "gateway.sock", free_ports(5), free_ports()
    with Serving(tmp_path, "--hid", f"unix:{socket}", "--serial", f"tcp:{first}"):
        words = [
            *("--usb", f"unix:{socket}", "--serial", f"AXIS_RA=socket://localhost:{first}"),
            *("--console", str(port), "--runs", str(tmp_path / "runs"), "--logs", str(tmp_path / "logs")),
        ]
        with (tmp_path / "host.txt").open("w") as said:
            host = subprocess.Popen(
                [sys.executable, "-c", PROGRAM, "host", *words], cwd=ROOT, stdout=said, stderr=said
            )
        yield port, tmp_path
        host.terminate()
        host.wait(30)


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_the_host_by_itself_has_the_consoles(browser: Any, program: Any) -> None:
    port, folder = program
    served: Any = SimpleNamespace(url=f"http://127.0.0.1:{port}")
    end = time.monotonic() + WAIT_S
    while True:
        try:
            urllib.request.urlopen(served.url, timeout=5).close()
            break
        except (urllib.error.URLError, OSError):
            assert time.monotonic() < end
            time.sleep(0.2)
    page = opened(browser, served, "/")
    press(page, "Power on")
    page.get_by_text("motors on", exact=True).first.wait_for()
    page.get_by_role("link", name="Bus").click()
    page.get_by_text("no emulated bus").wait_for()
    page.wait_for_function("/[1-9].* %\\s+of the last second/.test(document.body.innerText)")
    page.get_by_text("AXIS_RA").first.wait_for()
    page.get_by_role("link", name="Calibrate").click()
    press(page, "Start a run")
    page.get_by_text("recording run 1").wait_for()
    time.sleep(2)
    press(page, "End the run")
    page.get_by_text("1 runs recorded").wait_for()
    lines = (folder / "runs" / "ra-001.csv").read_text().splitlines()
    assert len([line for line in lines if not line.startswith("#")]) > 20
    assert not list((folder / "runs").glob("dec-*"))
    page.get_by_role("link", name="Main", exact=True).click()
    press(page, "STOP  (space)")
    end = time.monotonic() + WAIT_S
    while "emergency stop" not in (folder / "logs" / "commands.log").read_text():
        assert time.monotonic() < end
        time.sleep(0.2)
    page.close()
