"""Which doors are made of which options, how one attaches to them, and combinations that cannot be."""

from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import making
from scenarios.doors.making import Attached, attached, check, check_ports, make_doors
from scenarios.doors.options import ServeOptions
from scenarios.doors.table import ON_NETWORK, Asked, asked, named

BOARDS = ("AXIS_RA", "POSITION_RA", "FOCUS")


@pytest.mark.parametrize(
    ("name", "host", "ports"),
    [
        ("--control 7411 (token abc)", "127.0.0.1", [7411]),
        ("--serial tcp:7000", "127.0.0.1", [7000, 7001, 7002]),
        ("--serial tcp:[::1]:65533", "::1", [65533, 65534, 65535]),
        ("--serial tcp:65534", "", []),
        ("--console nonsense", "", []),
        ("--can socketcan:vcan0", "", []),
        ("--lx200 pty:handbox", "", []),
    ],
)
def test_a_door_on_TCP_has_its_ports(name: str, host: str, ports: list[int]) -> None:
    found = attached(name, BOARDS)
    assert (found.host, list(found.ports)) == (host, ports)


def test_words_of_what_is_not_known_are_what_was_asked_for() -> None:
    assert attached("--console nonsense", BOARDS) == Attached("nonsense")
    assert attached("--hid uhid", BOARDS).words == "uhid"
    last = attached("--serial tcp:65533", BOARDS).words
    assert last == "socket://127.0.0.1:65533 is AXIS_RA, and so on to port 65535, FOCUS"
    assert attached("--console [::1]:80", BOARDS).words == "open http://[::1]:80/"


@pytest.mark.parametrize("other", ["--control 6999", "--control 7003", "--control 192.0.2.1:7001"])
def test_ports_side_by_side_or_of_another_host_are_free(other: str) -> None:
    check_ports(["--serial tcp:7000", other], BOARDS)
    check_ports([other, other], BOARDS)  # one door is itself


def test_two_doors_want_one_port() -> None:
    with pytest.raises(ValueError) as caught:
        check_ports(["--control 7001", "--serial tcp:7000"], BOARDS)
    said = "--serial tcp:7000: --control 7001 takes the ports up to 7001; give one of them another"
    assert str(caught.value) == said


def options(**given: Any) -> ServeOptions:
    return ServeOptions(**given)


def test_serve_needs_a_door() -> None:
    with pytest.raises(ValueError) as caught:
        check(options(asked={"can": ()}))
    doors = "--can, --serial, --hid, --debug, --control, --lx200, --alpaca or --console"
    assert str(caught.value) == f"serve needs a door: {doors} (see schmidt serve -h)"
    check(options(asked={"can": ("virtual:x",)}))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"stars": "s", "asked": {"lx200": ("1",)}}, "--stars needs --alpaca, which has the cameras"),
        ({"frames": "f", "asked": {"lx200": ("1",)}}, "--frames needs --alpaca, which has the cameras"),
        (
            {"logs": "l", "asked": {"can": ("x",)}},
            "--logs is the host's: it needs --lx200, --alpaca or --console",
        ),
        (
            {"clock": "steps", "asked": {"can": ("x",)}},
            "--clock steps needs --control: nobody else could step",
        ),
    ],
)
def test_what_needs_another_door_is_said(given: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError) as caught:
        check(options(**given))
    assert str(caught.value) == said


@pytest.mark.parametrize(
    "given",
    [
        {"stars": "s", "frames": "f", "asked": {"alpaca": ("1",)}},
        {"logs": "l", "asked": {"console": ("1",)}},
        {"clock": "steps", "asked": {"control": ("1",)}},
        {"clock": "wall", "asked": {"can": ("x",)}},
    ],
)
def test_what_has_its_door_is_fine(given: dict[str, Any]) -> None:
    check(options(**given))


def test_doors_are_asked_for_by_their_numbers_in_the_table_s_order() -> None:
    wanted = options(asked={"control": ("1",), "can": ("a:b", "c:d")}, token="t")
    found = [(kind.name, each) for kind, each in asked(ON_NETWORK, wanted)]
    assert found == [
        ("can", Asked("a:b", 0, "t")),
        ("can", Asked("c:d", 1, "t")),
        ("control", Asked("1", 0, "t")),
    ]
    assert named(ON_NETWORK[:2], "and") == "--can and --serial"


@pytest.mark.parametrize("spec", ["pty:", "other:x", "tcp"])
def test_a_word_that_no_door_has_is_said(spec: str) -> None:
    serial = next(kind for kind in ON_NETWORK if kind.name == "serial")
    with pytest.raises(ValueError) as caught:
        serial.make(Asked(spec, 0, None), None)
    assert str(caught.value) == f'--serial "{spec}": expected pty:DIR or tcp:[HOST:]PORT'


class Network:
    """With a gateway or without."""

    def __init__(self, *boards: str) -> None:
        self.network = SimpleNamespace(boards=boards)
        self.lines = SimpleNamespace(uarts=BOARDS)


def made(network: Network, monkeypatch: pytest.MonkeyPatch, **given: tuple[str, ...]) -> list[Any]:
    live: Any = network
    own = [SimpleNamespace(name="--control 7411")] if "control" in given else []
    monkeypatch.setattr(making, "doors_on", lambda kinds, wanted, place: list(own))
    monkeypatch.setattr(making, "HostProcess", lambda *_: "the host")
    found: list[Any] = make_doors(options(asked=given), live)
    return found


def test_the_host_comes_last_if_a_door_stands_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = made(Network(), monkeypatch, control=("7411",))
    assert [each.name for each in alone] == ["--control 7411"]
    both = made(Network("GATEWAY"), monkeypatch, control=("7411",), lx200=("4030", "pty:x"))
    assert both[1:] == ["the host"] and both[0].name == "--control 7411"


@pytest.mark.parametrize(
    ("network", "given", "said"),
    [
        (Network(), {"lx200": ("4030",)},
         "--lx200, --alpaca and --console need the gateway: take --network lab or final"),
        (Network("GATEWAY"), {"lx200": ("x",)}, '--lx200 "x": expected [HOST:]PORT, for example 7411'),
        (Network("GATEWAY"), {"lx200": ("7411",), "control": ("7411",)},
         "--lx200 7411: --control 7411 takes the ports up to 7411; give one of them another"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_said_before_anything_starts(
    network: Network, given: dict[str, tuple[str, ...]], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ValueError) as caught:
        made(network, monkeypatch, **given)
    assert str(caught.value) == said
