"""The safety chain over a stub network: when it looks, what opens it, what closes it, and its words."""

from math import ceil
from types import SimpleNamespace
from typing import Any

import pytest

from boards.core import PeriodicBoard
from bus.can import Frame
from bus.protocol import MEASUREMENT_BASE, AxisMode
from scenarios.lab import chain
from scenarios.lab.chain import SWITCHES, WATCHDOG, Chain, board_of, chained
from scenarios.native.finder import compiled
from tests.scenarios.lab.faults.stub import Queue

MS = 1_000_000
ENDS = {"ra": (-1.0, 2.0), "dec": (-3.0, 3.0)}
FASTEST = 1.5 * 24.0 / (0.5 * 360.48863990040456)
"""rad/s of an axis: no load, half more than the supply, 0.5 V s/rad and the gear."""


class Times(Queue):
    """Tells when the next call is due."""

    def next_ns(self) -> int:
        return min(t_ns for t_ns, _ in self.due)


class Rig:
    """Two axes at angles; boards that feed their watchdogs by their ticks; cuts: motors without supply."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, guards: tuple[str, ...] = ()) -> None:
        self.angles, self.cuts, self.told = {"ra": 0.0, "dec": 0.0}, list[str](), list[tuple[int, str]]()
        self.queue, self.taps = Times(), list[Any]()
        motor = SimpleNamespace(torque_constant=SimpleNamespace(si=0.5))
        axes = {axis: SimpleNamespace(truth=lambda t_ns, axis=axis: (self.angles[axis],)) for axis in ENDS}
        supply = SimpleNamespace(voltage=SimpleNamespace(si=24.0))
        parts = SimpleNamespace(ra=SimpleNamespace(motor=motor), dec=SimpleNamespace(motor=motor))
        plant = SimpleNamespace(model=SimpleNamespace(supply=supply, axes=parts), **axes)
        self.boards = {
            board_of(axis): SimpleNamespace(device_type=k, epoch_ns=0, ticks=0, period_ns=5 * MS)
            for k, axis in enumerate(ENDS, 1)
        }
        wire = SimpleNamespace(tap=self.taps.append, untap=self.taps.remove)
        network: Any = SimpleNamespace(plant=plant, boards=self.boards, queue=self.queue, wire=wire)

        class Stage:
            def __init__(stage, _network: Any, axis: str, _evidence: Any, t_ns: int) -> None:
                stage.axis = axis
                self.cuts.append(axis)

            def clear(stage, t_ns: int) -> None:
                self.cuts.remove(stage.axis)

        monkeypatch.setattr(chain, "_Unsupplied", Stage)
        watched: Any = {name: self.boards[name] for name in guards}
        self.network, self.chain = network, Chain(network, ENDS, watched)
        self.chain.told = lambda t_ns, text: self.told.append((t_ns, text))

    def say(self, axis: str, mode: AxisMode, identifier: int | None = None) -> None:
        """A MOTION frame of an axis board."""
        device = self.boards[board_of(axis)].device_type
        data = bytes([device, mode]) + bytes(6)
        for tap in list(self.taps):
            tap(
                0,
                Frame(MEASUREMENT_BASE + device if identifier is None else identifier, data),
                board_of(axis),
            )


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    return Rig(monkeypatch)


def test_it_looks_again_when_an_axis_could_be_at_a_switch(rig: Rig) -> None:
    """Right ascension is 1 rad away, then 0.1 at the other end, then 1e-6."""
    assert rig.queue.step() == 0
    first = ceil(1.0 / FASTEST * 1e9)
    assert rig.queue.next_ns() == pytest.approx(first, abs=2)
    rig.angles["ra"] = 1.9
    at_ns = rig.queue.step()
    assert rig.queue.next_ns() - at_ns == pytest.approx(0.1 / FASTEST * 1e9, abs=2)
    rig.angles["ra"] = 2.0 - 1e-6
    at_ns = rig.queue.step()
    assert rig.queue.next_ns() - at_ns == 5 * MS
    assert not rig.chain.open and not rig.told


@pytest.mark.parametrize(("angle", "end"), [(-1.0, "low"), (-1.5, "low"), (2.0, "high"), (2.5, "high")])
def test_an_axis_at_a_switch_opens_it_and_the_contactor_falls_20_ms_later(
    rig: Rig, angle: float, end: str
) -> None:
    rig.queue.step()
    rig.angles["ra"] = angle
    at_ns = rig.queue.step()
    assert rig.chain.open and rig.told == [(at_ns, f"opens: limit switch of ra, {end} end")]
    assert not rig.cuts
    assert rig.queue.step() == at_ns + 20 * MS and rig.cuts == ["ra", "dec"]
    assert rig.queue.step() == at_ns + 50 * MS
    assert len(rig.told) == 1  # the same cause is told once


def test_another_cause_is_told_as_one_more(rig: Rig) -> None:
    rig.queue.step()
    assert rig.chain.press(7 * MS)
    assert not rig.chain.press(8 * MS)
    rig.angles["dec"] = 3.0
    assert [rig.queue.step(), rig.queue.step()] == [27 * MS, 58 * MS]
    texts = [text for _, text in rig.told]
    assert texts == ["opens: emergency stop", "also: limit switch of dec, high end"]
    assert len(rig.taps) == 1 and len(rig.queue.due) == 1


def test_it_closes_when_no_hand_is_left_and_both_axes_say_OFF(rig: Rig) -> None:
    rig.queue.step()
    rig.chain.press(1 * MS)
    rig.chain.press(2 * MS)
    rig.queue.step()
    assert rig.cuts == ["ra", "dec"]
    for axis in ENDS:
        rig.say(axis, AxisMode.OFF)
    rig.chain.release(30 * MS)
    assert rig.chain.open  # another hand
    rig.chain.release(40 * MS)
    assert rig.chain.open  # since the last look nobody has said OFF
    rig.say("ra", AxisMode.OFF)
    rig.say("dec", AxisMode.OFF)
    rig.say("dec", AxisMode.STOP)
    assert rig.queue.step() == 90 * MS and rig.chain.open
    rig.say("ra", AxisMode.OFF)
    rig.say("dec", AxisMode.OFF, identifier=0x123)
    assert rig.queue.step() == 140 * MS and rig.chain.open
    for axis in ENDS:
        rig.say(axis, AxisMode.OFF)
    assert rig.queue.step() == 190 * MS
    assert not rig.chain.open and not rig.cuts and not rig.taps
    assert rig.told[-1] == (190 * MS, "closes: both axes are OFF")


def test_it_closes_before_the_contactor_has_fallen(rig: Rig) -> None:
    rig.queue.step()
    rig.chain.press(1 * MS)
    for axis in ENDS:
        rig.say(axis, AxisMode.OFF)
    rig.chain.release(2 * MS)
    assert not rig.chain.open
    assert [call for _, call in rig.queue.due] == [rig.chain._look] and not rig.cuts


def test_a_watchdog_is_fed_by_the_board_s_ticks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten ticks of 5 ms after the last, the cause is there; until then it is looked at when it is due."""
    rig = Rig(monkeypatch, ("AXIS_RA",))
    rig.queue.step()
    assert rig.queue.next_ns() == 50 * MS
    rig.boards["AXIS_RA"].ticks = 4
    assert rig.queue.step() == 50 * MS and rig.queue.next_ns() == 70 * MS
    assert not rig.chain.open
    rig.boards["AXIS_RA"].epoch_ns = 1 * MS
    assert rig.queue.step() == 70 * MS and rig.queue.next_ns() == 71 * MS
    rig.queue.step()
    assert rig.told == [(71 * MS, "opens: watchdog of AXIS_RA, not fed for 50 ms")]


def test_nobody_has_to_listen(rig: Rig) -> None:
    rig.chain.told = None
    rig.queue.step()
    assert rig.chain.press(1)


@pytest.mark.skipif(compiled(), reason="a compiled board is made whole or not at all")
@pytest.mark.parametrize(("kind", "guards"), [(SWITCHES, set()), (WATCHDOG, {"AXIS_RA"})])
def test_switches_stand_halfway_between_limits_and_stops(
    monkeypatch: pytest.MonkeyPatch, kind: str, guards: set[str]
) -> None:
    """Soft limits of -1 and 2 rad, stops at -2 and 3; declination's board is none with a timer."""
    made: list[Any] = []

    def make(*each: Any) -> str:
        made.append(each)
        return "a chain"

    monkeypatch.setattr(chain, "Chain", make)
    stops = SimpleNamespace(low=SimpleNamespace(si=-2.0), high=SimpleNamespace(si=3.0))
    board = object.__new__(PeriodicBoard)
    board.name = "AXIS_RA"
    axes = SimpleNamespace(ra=SimpleNamespace(stops=stops), dec=SimpleNamespace(stops=stops))
    plant = SimpleNamespace(model=SimpleNamespace(axes=axes))
    network: Any = SimpleNamespace(boards={"AXIS_RA": board, "AXIS_DEC": object()}, plant=plant)
    soft = {"ra": (-1.0, 2.0), "dec": (-1.0, 2.0)}
    assert chained(network, soft, kind) == "a chain"  # type: ignore[comparison-overlap]
    assert made == [(network, {"ra": (-1.5, 2.5)}, dict.fromkeys(guards, board))]
    assert chained(network, soft, chain.NONE) is None
    network.boards = {}
    assert chained(network, soft, kind) is None
