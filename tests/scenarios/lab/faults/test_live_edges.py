"""Faults started and cleared by a call or by the clock, over a stub network and a fault that writes down."""

from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.lab.faults import live
from scenarios.lab.faults.kind import Kind, Parameter
from scenarios.lab.faults.live import Faults, Running
from scenarios.lab.faults.place import Place
from tests.scenarios.lab.faults.stub import place

S = 1_000_000_000


class Desk:
    """One kind of fault, `hum`, with a load; log: what befell it, and when."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.log: list[tuple[str, float, int]] = []
        self.draws: list[float] = []
        self.wrong = False
        kind = Kind(
            "bus", "hum", "it hums", (Parameter("load", "of it", "fraction", default=0.5),), self.make
        )
        monkeypatch.setattr(live, "BY_NAME", {"hum": kind})
        network: Any = place().network
        self.network, self.queue = network, network.queue
        self.faults = Faults(network, 7)

    def make(self, where: Place, given: Any, t_ns: int) -> Any:
        if self.wrong:
            raise ValueError("not here")
        self.draws.append(float(where.random.random()))
        self.log.append(("on", given["load"], t_ns))
        return SimpleNamespace(clear=lambda t_ns: self.log.append(("off", given["load"], t_ns)))

    def plan(self, at_s: float, until_s: float | None = None, **more: Any) -> None:
        fault: Any = SimpleNamespace(
            kind="hum", arguments=more, at_s=at_s, until_s=until_s, may_not_act=False, where="night.yaml:3"
        )
        self.faults.schedule([fault])


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_faults_have_numbers_and_are_told_oldest_first(desk: Desk) -> None:
    desk.queue.now_ns = 5
    assert [desk.faults.start("hum"), desk.faults.start("hum", load="20 %")] == [0, 1]
    assert desk.faults.running == [Running(0, "hum", {"load": 0.5}, 5), Running(1, "hum", {"load": 0.2}, 5)]
    desk.queue.now_ns = 9
    desk.faults.clear(0)
    assert desk.log == [("on", 0.5, 5), ("on", 0.2, 5), ("off", 0.5, 9)]
    assert desk.faults.start("hum") == 2 and [each.number for each in desk.faults.running] == [1, 2]
    assert [each.at_ns for each in desk.faults.evidence] == [5, 5, 9]
    assert len(set(desk.draws)) == 3  # each has its own random numbers


def test_what_is_not_on_or_not_known_is_said(desk: Desk) -> None:
    with pytest.raises(ValueError, match=r"^no fault has the number 3; on: none$"):
        desk.faults.clear(3)
    desk.faults.start("hum")
    with pytest.raises(ValueError, match=r"^no fault has the number 3; on: 0 hum$"):
        desk.faults.clear(3)
    with pytest.raises(ValueError, match=r"^no fault is called 'roar'; use one of hum$"):
        desk.faults.start("roar")


def test_a_fault_that_cannot_be_changes_nothing(desk: Desk) -> None:
    desk.wrong = True
    with pytest.raises(ValueError, match=r"^not here$"):
        desk.faults.start("hum")
    assert desk.faults.running == [] and desk.faults.evidence == []
    desk.wrong = False
    assert desk.faults.start("hum") == 0


def test_a_planned_fault_starts_and_ends_by_the_clock(desk: Desk) -> None:
    desk.plan(2.5, 400.0, load=0.25)
    (evidence,) = desk.faults.evidence
    assert (evidence.at_ns, evidence.may_not_act, evidence.where) == (2 * S + S // 2, False, "night.yaml:3")
    assert [desk.queue.step(), desk.queue.step()] == [2 * S + S // 2, 400 * S]
    assert desk.log == [("on", 0.25, 2 * S + S // 2), ("off", 0.25, 400 * S)] and desk.faults.running == []


def test_one_that_is_due_begins_at_once_and_one_without_an_end_stays(desk: Desk) -> None:
    desk.queue.now_ns = 3 * S
    desk.plan(3.0)
    assert desk.log == [("on", 0.5, 3 * S)] and desk.queue.due == []
    desk.plan(300.0)
    assert desk.queue.due[0][0] == 300 * S


def test_one_that_cannot_begin_is_said_with_its_place_and_ends_quietly(desk: Desk) -> None:
    desk.plan(1.0, 2.0)
    desk.wrong = True
    with pytest.raises(ValueError, match=r"^night\.yaml:3: not here$"):
        desk.queue.step()
    assert desk.queue.step() == 2 * S and desk.log == []


def test_a_scenario_s_random_numbers_are_those_of_its_seed_and_place(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk.plan(0.0)
    other = Desk(monkeypatch)
    other.plan(0.0)
    assert desk.draws == other.draws
    other.faults.start("hum")
    assert other.draws[1] != other.draws[0]
