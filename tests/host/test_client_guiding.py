"""The guide log of clients, on a telescope that is ticked by the test: what counts, and what does not."""

from pathlib import Path

import pytest

from calibration.inputs.guidelog import read_guide_log
from host.camera.camera import Order
from scenarios.doors.options import ServeOptions
from tests.doors.test_cameras import ALPACA, order, read_out
from tests.host.telescope.conftest import Rig


def exposed(rig: Rig, number: int = 1, lit: bool = True) -> None:
    camera = rig.pc.cameras[number]
    asked = order(camera, 0.5)
    camera.start(Order(seconds=asked.seconds, window=asked.window, lit=lit))
    rig.advance(0.6)
    read_out(camera)


@pytest.mark.slow
def test_a_session_is_a_star_and_what_a_client_sent_meanwhile(tmp_path: Path) -> None:
    log = tmp_path / "guiding.txt"
    log.write_text("of an earlier evening")
    rig = Rig(tmp_path)
    rig.host.open_cameras(ServeOptions(asked=ALPACA))
    rig.run(lambda t: t.drive.power_on())
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=-0.5)))
    for _ in range(3):
        exposed(rig)
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=-0.4)))
    rig.advance(10.0)  # the axes settle
    assert log.read_text() == "of an earlier evening"  # nobody has guided
    for direction, seconds in (("w", 0.5), ("w", 0.25), ("n", 0.3)):
        if seconds != 0.25:  # two pulses after one frame: one row
            exposed(rig)
        rig.do(lambda t, d=direction, s=seconds: t.paddle.pulse(d, s))  # type: ignore[misc]
        rig.advance(2.0)
    exposed(rig, lit=False)
    exposed(rig, number=0)
    rig.run(lambda t: t.drive.goto(rig.up(hour_angle_h=-0.3)))
    rig.advance(10.0)
    exposed(rig)
    rig.do(lambda t: t.paddle.pulse("s", 0.2))
    rig.advance(2.0)
    exposed(rig)
    rig.host.close()
    assert (tmp_path / "guiding.txt.1").read_text() == "of an earlier evening"
    rows = [line.split(",") for line in log.read_text().splitlines() if line[:1].isdigit()]
    assert [row[9:13] for row in rows] == [
        ["750", "W", "0", ""], ["0", "", "300", "N"], ["0", "", "200", "S"], ["0", "", "0", ""],
    ]  # fmt: skip
    runs = read_guide_log(log)
    assert [len(run.columns["t"]) for run in runs] == [2, 2]
    # 0.75 s at 7.52″/s of hour angle, 20° north: the star goes 5.30″ to the east; positive is west
    assert float(rows[1][5]) * 1.9337 == pytest.approx(-5.30, abs=0.5)
    for run in runs:
        assert abs(run.columns["ra"]).max() < 0.5 and abs(run.columns["dec"]).max() < 0.5
