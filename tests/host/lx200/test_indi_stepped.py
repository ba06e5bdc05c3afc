"""INDI's driver as Debian packages it, on a telescope whose time another client steps."""

import threading
from pathlib import Path
from time import sleep

from scenarios.doors.stepped import Stepped
from tests.doors.process import Serving
from tests.host.lx200 import test_indi
from tests.host.lx200.test_indi import Indi, running, sidereal_h
from tests.ports import free_ports

STEP, EVERY_S = "100 ms", 0.02
"""Five times real time, as long as the machine can."""
pytestmark = test_indi.pytestmark


class Hand(threading.Thread):
    """Steps the time until it is told to stop."""

    def __init__(self, control: int) -> None:
        super().__init__(daemon=True)
        self._control = str(control)
        self._over = threading.Event()

    def run(self) -> None:
        with Stepped(self._control) as clock:
            while not self._over.wait(EVERY_S):
                clock.step(STEP)

    def stop(self) -> None:
        self._over.set()
        self.join(30)


def test_a_driver_that_nobody_changed_is_served_while_somebody_steps(tmp_path: Path) -> None:
    lx200, port = free_ports(), free_ports()
    server = ("indiserver", "-p", port, "-u", f"schmidt-test-{port}", "indi_lx200basic")
    with Serving(tmp_path, "--clock", "steps", "--lx200", str(lx200)) as serving:
        assert serving.status()["simulated_s"] == 0  # it stands until somebody steps
        hand = Hand(serving.control)
        hand.start()
        try:
            while serving.status()["simulated_s"] < 5:  # boards have been heard
                sleep(0.2)
            with running(*server, ready="startup", log=tmp_path / "indi.txt", HOME=str(tmp_path)):
                indi = Indi("LX200 Basic", port)
                indi.connect("tcp", "", lx200)
                sleep(1.0)
                ra = (round((sidereal_h(indi) + 0.4) * 3600) % 86400) / 3600
                dec = 40.0
                indi.goto(ra, dec)
                indi.until("EQUATORIAL_EOD_COORD._STATE", "Ok", limit_s=120)
                sleep(3.0)  # it calls a slew done within 3', and goes on reading
                off = indi.off_arcsec(ra, dec)
        finally:
            hand.stop()
        before = serving.status()["simulated_s"]
        sleep(0.5)
        assert serving.status()["simulated_s"] == before  # and stands again
    print(f"read back {off:.2f} arcsec off")
    assert off <= 10
