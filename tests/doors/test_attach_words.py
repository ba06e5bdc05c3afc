"""Every door says how to attach to it, and two of them never want one port."""

import pytest

from scenarios.doors.making import attached, check_ports

BOARDS = ("AXIS_RA", "POSITION_RA", "FOCUS")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("--console 8080", "open http://127.0.0.1:8080/"),
        ("--alpaca 0.0.0.0:11111", "ASCOM Alpaca at http://0.0.0.0:11111/"),
        ("--lx200 4030", "LX200 over TCP, 127.0.0.1:4030"),
        ("--control 7411", "schmidt control status --at 127.0.0.1:7411"),
        ("--can socketcan:vcan0", "python-can: interface=socketcan, channel=vcan0"),
        ("--serial tcp:7000", "socket://127.0.0.1:7000 is AXIS_RA, and so on to port 7002, FOCUS"),
        ("--serial tcp:[::1]:7000", "socket://[::1]:7000 is AXIS_RA, and so on to port 7002, FOCUS"),
        ("--lx200 pty:handbox", "pty:handbox"),
        ("--hid unix:gateway", "unix:gateway"),
        ("--debug ports", "slcan in ports"),
        ("--serial pty:lines", "lines/AXIS_RA, lines/POSITION_RA, lines/FOCUS"),
    ],
)
def test_a_door_says_how_to_attach(name: str, said: str) -> None:
    assert attached(name, BOARDS).words == said


def test_two_doors_do_not_want_one_port() -> None:
    check_ports(["--serial tcp:7000", "--control 7003"], BOARDS)
    with pytest.raises(ValueError, match="--control 7002: --serial tcp:7000 takes the ports up to 7002"):
        check_ports(["--serial tcp:7000", "--control 7002"], BOARDS)
