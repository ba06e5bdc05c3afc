"""`schmidt serve --alpaca PORT`, as a user starts it, and alpyca on it."""

import socket
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import pytest
from alpaca.exceptions import NotImplementedException, ParkedException
from alpaca.focuser import Focuser
from alpaca.telescope import Telescope

ROOT = Path(__file__).parents[3]
SCENARIO = ROOT / "scenarios" / "observing-night.yaml"
PROGRAM = "from scenarios.cli import main; main()"


def answers(telescope: Telescope) -> bool:
    try:
        _ = telescope.Connected
        return True
    except OSError:  # requests' errors are
        return False


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_the_command_line_opens_the_alpaca_door(tmp_path: Path) -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    command = [sys.executable, "-c", PROGRAM, "serve", str(SCENARIO), "--alpaca", str(port), "--speed", "10"]
    said = tmp_path / "said.txt"
    with said.open("w") as out:
        process = subprocess.Popen(command, cwd=ROOT, stdout=out, stderr=subprocess.STDOUT)
    try:
        telescope = Telescope(f"localhost:{port}", 0)
        end = monotonic() + 120
        while not answers(telescope):
            assert process.poll() is None and monotonic() < end, said.read_text()
            sleep(0.2)
        telescope.Connected = True
        while not telescope.AtPark:  # known once the encoders have been heard
            assert monotonic() < end, said.read_text()
            sleep(0.2)
        with pytest.raises(ParkedException):
            telescope.AbortSlew()
        telescope.Unpark()
        with pytest.raises(NotImplementedException):
            telescope.FindHome()
        telescope.Tracking = True
        aim = (telescope.SiderealTime - 0.2) % 24, 20.0
        telescope.SlewToCoordinatesAsync(*aim)
        while telescope.Slewing:
            assert monotonic() < end + 180, said.read_text()
            sleep(0.2)
        assert telescope.RightAscension * 54000 == pytest.approx(aim[0] * 54000, abs=10)
        assert telescope.Declination * 3600 == pytest.approx(aim[1] * 3600, abs=10)
        focuser = Focuser(f"localhost:{port}", 0)
        focuser.Connected = True
        assert focuser.MaxStep == 1600
    finally:
        process.terminate()
        process.wait(60)
