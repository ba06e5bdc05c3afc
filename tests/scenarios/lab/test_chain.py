"""The safety chain: what opens it, what it cuts, how it closes. Starts and rates are drawn, not chosen."""

import dataclasses
from math import ceil, degrees, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bus.time import generator
from host.rates import COUNT_ARCSEC, LOOP_S
from plant.gears import RATIO
from plant.kernels import layout as at
from plant.units import ARCSEC
from scenarios.lab.chain import DROP_NS, FED_NS
from scenarios.lab.lab import Lab
from scenarios.lab.prepare import prepare
from scenarios.run import run as runner
from tests.scenarios.conftest import ROOT

SOFT = {"ra": (-100.0, 100.0), "dec": (-45.0, 92.0)}
"""Soft limits of a scenario that says nothing, deg (FIDELITY.md, P1); its switches and stops follow."""
SWITCH, STOP = 2.5, 5.0
AGILE = ("low-preload", "low-preload-motor-units", "low-preload-bridge")
WORD = {"ra": "hour_angle", "dec": "declination"}


class Bench:
    """An axis that slews towards an end of its travel."""

    def __init__(
        self, folder: Path, chain: str, axis: str, plant: str = "low-preload-bridge", more: str = ""
    ) -> None:
        random = generator(len(plant), f"{chain}.{axis}")
        self.axis, self.board = axis, f"AXIS_{axis.upper()}"
        self.side = int(random.choice((-1, 1)))
        self.rate = float(random.uniform(0.7, 2.5))
        self.limit = SOFT[axis][self.side > 0]
        before = 7.0 + 2.0 * self.rate + float(random.uniform(0.0, 1.0))
        text = (
            f"name: bench\nstart_utc: 2026-02-10T14:00:00Z\nplant: {plant}\nsteps: [{{power_on: {{}}}}]\n"
            f"network: {{chain: {chain}{more}}}\n"
            f"start: {{{WORD[axis]}: {self.limit - self.side * before} deg}}\n"
        )
        (folder / "bench.yaml").write_text(text)
        self.lab = Lab(folder / "bench.yaml")
        self.story: list[tuple[int, str]] = []
        if self.chain is not None:
            self.chain.told = lambda t_ns, text: self.story.append((t_ns, text))
        self.lab.run(0.1)
        self.power(1)
        counts = self.side * self.rate * 3600.0 / COUNT_ARCSEC * LOOP_S
        assert self.lab.ask(self.board, "SET_RATE", round(counts * 65536)).result == 0
        self.lab.run(2.0)

    @property
    def chain(self) -> Any:
        return self.lab.network.chain

    @property
    def now_ns(self) -> int:
        return self.lab.network.queue.now_ns

    def power(self, on: int) -> None:
        for board in ("AXIS_RA", "AXIS_DEC"):
            assert self.lab.ask(board, "POWER", on).result == 0

    def beyond(self) -> float:
        """How far the axis is beyond its soft limit, deg."""
        angle = getattr(self.lab.plant, self.axis).truth(self.now_ns)[0]
        return self.side * (degrees(angle) - 180.0 - self.limit)

    def speed(self) -> float:
        """deg/s, outward."""
        return self.side * degrees(getattr(self.lab.plant, self.axis).truth(self.now_ns)[1])

    def duties(self) -> list[float]:
        view = self.lab.plant.view
        return [view[row * at.WIDTH + at.DUTY + motor] for row in (0, 1) for motor in (0, 1)]

    def has_come_to_rest(self) -> bool:
        """Within a second. Without power the rotors still swing between the teeth, and the axis with them."""
        self.lab.run(1.0)
        before = self.beyond()
        self.lab.run(1.0)
        play = getattr(self.lab.plant.model.axes, self.axis).gear.backlash.si
        return abs(self.beyond() - before) < degrees(play)

    def hang(self) -> int:
        assert self.speed() > 0.9 * self.rate
        self.lab.faults.start("hang", node=self.board)
        return self.now_ns


@pytest.mark.slow
@pytest.mark.parametrize("axis", ["ra", "dec"])
@pytest.mark.parametrize("plant", AGILE)
def test_without_a_chain_a_hung_axis_ends_on_its_stop(plant: str, axis: str, tmp_path: Path) -> None:
    """It goes into the buffer no further than its energy and the work of its motors take the spring."""
    bench = Bench(tmp_path, "none", axis, plant)
    assert bench.chain is None
    bench.hang()
    furthest = 0.0
    for _ in range(200):
        bench.lab.run(0.1)
        furthest = max(furthest, bench.beyond())
    part = getattr(bench.lab.plant.model.axes, axis)
    inertia = part.inertia.si + 2 * part.motor.rotor_inertia.si * RATIO**2
    stall = part.motor.torque_constant.si * bench.lab.plant.model.supply.voltage.si / part.motor.loop * RATIO
    stiffness = part.stops.stiffness.si
    deepest = 2 * stall / stiffness + radians(4.0) * np.sqrt(inertia / stiffness)
    assert STOP < furthest < STOP + degrees(deepest)
    assert bench.beyond() > STOP and abs(bench.speed()) < degrees(ARCSEC)
    assert max(bench.duties()) > 0.1, "it is still driven"


@pytest.mark.slow
@pytest.mark.parametrize("axis", ["ra", "dec"])
@pytest.mark.parametrize("plant", AGILE)
def test_a_limit_switch_cuts_both_drives_before_the_stop(plant: str, axis: str, tmp_path: Path) -> None:
    bench = Bench(tmp_path, "switches", axis, plant)
    bench.hang()
    while not bench.story:
        bench.lab.run(0.005)
        assert bench.beyond() < SWITCH + 0.1
    end = "high" if bench.side > 0 else "low"
    assert [text for _, text in bench.story] == [f"opens: limit switch of {axis}, {end} end"]
    assert SWITCH <= bench.beyond() < SWITCH + bench.rate * 1.2 * 0.02, "two looks and a slice"
    bench.lab.run(0.025)
    assert bench.duties() == [0.0] * 4
    assert bench.has_come_to_rest()
    assert bench.beyond() < STOP


@pytest.mark.parametrize("axis", ["ra", "dec"])
@pytest.mark.parametrize("plant", AGILE)
def test_the_watchdog_cuts_the_power_within_100_ms(plant: str, axis: str, tmp_path: Path) -> None:
    bench = Bench(tmp_path, "watchdog", axis, plant)
    assert bench.story == []
    hung_ns = bench.hang()
    while any(bench.duties()):
        bench.lab.run(0.001)
        assert bench.now_ns < hung_ns + 100_000_000
    ((opened_ns, text),) = bench.story
    assert text == f"opens: watchdog of {bench.board}, not fed for 50 ms"
    assert hung_ns < opened_ns <= hung_ns + FED_NS, "the last tick was before the hang"
    assert bench.now_ns == pytest.approx(opened_ns + DROP_NS, abs=2_000_000)
    assert bench.has_come_to_rest()
    assert bench.beyond() < 0.0


def test_it_is_latched_until_both_axes_are_off(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "watchdog", "ra")
    bench.hang()
    bench.lab.run(0.5)
    bench.lab.faults.clear(0)  # the board goes on and wants its rate
    bench.lab.run(1.0)
    place = bench.beyond()
    assert bench.chain.open and bench.duties() == [0.0] * 4
    assert bench.lab.ask("AXIS_RA", "POWER", 0).result == 0
    bench.lab.run(0.5)
    assert bench.chain.open, "the other axis is on"
    assert bench.lab.ask("AXIS_DEC", "POWER", 0).result == 0
    bench.lab.run(0.2)
    assert [text for _, text in bench.story][1:] == ["closes: both axes are OFF"]
    assert bench.beyond() == pytest.approx(place, abs=0.01)
    assert bench.lab.ask("AXIS_DEC", "POWER", 1).result == 0
    assert bench.lab.ask("AXIS_DEC", "OPEN_LOOP", 1000).result == 0
    bench.lab.run(0.1)
    assert max(bench.duties()) > 0.3, "it drives again"
    assert bench.lab.network.layers._stacks == [], "nothing is left in the way"


def test_the_button_stops_everything_whatever_is_broken(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "switches", "dec")
    bench.lab.faults.start("mosfet_short", axis="ra", motor="a")
    bench.lab.run(0.1)
    assert bench.duties()[0] == 1.0
    number = bench.lab.faults.start("emergency_stop")
    bench.lab.run(0.025)
    assert bench.duties() == [0.0] * 4
    assert all(board.on for board in bench.lab.boards.values()), "the boards keep their supply"
    assert bench.has_come_to_rest()
    bench.power(0)
    bench.lab.run(0.2)
    assert bench.chain.open, "somebody still presses"
    bench.lab.faults.clear(number)
    bench.lab.run(0.2)
    assert not bench.chain.open
    assert bench.duties() == [1.0, 0.0, 0.0, 0.0], "the short is still there"
    assert [text for _, text in bench.story] == ["opens: emergency stop", "closes: both axes are OFF"]
    assert bench.lab.faults.evidence[1].on == "safety chain"


def test_two_hands_on_the_button(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "switches", "ra")
    one, two = (bench.lab.faults.start("emergency_stop") for _ in range(2))
    bench.power(0)
    bench.lab.faults.clear(one)
    bench.lab.run(0.5)
    assert bench.chain.open
    assert bench.lab.faults.evidence[1].first_ns is None, "the second one met an open chain"
    bench.lab.faults.clear(two)
    bench.lab.run(0.5)
    assert not bench.chain.open


def test_a_board_that_loses_its_supply_feeds_no_watchdog(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "watchdog", "ra")
    bench.lab.faults.start("node_off", node="AXIS_DEC")
    bench.lab.run(0.1)
    assert [text for _, text in bench.story] == ["opens: watchdog of AXIS_DEC, not fed for 50 ms"]
    assert bench.duties() == [0.0] * 4


def test_without_a_chain_there_is_no_button(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "none", "ra")
    with pytest.raises(ValueError, match="no safety chain"):
        bench.lab.faults.start("emergency_stop")
    assert bench.lab.faults.running == []


def test_firmware_in_c_is_watched_as_well(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "watchdog", "ra", more=", nodes: {AXIS_RA: {firmware: axis.c}}")
    assert type(bench.lab.boards["AXIS_RA"]).__name__ == "FirmwareBoard"
    assert bench.story == []
    hung_ns = bench.hang()
    bench.lab.run(0.1)
    assert bench.duties() == [0.0] * 4
    assert bench.story[0][0] <= hung_ns + FED_NS
    bench.lab.faults.clear(0)
    bench.power(0)
    bench.lab.run(0.2)
    assert bench.story[-1][1] == "closes: both axes are OFF"


@pytest.mark.slow
def test_a_calm_telescope_is_looked_at_every_few_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """No look comes later than the axis at its no-load rate, on 1.5 times its supply, is at a switch."""
    from scenarios.lab import chain

    times: list[int] = []
    look = chain.Chain._look

    def noted(self: Any, t_ns: int) -> None:
        times.append(t_ns)
        look(self, t_ns)

    monkeypatch.setattr(chain.Chain, "_look", noted)
    lab = Lab()
    lab.run(60.0)
    model = lab.plant.model
    fastest = [
        1.5 * model.supply.voltage.si / (axis.motor.torque_constant.si * RATIO)
        for axis in (model.axes.ra, model.axes.dec)
    ]
    park = degrees(lab.plant.dec.truth(lab.network.queue.now_ns)[0]) - 180.0
    ways = [radians(100.0 + SWITCH), radians(min(92.0 + SWITCH - park, park + 45.0 + SWITCH))]
    every = min(way / rate for way, rate in zip(ways, fastest, strict=True))
    assert every > 2.0
    assert len(times) == ceil(60.0 / every)
    assert np.diff(times) * 1e-9 == pytest.approx(every, rel=1e-3)


@pytest.mark.slow
def test_the_scenario_tells_the_story_in_its_order(tmp_path: Path) -> None:
    scenario, model = prepare(ROOT / "scenarios/hung-axis.yaml")
    result = runner.run(scenario, model, tmp_path / "one", lambda *_: None, runner.Way(report=False))
    assert result.passed, result.verdicts
    lines = (tmp_path / "one" / "errors.log").read_text().splitlines()[1:]
    told = [line.split("  ", 2)[2] for line in lines]
    assert [line.split(" since")[0] for line in told] == [
        "CHAIN  opens: watchdog of AXIS_RA, not fed for 50 ms",
        "AXIS_RA serial  silent",
        "AXIS_RA  silent",
        "CHAIN  also: watchdog of AXIS_RA, not fed for 50 ms",  # while it boots after its reset
        "CHAIN  closes: both axes are OFF",
    ]
    times = [float(line.split("  ")[1]) for line in lines]
    assert times == sorted(times)
    hung_s = scenario.faults[0].at_s
    assert hung_s < times[0] < hung_s + 0.1
    off = dataclasses.replace(scenario, network={"chain": "none"})
    result = runner.run(off, model, tmp_path / "two", lambda *_: None, runner.Way(report=False))
    assert "CHAIN" not in (tmp_path / "two" / "errors.log").read_text()
