"""The end of serving: both axes parked whatever that takes, or the words say which is not, and why."""

import os
import signal
from pathlib import Path

import can
import pytest

from bus.outside.lockstep import LockstepBus
from bus.protocol import COMMAND_BASE, Device, Opcode, SpeedClass, pack_command
from bus.protocol.report import pack_report
from host.sky.mount import STEP_ARCSEC
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.parking import BEGUN, park
from scenarios.lab.prepare import chosen
from tests.doors.conftest import MS

AXES = (Device.AXIS_RA, Device.AXIS_DEC)
NEAR_ARCSEC = 60.0
"""As near counts as parked when the next host looks (`host.telescope.drive`)."""


@pytest.fixture
def served() -> LiveNetwork:
    """Both axes on, and six degrees away at slew speed."""
    served = LiveNetwork(*chosen())
    plug = served.usb.plug("pc")
    served.run_until(1_500 * MS)
    plug.write(0, pack_report([pack_command(axis, Opcode.POWER, 1) for axis in AXES]))
    served.run_until(1_700 * MS)
    plug.write(0, pack_report([pack_command(axis, Opcode.SET_CLASS, SpeedClass.SLEW, 1) for axis in AXES]))
    served.run_until(5_000 * MS)
    plug.unplug()
    return served


def off_park(served: LiveNetwork) -> list[float]:
    """How far RA and Dec are from the park position by their encoders, ″."""
    mount = served.scenario.mount
    goals = (mount.ra.steps(mount.park_hour_angle_rad), mount.dec.steps(mount.park_declination_rad))
    ports = (served.network.plant.ra, served.network.plant.dec)
    return [
        abs(port.absolute(served.now_ns) - goal) * STEP_ARCSEC
        for port, goal in zip(ports, goals, strict=True)
    ]


def test_parks_however_far_it_is_and_says_so(served: LiveNetwork) -> None:
    assert min(off_park(served)) > 5 * 3600
    said: list[str] = []
    assert park(served, said.append) == "parked, motors off"
    assert said == [BEGUN]
    assert max(off_park(served)) < NEAR_ARCSEC


def test_nodes_that_an_outside_master_has_silenced_are_started_and_parked(tmp_path: Path) -> None:
    file = tmp_path / "canopen.yaml"
    file.write_text(
        "name: x\nstart_utc: 2026-02-10T14:00:00Z\nnetwork: {canopen: true}\nsteps:\n  - power_on: {}\n"
    )
    served = LiveNetwork(*chosen(file))
    master = LockstepBus(served.network.wire, lambda _message: None)

    def say(identifier: int, data: bytes) -> None:
        master.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))
        served.run_until(served.now_ns + 1_000 * MS)

    served.run_until(1_000 * MS)
    say(0, b"\x01\x00")
    for axis in AXES:
        say(COMMAND_BASE + axis, pack_command(axis, Opcode.POWER, 1))
        say(COMMAND_BASE + axis, pack_command(axis, Opcode.SET_CLASS, SpeedClass.SLEW, 1))
    say(0, b"\x80\x00")
    master.shutdown()
    assert min(off_park(served)) > 3600
    assert park(served, lambda _line: None) == "parked, motors off"
    assert max(off_park(served)) < NEAR_ARCSEC


def test_motors_that_are_off_need_nothing() -> None:
    said: list[str] = []
    assert park(LiveNetwork(*chosen()), said.append) == "the motors were off" and not said


def test_an_axis_that_does_not_hear_is_named_and_the_other_parks(served: LiveNetwork) -> None:
    served.start_fault("deaf_controller", node="AXIS_DEC")
    words = park(served, lambda _: None)
    assert words == (
        "AXIS_DEC is not parked (AXIS_DEC: TRACK_RATE 0: no answer after 3 tries); the motors of AXIS_DEC "
        "may be on (AXIS_DEC: POWER 0: no answer after 3 tries); AXIS_RA is parked"
    )
    assert off_park(served)[0] < NEAR_ARCSEC


@pytest.mark.slow
def test_an_axis_that_does_not_come_is_named_after_its_time(served: LiveNetwork) -> None:
    served.start_fault("pwm_stuck", axis="ra")
    words = park(served, lambda _: None)
    assert words.startswith("AXIS_RA is not parked (") and words.endswith("AXIS_DEC is parked")
    assert off_park(served)[1] < NEAR_ARCSEC


def test_an_axis_without_supply_is_silent(served: LiveNetwork) -> None:
    served.switch("AXIS_RA", False)
    served.run_until(served.now_ns + 100 * MS)
    assert park(served, lambda _: None) == (
        "AXIS_RA is silent, its motors are as they were (no frame: not within 1 s); AXIS_DEC is parked"
    )


def test_another_signal_stops_both_where_they_are(served: LiveNetwork) -> None:
    words = park(served, lambda _: os.kill(os.getpid(), signal.SIGINT))
    assert words == "AXIS_RA is not parked (interrupted); AXIS_DEC is not parked (interrupted)"
    assert min(off_park(served)) > 3600
    before = off_park(served)
    served.run_until(served.now_ns + 1_000 * MS)
    assert off_park(served) == pytest.approx(before, abs=10.0)
