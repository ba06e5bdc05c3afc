"""Every row of the table of LX200 commands, over a real socket and a real pseudo-terminal."""

import asyncio
import contextlib
import os
import re
import select
import shutil
import socket
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest
import serial

from host.lx200 import angles
from host.lx200.server import Lx200
from host.telescope import desk
from scenarios.doors.pc import TelescopePc
from scenarios.lab.prepare import chosen
from tests.host.inprocess import HostInProcess
from tests.host.live import Live
from tests.host.sky.places import apparent_of_star
from tests.host.telescope.conftest import Rig

SILENT_S = 0.15
"""Nothing has come for this long: there is no answer."""


class Client:
    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=5)

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def until(self, end: bytes) -> bytes:
        data = b""
        while not data.endswith(end):
            got = self.socket.recv(1)
            assert got, f"closed after {data!r}"
            data += got
        return data

    def whole(self) -> bytes:
        """An answer of any kind, however long a busy machine takes to begin it."""
        assert select.select([self.socket], [], [], 10.0)[0], "no answer"
        return self.rest()

    def rest(self, wait_s: float = SILENT_S) -> bytes:
        data = b""
        while select.select([self.socket], [], [], wait_s)[0]:
            data += self.socket.recv(4096)
        return data

    def ask(self, command: str) -> str:
        """A command whose answer ends with `#`."""
        self.send(f":{command}#".encode("latin-1"))
        return self.until(b"#").decode("latin-1")[:-1]

    def set(self, command: str) -> str:
        """A command whose answer is one character."""
        self.send(f":{command}#".encode("latin-1"))
        return self.socket.recv(1).decode("latin-1")

    def wait(self, limit_s: float = 60.0) -> None:
        """Until `:D#` says that the slew is done."""
        end = monotonic() + limit_s
        while self.ask("D"):
            assert monotonic() < end, "still slewing"
            sleep(0.05)


class Door(Live):
    def __init__(self, logs: Path) -> None:
        super().__init__(logs, speed=30.0)
        self.lx200 = Lx200(self.telescope)
        server = self.outside.run(self.lx200.serve_tcp("127.0.0.1", 0))
        self.outside.keep(server.serve_forever())
        self.port = server.sockets[0].getsockname()[1]
        self.pty = logs / "lx200"
        self.outside.keep(self.lx200.serve_pty(self.pty))


@pytest.fixture(scope="module")
def door(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Door]:
    made = Door(tmp_path_factory.mktemp("lx200"))
    yield made
    made.close()


@pytest.fixture
def client(door: Door) -> Iterator[Client]:
    made = Client(door.port)
    yield made
    made.send(b":Q#:FQ#")
    made.rest()
    made.socket.close()


def coordinates(door: Door, hour_angle_h: float, dec_deg: float) -> tuple[str, str]:
    """Of a place that is at this hour angle now, as the table writes them."""
    star = door.up(hour_angle_h=hour_angle_h, dec_deg=dec_deg)
    place = apparent_of_star(star, door.scenario.clock, door.telescope.snapshot.t_s)
    return (
        angles.hours(place.right_ascension_rad),
        angles.signed(place.declination_rad).replace("\xdf", "*"),
    )


def goto(client: Client, ra: str, dec: str) -> str:
    assert client.set(f"Sr{ra}") == "1" and client.set(f"Sd{dec}") == "1"
    client.send(b":MS#")
    first = client.socket.recv(1).decode()
    return first if first == "0" else first + client.until(b"#").decode()


def off_arcsec(client: Client, ra: str, dec: str) -> float:
    ra_off = (angles.parse(client.ask("GR")) - angles.parse(ra)) * 15
    dec_off = angles.parse(client.ask("GD")) - angles.parse(dec)
    return max(abs(ra_off), abs(dec_off)) * 3600


def test_ack_is_answered_without_hash(client: Client) -> None:
    client.send(b"\x06")
    assert client.whole() == b"P"


def test_a_web_page_is_hung_up_on(door: Door) -> None:
    """Its text may hold commands: a form in any page can post `:Me#` to a port of this machine."""
    page = Client(door.port)
    page.send(b"POST / HTTP/1.1\r\nHost: x\r\n\r\n:GVP#")
    page.socket.settimeout(5)
    with contextlib.suppress(ConnectionResetError):  # what it had not read was thrown away
        assert page.socket.recv(64) == b""
    page.socket.close()


def test_positions_have_the_columns_stellarium_reads(client: Client) -> None:
    client.send(b"#:GR##:GD#")
    assert re.fullmatch(rb"\d\d:\d\d:\d\d#[+-]\d\d\xdf\d\d:\d\d#", client.whole())


def test_precision_toggles_silently_and_for_this_client_only(door: Door, client: Client) -> None:
    other = Client(door.port)
    assert other.ask("GR")  # its session is there: a connection alone may still wait to be accepted
    client.send(b"#:U#")
    assert client.rest() == b""
    assert re.fullmatch(r"\d\d:\d\d\.\d", client.ask("GR"))
    assert re.fullmatch(r"[+-]\d\d\xdf\d\d", client.ask("GD"))
    assert re.fullmatch(r"\d\d:\d\d:\d\d", other.ask("GR"))
    later = Client(door.port)  # the hand box keeps what it was left at
    assert re.fullmatch(r"\d\d:\d\d\.\d", later.ask("GR"))
    client.send(b":U#")
    assert re.fullmatch(r"\d\d:\d\d:\d\d", client.ask("GR"))
    for each in (other, later):
        each.socket.close()


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("Sr12:34:56", "1"), ("Sr 12:34:56", "1"), ("Sr12:34.5", "1"), ("Sr24:00:00", "0"), ("Srxx", "0"),
        ("Sr-1:00:00", "0"), ("Sd+12*34:56", "1"), ("Sd +12\xdf34:56", "1"), ("Sd-12:34:56", "1"),
        ("Sd+12*34", "1"), ("Sd+91*00:00", "0"), ("Sd", "0"), ("Sg-79*27", "1"), ("Sg280*32", "1"),
        ("Sg10*00", "0"), ("St+29*22", "1"), ("St-29*22", "0"), ("SG-5.5", "1"), ("SG-05.5", "1"),
        ("Sz 120*30", "1"), ("Sz361*00", "0"), ("Sa+45*00", "1"), ("Sa+91*00", "0"), ("SGx", "0"),
        ("SL22:00:00", "1"), ("SL25:00:00", "0"), ("ST60.1", "1"), ("ST10.0", "0"),
        ("SMARIES", "1"), ("So10", "1"), ("Sh10", "1"), ("Sw3", "1"),
    ],
)  # fmt: skip
def test_settings_are_taken_or_refused_with_one_character(client: Client, command: str, answer: str) -> None:
    client.send(f":{command}#".encode("latin-1"))
    assert client.whole() == answer.encode()


def test_the_date_is_answered_in_two_sections(client: Client) -> None:
    client.send(b":SC02/10/26#")
    answer = client.whole()
    assert re.fullmatch(rb"1Updating Planetary Data# +#", answer)
    client.send(b":SC13/40/26#")
    assert client.whole() == b"0"


def test_time_is_kept_and_runs_and_moves_no_sky(client: Client) -> None:
    before = angles.parse(client.ask("GR"))
    assert client.set("SG-5.5") == "1" and client.set("SL03:00:00") == "1"
    client.send(b":SC07/01/30#")
    client.rest()
    assert client.ask("GC") == "07/01/30" and client.ask("GG") == "-05.5"
    assert re.fullmatch(r"03:0\d:\d\d", client.ask("GL"))
    # parked and not tracking: only the sky's own motion, 30 times as fast
    assert abs(angles.parse(client.ask("GR")) - before) < 0.1


@pytest.mark.parametrize(
    ("command", "pattern"),
    [
        ("Gc", "24"), ("GM", ".+"), ("GN", ".+"), ("GO", ".+"), ("GP", ".+"), ("GT", r"60\.1"),
        ("Gt", "\\+29\xdf22"), ("Gg", "280\xdf33"), ("GG", r"[+-]\d\d\.\d"), ("GL", r"\d\d:\d\d:\d\d"),
        ("GC", r"\d\d/\d\d/\d\d"), ("GA", "[+-]\\d\\d\xdf\\d\\d'\\d\\d"), ("GZ", "\\d{3}\xdf\\d\\d'\\d\\d"),
        ("GS", r"\d\d:\d\d:\d\d"), ("GW", "P[NT]1"), ("Gr", r"\d\d:\d\d:\d\d"),
        ("Gd", "[+-]\\d\\d\xdf\\d\\d:\\d\\d"), ("GVP", "schmidt"), ("GVN", r"\d.*"), ("GVD", ".+"),
        ("GVT", ".+"), ("D", "\x7f?"),
    ],
)  # fmt: skip
def test_what_is_read(client: Client, command: str, pattern: str) -> None:
    client.rest()
    assert re.fullmatch(pattern, client.ask(command))
    assert client.rest() == b""


@pytest.mark.parametrize(
    "command",
    ["Q", "TQ", "TS", "TL", "TM", "TQ", "RG", "RC", "RM", "RS", "Qn", "Qs", "Qe", "Qw", "FQ", "FS", "FF",
     "AA", "W1", "LC", "LM", "LS", "XX", "G", "", "Qz", "GRR"],
)  # fmt: skip
def test_what_has_no_answer(client: Client, command: str) -> None:
    client.send(f":{command}#".encode())
    assert client.rest() == b""


def test_slew_read_back_sync_abort_park(door: Door, client: Client) -> None:
    ra, dec = coordinates(door, -0.5, 25.0)
    assert goto(client, ra, dec) == "0"
    assert client.ask("D") == "\x7f"  # from the first moment on
    client.wait()
    assert off_arcsec(client, ra, dec) <= 10
    assert client.ask("GW") == "PT1"

    assert client.set(f"Sr{ra}") == "1" and client.set(f"Sd{dec}") == "1"
    assert "matched" in client.ask("CM")

    assert goto(client, *coordinates(door, 1.0, 45.0)) == "0"
    sleep(0.15)
    client.send(b"#:Q#")
    assert client.rest() == b""
    client.wait()
    stopped = client.ask("GR"), client.ask("GD").replace("\xdf", "*")
    sleep(0.5)  # 15 s of the sky
    assert off_arcsec(client, *stopped) <= 20

    client.send(b":hP#")
    assert client.rest(0.05) == b""
    assert client.ask("D") == "\x7f"
    client.wait()
    assert door.telescope.snapshot.parked and not door.telescope.snapshot.powered


def test_refusals_come_in_one_piece(door: Door, client: Client) -> None:
    answer = goto(client, *coordinates(door, 6.5, -30.0))
    assert re.fullmatch(r"1[ -~]+#", answer) and client.rest() == b""
    answer = goto(client, *coordinates(door, -7.5, 75.0))
    assert re.fullmatch(r"2[ -~]+#", answer) and client.rest() == b""
    fresh = Client(door.port)
    fresh.send(b":MS#")
    assert re.fullmatch(rb"2[ -~]+#", fresh.whole())
    fresh.socket.close()


def test_a_slew_over_the_ground_stands_there_or_says_no(door: Door, client: Client) -> None:
    assert client.set("MA") == "1"
    for azimuth, altitude, answer in (("200*30", "+60*15", "0"), ("200*30", "+05*00", "1")):
        assert client.set(f"Sz {azimuth}") == "1" and client.set(f"Sa{altitude}") == "1"
        assert client.set("MA") == answer
    client.wait()
    assert angles.parse(client.ask("GZ").replace("'", ":")) == pytest.approx(200.5, abs=0.01)
    assert angles.parse(client.ask("GA").replace("'", ":")) == pytest.approx(60.25, abs=0.005)
    assert client.ask("GW") == "PN1"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("rotctl") is None, reason="rotctl is not installed (libhamlib-utils)")
def test_hamlibs_rotctl_slews(door: Door, client: Client) -> None:
    """Its Meade rotator, number 1801, as Debian packages it; it reads back in low precision only."""
    client.send(b":U#")
    command = ["rotctl", "-m", "1801", "-r", f"127.0.0.1:{door.port}"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="latin-1") as made:
        assert made.stdin is not None and made.stdout is not None
        made.stdin.write("P 120 55.5\n")
        made.stdin.flush()
        limit = monotonic() + 20
        while not door.telescope.snapshot.slewing:
            assert monotonic() < limit, "rotctl moves nothing"
            sleep(0.02)
        client.wait()
        said, _ = made.communicate("p\nq\n", 30)
    client.send(b":U#")
    azimuth, altitude = (
        float(re.findall(rf"{each}: ([\d.]+)", said)[0]) for each in ("Azimuth", "Elevation")
    )
    assert azimuth == pytest.approx(120, abs=0.02) and altitude == pytest.approx(55.5, abs=0.02), said


@pytest.mark.slow
def test_keys_pulses_and_rates(door: Door, client: Client) -> None:
    assert goto(client, *coordinates(door, 0.0, 29.0)) == "0"
    client.wait()
    start = angles.parse(client.ask("GD"))
    client.send(b":RC#:Mn#")
    door.let(8.0)
    assert door.telescope.snapshot.activity == "moved by hand"
    client.send(b":Qn#")
    client.wait()
    assert angles.parse(client.ask("GD")) - start > 300 / 3600
    door.let(10.0)
    start = angles.parse(client.ask("GD"))
    client.send(b":Mgs4000#")
    assert client.rest() == b""
    door.let(10.0)
    assert (angles.parse(client.ask("GD")) - start) * 3600 == pytest.approx(-30, abs=4)
    client.send(b":TL#")
    assert client.ask("GT") == "57.9"
    client.send(b":TQ#")
    assert client.ask("GT") == "60.1"
    client.send(b":AL#")
    assert client.ask("GW") == "PN1"
    client.send(b":AP#")
    assert client.ask("GW") == "PT1"


def test_focus_keys(door: Door, client: Client) -> None:
    def position() -> int:
        focus = door.telescope.snapshot.focus
        assert focus
        return focus.position

    start = position()
    client.send(b":FF#:F-#")
    door.let(6.0)
    client.send(b":FQ#")
    door.let(4.0)
    out = position()
    assert out > start
    client.send(b":FS#:F+#")
    door.let(6.0)
    client.send(b":FQ#")
    door.let(4.0)
    assert position() < out


def test_split_joined_doubled_and_two_clients_at_once(door: Door, client: Client) -> None:
    for byte in b":GD#":
        client.send(bytes([byte]))
        sleep(0.005)
    assert re.fullmatch(rb"[+-]\d\d\xdf\d\d:\d\d#", client.whole())
    client.send(b"::::GD#junk:GD#:GD#\x00\xff:Gc#")
    assert re.fullmatch(rb"([+-]\d\d\xdf\d\d:\d\d#){3}24#", client.whole())

    wrong: list[str] = []

    def poll(hour: int) -> None:
        mine = Client(door.port)
        for _ in range(50):
            if mine.set(f"Sr{hour:02d}:00:00") != "1" or mine.ask("Gr") != f"{hour:02d}:00:00":
                wrong.append(str(hour))
        mine.socket.close()

    threads = [threading.Thread(target=poll, args=(hour,)) for hour in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_client_that_vanishes_or_never_reads_stops_nobody(door: Door, client: Client) -> None:
    gone = Client(door.port)
    gone.send(b":GR#" * 10 + b":Sr12")
    gone.socket.close()
    deaf = Client(door.port)
    deaf.socket.settimeout(0.5)
    try:
        for _ in range(200):
            deaf.send(b":GVF#" * 2000)
    except TimeoutError:
        pass  # the door has stopped reading from one that does not read
    assert client.ask("Gc") == "24"
    deaf.socket.close()


def test_serial_the_same_and_again_after_reopening(door: Door) -> None:
    for _ in range(2):
        with serial.Serial(str(door.pty), 9600, timeout=2, exclusive=True) as port:
            port.write(b"\x06")
            assert port.read(1) == b"P"
            port.write(b":GR#")
            assert re.fullmatch(rb"\d\d:\d\d:\d\d#", port.read_until(b"#"))


def test_a_place_that_nobody_measured_is_not_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A host that has just been started again has no readings; zeros would be a place in the sky."""
    monkeypatch.setattr(desk, "ANSWER_S", 0.1)
    rig = Rig(tmp_path)
    started = HostInProcess(rig.served)
    session = Lx200(started.pc.telescope).session("new")
    for command in (b":GR#", b":GD#", b":GA#", b":GZ#"):
        assert asyncio.run(session.feed(command)) == b""
    assert asyncio.run(session.feed(b":GVP#")) == b"schmidt#"

    def hear() -> None:
        sleep(0.05)
        for _ in range(50):
            started.poll(rig.served.now_ns)
            rig.served.run_until(rig.served.now_ns + 10_000_000)

    monkeypatch.setattr(desk, "ANSWER_S", 30.0)
    thread = threading.Thread(target=hear)
    thread.start()
    assert asyncio.run(session.feed(b":GR#")).count(b":") == 2  # waited for
    thread.join()
    started.close()
    rig.host.close()


def test_a_killed_hosts_link_is_taken_over(tmp_path: Path) -> None:
    """The number of its terminal is free again, and may be the new one's."""
    link = tmp_path / "lx200"
    master, slave = os.openpty()
    link.symlink_to(os.ttyname(slave))
    os.close(slave)
    os.close(master)

    async def serve() -> None:
        serving = asyncio.create_task(Lx200.serve_pty(served.lx200, link))
        await asyncio.sleep(0.1)
        assert not serving.done() and link.exists()
        serving.cancel()

    served = TelescopePc(chosen()[0], lambda _t, _report: None, ())
    asyncio.run(serve())
    served.close()
