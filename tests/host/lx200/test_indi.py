"""INDI's own LX200 drivers, as Debian packages them, against `schmidt serve --lx200`.

indiserver, indi_setprop and indi_getprop are what a user has; nothing of the drivers is changed.
"""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest

from tests.ports import free_ports

DRIVERS = {
    "indi_lx200basic": "LX200 Basic",
    "indi_lx200generic": "Standard LX200",
    "indi_lx200classic": "LX200 Classic",
}
SPEED = 5
ROOT = Path(__file__).parents[3]
pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(300),
    pytest.mark.skipif(
        not all(map(shutil.which, ["indiserver", "indi_setprop", "indi_getprop", *DRIVERS])),
        reason="indi-bin is not installed (apt-get install indi-bin)",
    ),
]


@contextlib.contextmanager
def running(*command: object, ready: str, log: Path, **environment: str) -> Iterator[None]:
    """A program, from the moment it says `ready` until the end of the block."""
    with log.open("w") as output:
        process = subprocess.Popen(
            [str(word) for word in command], stdout=output, stderr=subprocess.STDOUT,
            env={**os.environ, **environment}, cwd=ROOT,
        )  # fmt: skip
        try:
            end = monotonic() + 120
            while ready not in log.read_text():
                assert process.poll() is None and monotonic() < end, log.read_text()
                sleep(0.1)
            yield
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(10)


class Indi:
    """One driver, by the command line tools."""

    def __init__(self, device: str, port: int) -> None:
        self.device = device
        self.port = port

    def set(self, kind: str, name: str, *values: tuple[str, object]) -> None:
        """kind: s switch, n number, x text."""
        what = ";".join(f"{element}={value}" for element, value in values)
        command = ["indi_setprop", "-p", str(self.port), f"-{kind}", f"{self.device}.{name}.{what}"]
        subprocess.run(command, check=True, timeout=20, capture_output=True)

    def get(self, name: str) -> str:
        command = ["indi_getprop", "-p", str(self.port), "-t", "3", "-1", f"{self.device}.{name}"]
        done = subprocess.run(command, check=False, timeout=20, capture_output=True, text=True)
        return done.stdout.strip()

    def until(self, name: str, *wanted: str, limit_s: float = 60.0) -> str:
        end = monotonic() + limit_s
        while (value := self.get(name)) not in wanted:
            assert monotonic() < end, f"{self.device}.{name} is {value!r}, not {wanted}"
            sleep(0.2)
        return value

    def connect(self, transport: str, where: str, port: int) -> None:
        self.until("CONNECTION.CONNECT", "Off", "On")
        if transport == "tcp":
            self.set("s", "CONNECTION_MODE", ("CONNECTION_TCP", "On"))
            self.until("CONNECTION_MODE.CONNECTION_TCP", "On")
            self.set("x", "DEVICE_ADDRESS", ("ADDRESS", "127.0.0.1"), ("PORT", port))
        else:
            self.set("s", "CONNECTION_MODE", ("CONNECTION_SERIAL", "On"))
            self.set("x", "DEVICE_PORT", ("PORT", where))
        for attempt in range(3):  # the drivers give a handshake two seconds of wall time; a user clicks again
            self.set("s", "CONNECTION", ("CONNECT", "On"))
            if self.until("CONNECTION._STATE", "Ok", "Alert") == "Ok":
                break
            print(f"{self.device}: connection {attempt + 1} refused by the driver")
        self.until("CONNECTION._STATE", "Ok", limit_s=1.0)
        self.set("n", "POLLING_PERIOD", ("PERIOD_MS", 200))

    def goto(self, ra_h: float, dec_deg: float) -> None:
        self.set("n", "EQUATORIAL_EOD_COORD", ("RA", ra_h), ("DEC", dec_deg))
        sleep(0.5)

    def off_arcsec(self, ra_h: float, dec_deg: float) -> float:
        ra = float(self.get("EQUATORIAL_EOD_COORD.RA"))
        dec = float(self.get("EQUATORIAL_EOD_COORD.DEC"))
        return max(abs(ra - ra_h) * 15, abs(dec - dec_deg)) * 3600


@pytest.fixture(scope="module")
def door(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[int, Path, Path]]:
    """TCP port, pseudo-terminal and logs of a served telescope, at night under today's sky."""
    folder = tmp_path_factory.mktemp("indi")
    port, pty = free_ports(), folder / "lx200"
    serve = [sys.executable, "-c", "from scenarios.cli import main; main()", "serve"]
    doors = ["--lx200", port, "--lx200", f"pty:{pty}", "--logs", folder, "--speed", SPEED]
    with running(*serve, *doors, ready="serving", log=folder / "serve.txt"):
        yield port, pty, folder


@pytest.fixture
def indi(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Indi]:
    """A driver of its own for each test: what one run leaves in it must not help or hurt the next."""
    port, driver = free_ports(), str(request.param)
    log = tmp_path / "indiserver.txt"
    # a socket name of its own: two servers with the default one (this file in two workers) end each other
    server = ("indiserver", "-p", port, "-u", f"schmidt-test-{port}", driver)
    with running(*server, ready="startup", log=log, HOME=str(tmp_path)):
        yield Indi(DRIVERS[driver], port)


def sidereal_h(indi: Indi) -> float:
    """Hour angle 0 is where the tube is parked: what the driver reads there is the sidereal time."""
    return float(indi.get("EQUATORIAL_EOD_COORD.RA"))


@pytest.mark.parametrize("transport", ["tcp", "serial"])
@pytest.mark.parametrize("indi", DRIVERS, indirect=True)
def test_connect_slew_read_back_abort_park(indi: Indi, door: tuple[int, Path, Path], transport: str) -> None:
    port, pty, _ = door
    indi.connect(transport, str(pty), port)
    sleep(1.0)
    # a place in whole seconds, as the protocol carries it
    ra = (round((sidereal_h(indi) + 0.4) * 3600) % 86400) / 3600
    dec = 20 + 11 / 60 + 7 / 3600 if float(indi.get("EQUATORIAL_EOD_COORD.DEC")) > 30 else 40.0
    indi.goto(ra, dec)
    indi.until("EQUATORIAL_EOD_COORD._STATE", "Ok")
    if indi.device == "LX200 Basic":  # it calls a slew done within 3', and goes on reading
        sleep(3.0)
    off = indi.off_arcsec(ra, dec)
    print(f"{indi.device} over {transport}: read back {off:.2f} arcsec off")
    assert off <= 10

    indi.goto((ra + 2.0) % 24, dec - 35.0)
    assert indi.get("EQUATORIAL_EOD_COORD._STATE") == "Busy"
    indi.set("s", "TELESCOPE_ABORT_MOTION", ("ABORT", "On"))
    indi.until("EQUATORIAL_EOD_COORD._STATE", "Idle", "Ok", "Alert", limit_s=5)
    sleep(1.0)
    stopped = float(indi.get("EQUATORIAL_EOD_COORD.DEC"))
    sleep(1.0)  # five seconds of the telescope
    assert abs(float(indi.get("EQUATORIAL_EOD_COORD.DEC")) - stopped) * 3600 <= 5
    assert abs(stopped - dec + 35.0) > 0.01  # it never arrived

    if indi.device == "LX200 Classic":  # parks by coordinates, in whole degrees of altitude and azimuth
        indi.set("n", "GEOGRAPHIC_COORD", ("LAT", 29.3667), ("LONG", 79.45), ("ELEV", 1950))
        indi.until("GEOGRAPHIC_COORD._STATE", "Ok")
        indi.set("n", "TELESCOPE_PARK_POSITION", ("PARK_AZ", 180), ("PARK_ALT", 70))
    if indi.device != "LX200 Basic":  # which cannot park
        indi.set("s", "TELESCOPE_PARK", ("PARK", "On"))
        indi.until("TELESCOPE_PARK._STATE", "Ok")
        assert indi.get("TELESCOPE_PARK.PARK") == "On"
        if indi.device == "Standard LX200":
            assert indi.get("EQUATORIAL_EOD_COORD.DEC").startswith("29.3")


@pytest.mark.parametrize("indi", ["indi_lx200generic"], indirect=True)
def test_a_refused_slew_is_an_alert(indi: Indi, door: tuple[int, Path, Path]) -> None:
    indi.connect("tcp", "", door[0])
    sleep(1.0)
    end = monotonic() + 60.0
    while True:  # a driver that is still busy with its first poll passes over what it is sent
        indi.goto((sidereal_h(indi) + 12) % 24, -40.0)
        if indi.get("EQUATORIAL_EOD_COORD._STATE") == "Alert":
            break
        assert monotonic() < end, "refused slews were no alert for a minute"
        sleep(1.0)
