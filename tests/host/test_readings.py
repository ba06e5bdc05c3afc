"""Readings of the last frames in units people read, and a guide log in PHD2's words, by hand."""

import datetime as dt
from math import cos, radians
from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.protocol import Device
from bus.protocol.motion import pack_focus, pack_motion, pack_tach
from bus.protocol.position import pack_position
from host.camera.models import GUIDE
from host.client import Client
from host.link import HidLink
from host.logs import guidelog
from host.logs.journal import Logs
from host.logs.sensors import readings
from host.procedures.autoguide import Guided
from host.sky.catalogue import Star
from host.sky.mount import CENTRE_STEPS, AxisScale
from host.sky.observed import Clock

SCALE = AxisScale(CENTRE_STEPS, 0, 2**29)
MOUNT: Any = Some(ra=SCALE, dec=SCALE)


def told(*frames: bytes) -> dict[str, str]:
    """Words and numbers of what these frames say."""
    link = HidLink(lambda *_: None)
    for each in frames:
        link.measurements[each[0]], link.measured_ns[each[0]] = each, 0
    client = Client(link, Logs())
    return dict(word.split("=") for word in readings(client, MOUNT).split())


def test_nothing_is_said_of_what_has_not_come() -> None:
    assert told() == {}


def test_an_encoder_says_degrees_from_its_zero() -> None:
    """2^29 steps a turn: an eighth of them is 45 degrees."""
    found = told(pack_position(Device.POSITION_DEC, 0, CENTRE_STEPS + 2**26, 0, 0))
    assert found == {"dec_deg": "45.000000"}
    assert told(pack_position(Device.POSITION_RA, 0, CENTRE_STEPS - 2**25, 0, 0)) == {"ra_deg": "-22.500000"}


def test_a_motion_says_rate_effort_and_currents() -> None:
    """A count of the roller encoder in 5 ms is 2.296 arcsec/s (paper: 0.01148 arcsec); 6.1 mA a count."""
    found = told(pack_motion(Device.AXIS_RA, 0, 200, -321, (100, 250)))
    assert float(found.pop("ra_rate")) == pytest.approx(200 * 1296000 / (4.608e6 * 24.5) / 0.005, abs=0.01)
    assert found == {"ra_effort": "-321", "ra_current_a": "0.610", "ra_current_b": "1.525"}


def test_motors_and_focus_say_their_counts() -> None:
    found = told(
        pack_tach(Device.MOTOR_RA_A, 0, 5, -7), pack_tach(Device.MOTOR_DEC_B, 0, 5, 9),
        pack_focus(Device.FOCUS, 0, -120, 33, 2047),
    )  # fmt: skip
    assert found == {
        "ra_tach_a": "-7", "dec_tach_b": "9", "focus": "-120", "focus_encoder": "33", "focus_lvdt": "2047"
    }  # fmt: skip


CLOCK = Clock(dt.datetime(2026, 2, 10, 14, 0, 0, tzinfo=dt.UTC))
STAR = Star("a star", 1.0, radians(60.0))


def section(*frames: Guided) -> list[str]:
    text = guidelog.section(
        "a night", 30.0, STAR, CLOCK, frames, exposure_s=2.0, algorithm="any", longest_s=1.5
    )
    return text.splitlines()


def test_a_session_says_its_time_scale_and_speeds() -> None:
    frame = Guided(t_s=95.0, off=(0.0, 0.0), sent=(0.0, 0.0), pulses_s=(0.0, 0.0))
    lines = section(frame)
    px = GUIDE.pixel_m / GUIDE.focal_length_m * 206264.806
    assert lines[0] == "Guiding Begins at 2026-02-10 14:00:30"
    assert lines[-2:] == ["Guiding Ends at 2026-02-10 14:01:35", ""]
    assert (
        f"Pixel scale = {px:.4f} arc-sec/px, Binning = 1, Focal length = {GUIDE.focal_length_m * 1e3:.0f} mm"
        in lines
    )
    assert "Exposure = 2000 ms" in lines and "Dec = 60.0 deg" in lines
    assert "Max RA duration = 1500, Max DEC duration = 1500, DEC guide mode = Auto" in lines
    half = 15.041067 / 2
    (mount,) = (line for line in lines if line.startswith("Mount = "))
    assert f"xRate = {half * cos(radians(60.0)) / px:.3f}, yAngle = 90.0, yRate = {half / px:.3f}," in mount
    assert "RA Guide Speed = 7.5 a-s/s, Dec Guide Speed = 7.5 a-s/s" in lines
    assert f"Lock position = {GUIDE.width / 2:.3f}, {GUIDE.height / 2:.3f}" in lines
    assert section()[-2] == "Guiding Ends at 2026-02-10 14:00:30"


def test_a_frame_says_pixels_and_pulses_by_their_direction() -> None:
    """North is up on the sky and down in PHD2's distances; a pulse is a length in ms and a letter."""
    px = GUIDE.pixel_arcsec
    frames = (
        Guided(t_s=32.5, off=(px, 2 * px), sent=(0.5 * px, -px), pulses_s=(0.25, -1.5)),
        Guided(t_s=36.25, off=(-3 * px, 0.0), sent=(0.0, 0.0), pulses_s=(0.0, 0.4)),
        Guided(t_s=38.0, off=(0.0, 0.0), sent=(0.0, 0.0), pulses_s=(-0.1, 0.0)),
    )
    rows = [line for line in section(*frames) if line[:1].isdigit()]
    assert rows[0] == '1,2.500,"Mount",1.000,-2.000,1.000,-2.000,0.500,1.000,250,W,1500,S,,,,,0'
    assert rows[1].replace("-0.000", "0.000") == (
        '2,6.250,"Mount",-3.000,0.000,-3.000,0.000,0.000,0.000,0,,400,N,,,,,0'
    )
    assert rows[2].split(",")[9:13] == ["100", "E", "0", ""]


def test_the_opening_and_the_algorithm_are_in_phd2_s_words() -> None:
    assert guidelog.opening("1.2", CLOCK, 61.0) == (
        "PHD2 version 2.6, written by schmidt 1.2, Log version 2.5. Log enabled at 2026-02-10 14:01:01\n"
    )
    least = 0.2 / GUIDE.pixel_arcsec
    assert guidelog.hysteresis(0.7) == (
        f"Hysteresis, Hysteresis = 0.000, Aggression = 0.700, Minimum move = {least:.3f}"
    )
