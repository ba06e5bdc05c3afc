"""Options of `schmidt serve` and `schmidt host` as they are by themselves."""

from pathlib import Path

import pytest

from scenarios.doors.options import HostOptions, ServeOptions
from tests.scenarios.studies.test_options import asked


def test_a_network_is_served_at_real_time_until_it_is_ended() -> None:
    found = asked(ServeOptions)
    assert found == ServeOptions()
    assert (found.speed, found.clock, found.duration, found.realtime) == (1.0, "wall", None, None)
    assert (found.scenario, found.asked, found.runs, found.logs) == (None, {}, Path("out/console"), None)


@pytest.mark.parametrize(("words", "realtime"), [(("--realtime",), True), (("--no-realtime",), False)])
def test_ticks_may_be_asked_to_come_first(words: tuple[str, ...], realtime: bool) -> None:
    assert asked(ServeOptions, *words).realtime is realtime


def test_a_host_has_any_number_of_lines_and_needs_a_gateway() -> None:
    found = asked(HostOptions, "--usb", "unix:u", "--serial", "AXIS_RA=a", "--serial", "FOCUS=b")
    assert (found.usb, found.serial) == ("unix:u", ("AXIS_RA=a", "FOCUS=b"))
    assert asked(HostOptions, "--usb", "unix:u").serial == () and "--usb" in asked(HostOptions)
