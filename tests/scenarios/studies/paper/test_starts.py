"""Starts, plants that an experiment asks for, and what the deciding bench reads."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bus.can import Frame
from bus.protocol import Opcode
from plant.model import get
from plant.units import ARCSEC
from scenarios.lab.axisbench import AXIS, AxisBench
from scenarios.studies.paper import starts
from scenarios.studies.paper.scales import GEAR_RATIO
from scenarios.studies.paper.starts import Benches, EmulatorBench, Start, others, viscous_only, with_inertia
from tests.scenarios.studies.paper.bench import HIGH, LOW


def test_a_start_is_in_steps_of_the_absolute_encoder() -> None:
    """29 bits a turn (EnDat of the paper): a quarter is 2^27."""
    assert Start(90.0, 1).steps == 1 << 27 and Start(180.0, 1).steps == starts.START_STEPS


def test_other_starts_are_always_the_same_within_the_travel() -> None:
    many = others(200)
    assert many == others(200) and len({each.angle_deg for each in many}) > 150
    assert all(85.0 <= each.angle_deg <= 275.0 and 10 <= each.seed < 100_000 for each in many)
    angles = np.array([each.angle_deg for each in many])
    assert angles.min() < 90.0 and angles.max() > 270.0 and np.allclose(angles * 10, np.round(angles * 10))


def test_benches_are_made_of_a_preload_or_of_another_plant() -> None:
    make: Any = lambda *given: given  # noqa: E731
    made: Any = Benches(make, {"low": LOW, "high": HIGH}, Start(90.0, 7))
    assert made() == (LOW, 7, None, 1 << 27)
    assert made("high", (1.0, 2.0)) == (HIGH, 7, (1.0, 2.0), 1 << 27)
    assert made.gains == (LOW.controller.kp.si, LOW.controller.ki.si)


def test_viscous_bearings_have_no_other_friction() -> None:
    found = viscous_only(LOW)
    for name in ("coulomb", "stiction"):
        assert get(found, f"axes.ra.friction.{name}").value == 1e-3  # of 229 and more (Table 2)
    assert found.axes.ra.friction.viscous == LOW.axes.ra.friction.viscous


def test_an_inertia_is_that_of_load_and_both_rotors() -> None:
    """At the axis a rotor weighs its own inertia times the square of the gear."""
    rotors = 2.0 * LOW.axes.ra.motor.rotor_inertia.si * GEAR_RATIO**2
    heavy = with_inertia(LOW, 1.5)
    assert heavy.axes.ra.inertia.si + rotors == pytest.approx(1.5 * (LOW.axes.ra.inertia.si + rotors))
    assert heavy.axes.ra.motor == LOW.axes.ra.motor
    assert get(with_inertia(LOW, 1.0), "axes.ra.inertia").value == pytest.approx(LOW.axes.ra.inertia.value)


def blank() -> Any:
    """A bench that nothing has been made of."""
    return object.__new__(EmulatorBench)


class Desk:
    """A bench without a network: frames of the axis board come while it waits."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.told: list[Any] = []
        self.now_ns = 0
        self.bench = blank()
        self.bench.command = lambda *given: self.told.append(given)
        self.bench.wait = self.wait
        axis = SimpleNamespace(truth=lambda t_ns: (t_ns * 1e-9 * 15.0 * ARCSEC,))
        self.bench.plant = SimpleNamespace(ra=axis)
        self.bench._rows, self.bench._angle, self.bench._at_ns = [], 0.0, 0
        motion = SimpleNamespace(velocity=6, effort=-40, adc_a=3, adc_b=2)
        monkeypatch.setattr(starts, "unpack_motion", lambda data: motion)

    def wait(self, seconds: float) -> None:
        """In ticks of 10 ms a frame each, of this axis and of another."""
        self.told.append(("wait", pytest.approx(seconds, abs=1e-9)))
        for _ in range(round(seconds * 100)):
            self.now_ns += 10_000_000
            for node in (AXIS, AXIS + 1):
                self.bench._listen(self.now_ns, Frame(0x200 + node, bytes(8)), "")


def test_a_run_is_what_motion_frames_carry(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every 10 ms; the true rate is between two of them, of a truth of 15 arcsec/s here."""
    desk = Desk(monkeypatch)
    log = desk.bench.closed_loop(15.0, 0.055)
    (command, *waits) = desk.told
    assert command[0] == Opcode.SET_RATE and len(command) == 2
    assert [each[0] for each in waits] == ["wait", "wait"] and waits == [("wait", 0.05), ("wait", 0.005)]
    assert log.t_s == pytest.approx([0.01, 0.02, 0.03, 0.04, 0.05])
    assert set(log.counts) == {6.0} and set(log.effort) == {-40.0}
    assert (set(log.adc_a), set(log.adc_b)) == ({3.0}, {2.0})
    assert log.true_rate == pytest.approx([15.0] * 5)
    again = desk.bench.open_loop(-300, 0.02)
    assert desk.told[3] == (Opcode.OPEN_LOOP, -300) and again.t_s == pytest.approx([0.06, 0.07])
    assert desk.told[5] == ("wait", 0.0)


def test_gains_go_over_the_bus_in_parts_of_4096(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[Any] = []

    def begin(bench: Any, *_: Any) -> None:
        bench.plant = SimpleNamespace(ra=SimpleNamespace(truth=lambda t_ns: (0.5, 0.0)))
        bench._now_ns, bench.network = 5, SimpleNamespace(wire=SimpleNamespace(tap=told.append))
        bench.command = lambda *given: told.append(given)

    monkeypatch.setattr(AxisBench, "__init__", begin)
    bench = EmulatorBench(LOW, gains=(0.5, 2.0))
    assert told[0] == bench._listen
    assert [each[2] for each in told[1:3]] == [2048, 8192] and told[3] == (Opcode.POWER, 1)
    assert (bench._angle, bench._at_ns) == (0.5, 5)
    told.clear()
    EmulatorBench(LOW)
    assert told[1:] == [(Opcode.POWER, 1)]
