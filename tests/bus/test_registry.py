"""Wires by name, and one arcsecond."""

import math
from collections.abc import Iterator

import pytest

from bus import units
from bus.can import Wire
from bus.registry import NameTakenError, named, publish, withdraw
from bus.time import EventQueue

NAME = "test-registry"


@pytest.fixture(autouse=True)
def forgotten() -> Iterator[None]:
    yield
    withdraw(NAME)


def test_a_name_that_nobody_has_makes_a_wire_of_its_own() -> None:
    wire = named(NAME)
    assert wire.bit_ns == 1000  # 1 Mbit/s
    assert named(NAME, 500_000) is wire  # the first who opens it says how quick it is
    withdraw(NAME)
    slow = named(NAME, 500_000)
    assert slow is not wire and slow.bit_ns == 2000
    assert slow.queue is not wire.queue


def test_a_wire_that_is_published_is_the_one_that_is_found() -> None:
    wire = Wire(EventQueue())
    publish(NAME, wire)
    publish(NAME, wire)  # the same again is no other
    assert named(NAME) is wire
    with pytest.raises(NameTakenError, match=rf'channel "{NAME}" is already published'):
        publish(NAME, Wire(EventQueue()))
    assert named(NAME) is wire
    withdraw(NAME)
    withdraw(NAME)
    publish(NAME, Wire(EventQueue()))
    assert named(NAME) is not wire


def test_an_arcsecond_is_a_sixtieth_of_a_sixtieth_of_a_degree() -> None:
    assert units.ARCSEC_PER_TURN == 360 * 60 * 60
    assert math.degrees(units.ARCSEC) == pytest.approx(1 / 3600)
    assert math.degrees(1 / units.ARCSEC_PER_RAD) == pytest.approx(1 / 3600)
