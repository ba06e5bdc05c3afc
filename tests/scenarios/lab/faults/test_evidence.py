"""Every fault of the table proves that it acted where it must, and does not where it cannot."""

import re
from collections.abc import Callable

import pytest

from bus.protocol import Device, Opcode
from scenarios.lab.faults.table import KINDS
from scenarios.lab.layers import Evidence
from tests.scenarios.lab.faults.lab import EXAMPLES, Lab

PULL = (Device.AXIS_RA, Opcode.OPEN_LOOP)
FRAME, SAMPLE = r"frame [0-9A-F]{3}#([0-9A-F]{2}){0,8}", r"sample of ra\.\w+"
DUTIES, SUPPLY = "duties of ra", "supply of POSITION_RA"
ON = {
    "wrong_bitrate": r"\w+ error at DISPLAY", "stuck_dominant": r"\w+ error at \w+",
    "node_off": SUPPLY, "brown_out": SUPPLY, "reset": SUPPLY,
    "hang": rf"interrupt of POSITION_RA|{FRAME}", "late_interrupts": rf"interrupt of POSITION_RA|{FRAME}",
    "crystal_drift": "timer interrupt of POSITION_RA",
    "endat_line": "transfer of POSITION_RA", "serial_noise": "RS232 packet of POSITION_RA",
    "pwm_stuck": DUTIES, "motor_open": DUTIES, "mosfet_short": DUTIES, "weak_supply": DUTIES,
    "emergency_stop": "safety chain",
    "friction_change": SAMPLE, "load_change": SAMPLE, "play_change": SAMPLE,
}  # fmt: skip
"""What each acts on first; the sensors' on a sample, all others on a frame."""


def started(lab: Lab, name: str) -> Evidence:
    lab.network.uarts["POSITION_RA"].sink = lambda _t_ns, _data: None
    lab.faults.start(name, **EXAMPLES[name])
    return lab.faults.evidence[-1]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_fault_says_when_it_first_acted_and_on_what(kind: object) -> None:
    name = kind.name  # type: ignore[attr-defined]
    lab = Lab().pull()
    evidence = started(lab, name)
    lab.run(0.05)
    for effort in (900, 2500):  # duties that change, for a PWM that does not follow
        lab.command(*PULL, effort)
        lab.run(0.15)
    assert evidence.first_ns is not None and evidence.at_ns <= evidence.first_ns <= lab.now_ns
    assert re.fullmatch(ON.get(name, SAMPLE if name.startswith("sensor") else FRAME), evidence.on)
    first = (evidence.first_ns, evidence.on)
    lab.run(0.1)
    assert (evidence.first_ns, evidence.on) == first, "the first time is kept"


def off(*boards: str) -> Callable[[Lab], None]:
    def act(lab: Lab) -> None:
        for board in boards:
            lab.network.boards[board].power_off(lab.now_ns)

    return act


def held(lab: Lab) -> None:
    lab.faults.start("stuck_dominant")


def silent(lab: Lab) -> None:
    off(*lab.network.boards)(lab)
    lab.node.port.online = False


def shorted(lab: Lab) -> None:
    lab.faults.start("mosfet_short", **EXAMPLES["mosfet_short"])


def pressed(lab: Lab) -> None:
    lab.faults.start("emergency_stop")


def at_rest(_lab: Lab) -> None:
    """Nobody commands: the motors have no duty."""


def without_supply(lab: Lab) -> None:
    lab.faults.start("node_off", node="POSITION_RA")  # a reset would boot a board that is only off


HEARD, UNREAD = off("POSITION_RA"), off("AXIS_RA")
CANNOT: dict[str, Callable[[Lab], None]] = {
    "bit_errors": silent, "babbler": held, "partition": off("AXIS_RA", "POSITION_RA"),
    "wrong_bitrate": off("DISPLAY"), "duplicate_node": held, "forged_sender": held, "stuck_dominant": silent,
    "node_off": HEARD, "brown_out": HEARD, "reset": without_supply, "hang": HEARD, "crystal_drift": HEARD,
    "late_interrupts": HEARD, "frame_loss": HEARD, "deaf_controller": off("AXIS_RA"), "endat_line": HEARD,
    "serial_noise": HEARD, "pwm_stuck": at_rest, "sensor_stuck": HEARD, "sensor_noise": HEARD,
    "sensor_bias": HEARD, "sensor_scale": HEARD, "sensor_delayed": HEARD, "sensor_intermittent": HEARD,
    "motor_open": at_rest, "mosfet_short": shorted, "emergency_stop": pressed, "weak_supply": at_rest,
    "friction_change": UNREAD, "load_change": UNREAD, "play_change": UNREAD,
}  # fmt: skip
"""What keeps each from acting, arguments being the same."""


def test_every_fault_is_kept_from_acting_somehow() -> None:
    assert list(CANNOT) == [kind.name for kind in KINDS]


@pytest.mark.parametrize("name", CANNOT)
def test_a_fault_that_cannot_act_has_no_evidence(name: str) -> None:
    lab = Lab().run(0.1)
    CANNOT[name](lab)
    evidence = started(lab, name)
    lab.run(0.4)
    assert evidence.first_ns is None and evidence.on == ""
    lab.faults.clear(lab.faults.running[-1].number)
    if name not in ("node_off", "brown_out"):  # to end those is to switch on a board that was off
        assert evidence.first_ns is None


@pytest.mark.parametrize(
    ("name", "changed"),
    [
        ("wrong_bitrate", {"bitrate": "1 Mbit/s"}),
        ("crystal_drift", {"ppm": 0}),
        ("sensor_bias", {"offset": 0}),
        ("friction_change", {"factor": 1.0}),
        ("weak_supply", {"factor": "100 %"}),
        ("play_change", {"angle": "0 arcsec"}),
        ("bit_errors", {"probability": 0.0}),
    ],
)
def test_a_fault_that_changes_nothing_never_acts(name: str, changed: dict[str, object]) -> None:
    lab = Lab().pull()
    lab.faults.start(name, **{**EXAMPLES[name], **changed})
    lab.run(0.3)
    assert lab.faults.evidence[-1].first_ns is None


@pytest.mark.parametrize("name", ["node_off", "hang", "stuck_dominant"])
def test_of_two_the_one_that_lasts_longer_has_acted_too(name: str) -> None:
    lab = Lab().run(0.1)
    one = lab.faults.start(name, **EXAMPLES[name])
    lab.run(0.1)
    two = lab.faults.start(name, **EXAMPLES[name])
    lab.run(0.1)
    lab.faults.clear(one)
    lab.run(0.1)
    assert lab.faults.evidence[1].first_ns is None
    lab.faults.clear(two)
    assert lab.faults.evidence[1].first_ns == lab.now_ns
