"""Values up to the last one that may stand: settings by LX200, frames of boards, sites, and polynomials."""

import asyncio
import math
from types import SimpleNamespace as Some
from typing import Any

import can
import numpy as np
import pytest

from bus.protocol import HEARTBEAT_KIND, SUMMARY_KIND
from bus.protocol.report import REPORT_BYTES
from host.links.ports import CanPort
from host.lx200 import setting
from host.sky.pointsmooth import _polynomials
from host.sky.site import Site


def session() -> Any:
    here = Some(latitude_rad=math.radians(29.25), longitude_rad=math.radians(79.5))
    said: list[str] = []
    return Some(
        telescope=Some(observatory=Some(site=here)), box=Some(utc_offset_h=None), say=said.append, said=said
    )


@pytest.mark.parametrize(("text", "taken"), [
    ("00:00:00", True), ("23:59:59", True), ("24:00:00", False), ("-01:00:00", False), ("-00:00:01", False),
])  # fmt: skip
def test_a_right_ascension_is_within_a_day(text: str, taken: bool) -> None:
    given = session()
    answer = asyncio.run(setting._answering(setting.right_ascension)(given, text))
    assert answer == ("1" if taken else "0") and bool(given.said) is not taken
    if taken:
        hours = sum(float(part) / 60**k for k, part in enumerate(text.split(":")))
        assert given.target_ra_rad == pytest.approx(hours * math.pi / 12)


@pytest.mark.parametrize(("hours", "taken"), [
    ("-14", True), ("14.0", True), ("-14.5", False), ("14.1", False), ("5.5", True), ("noon", False),
])  # fmt: skip
def test_an_offset_from_utc_is_one_that_some_place_has(hours: str, taken: bool) -> None:
    """The farthest are fourteen hours ahead (Kiribati)."""
    given = session()
    answer = asyncio.run(setting._answering(setting.utc_offset)(given, hours))
    assert answer == ("1" if taken else "0")
    assert given.box.utc_offset_h == (float(hours) if taken else None)


@pytest.mark.parametrize(("what", "degrees", "taken"), [
    ("latitude", "+29*15", True), ("latitude", "+29*44", True), ("latitude", "+28*46", True),
    ("latitude", "+29*46", False), ("latitude", "+28*44", False), ("longitude", "280*30", True),
    ("longitude", "-079*30", True), ("longitude", "280*59", True), ("longitude", "281*01", False),
    ("longitude", "279*59", False), ("longitude", "079*30", False),
])  # fmt: skip
def test_a_site_half_a_degree_away_is_another_one(what: str, degrees: str, taken: bool) -> None:
    """West is positive: 79.5 degrees east are 280.5 west."""
    answer = asyncio.run(setting._answering(getattr(setting, what))(session(), degrees))
    assert answer == ("1" if taken else "0")


@pytest.mark.parametrize(("low", "degrees", "taken"), [
    (0, "00*00", True), (0, "90*00", True), (0, "90*01", False), (0, "-00*01", False), (-90, "-90*00", True),
])  # fmt: skip
def test_an_angle_is_within_its_ends(low: int, degrees: str, taken: bool) -> None:
    given = session()
    assert asyncio.run(setting._degrees("target", "it", low, 90)(given, degrees)) == ("1" if taken else "0")
    assert hasattr(given, "target") is taken


@pytest.mark.parametrize(("identifier", "kind", "passed"), [
    (0x111, 0x10, True), (0x211, 0x00, True), (0x311, SUMMARY_KIND, True), (0x711, HEARTBEAT_KIND, True),
    (0x091, 0x10, False), (0x311, 0x00, False), (0x711, 0x00, False), (0x411, 0x00, False),
    (0x212, 0x00, False), (0x100, 0x00, False), (0x7FF, 0x00, False),
])  # fmt: skip
def test_frames_of_others_are_passed_over(identifier: int, kind: int, passed: bool) -> None:
    """Of board 0x11: reply, measurement, summary and heartbeat. A stranger's frame once broke the link."""
    data = bytes([0x11, kind, *bytes(6)])
    messages = [
        can.Message(arbitration_id=identifier, data=data, is_extended_id=False),
        can.Message(arbitration_id=identifier, data=data[:7], is_extended_id=False),
        can.Message(arbitration_id=identifier, data=data, is_extended_id=True),
        can.Message(arbitration_id=identifier, data=data, is_extended_id=False, is_error_frame=True),
        None,
    ]
    port = CanPort.__new__(CanPort)
    port._bus = Some(recv=lambda _: messages.pop(0))  # type: ignore[assignment]
    assert [len(port.read()) for _ in range(5)] == [REPORT_BYTES if passed else 0, 0, 0, 0, 0]


@pytest.mark.parametrize(("latitude_deg", "humidity", "good"), [
    (90.0, 0.0, True), (-90.0, 1.0, True), (90.1, 0.5, False), (-90.1, 0.5, False), (0.0, -0.01, False),
    (0.0, 1.01, False),
])  # fmt: skip
def test_a_site_is_on_the_earth_in_air(latitude_deg: float, humidity: float, good: bool) -> None:
    numbers = math.radians(latitude_deg), 0.3, 1951.0, 810.0, 5.0, humidity
    if good:
        assert Site(*numbers).erfa == (0.0, 0.3, numbers[0], 1951.0, 0.0, 0.0, 810.0, 5.0, humidity, 0.55)
    else:
        with pytest.raises(ValueError, match="is outside"):
            Site(*numbers)


def test_polynomials_are_legendres_over_the_range_each_way() -> None:
    """P1 to P4 at -1, 0, 1 of the range; east-west has nothing north-south."""
    values = np.array([10.0, 30.0, 50.0])
    expected = np.array([[-1.0, 1.0, -1.0, 1.0], [0.0, -0.5, 0.0, 0.375], [1.0, 1.0, 1.0, 1.0]])
    east, north = _polynomials(values)
    assert east == pytest.approx(np.vstack([expected, np.zeros((3, 4))]))
    assert north == pytest.approx(np.vstack([np.zeros((3, 4)), expected]))
