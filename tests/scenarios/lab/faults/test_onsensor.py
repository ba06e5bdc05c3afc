"""Faults of sensors by themselves: what a board is shown of each reading, and what proves it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from scenarios.lab.faults.onsensor import Delayed, Intermittent, Off, Sensor, Stuck, unit
from scenarios.lab.faults.place import Place
from tests.scenarios.lab.faults.stub import acted, place


class Chip:
    """A place whose sensor shows a number; motor: for which it is asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, motor: int | None = None) -> None:
        self.value: Any = 100
        self.place = place()
        self.pins = SimpleNamespace(read=lambda t_ns, *motors: self.value)
        monkeypatch.setattr(Place, "pin", lambda where, sensor: (self.pins, "read", motor))

    def at(self, t_ns: int, value: Any, *motor: int) -> Any:
        self.value = value
        return self.pins.read(t_ns, *motor)

    @property
    def acted(self) -> tuple[int | None, str]:
        return acted(self.place.evidence)


def test_a_stuck_sensor_shows_its_first_reading_even_if_that_is_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chip = Chip(monkeypatch)
    stuck = Stuck(chip.place, {"sensor": "ra.absolute"}, 0)
    assert [chip.at(1, 0), chip.at(2, 0)] == [0, 0] and not chip.acted[1]
    assert chip.at(3, 7) == 0 and chip.acted == (3, "sample of ra.absolute")
    stuck.clear(4)
    assert chip.at(5, 9) == 9


def test_another_motor_s_reading_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    chip = Chip(monkeypatch, motor=1)
    Stuck(chip.place, {"sensor": "ra.current_b"}, 0)
    assert [chip.at(1, 5, 1), chip.at(2, 6, 0), chip.at(3, 6, 1)] == [5, 6, 5]


@pytest.mark.parametrize(
    ("given", "reading", "shown"),
    [
        ({"factor": 0.5}, 101, 50),
        ({"offset": -3.4}, 10, 7),
        ({"factor": 2.0, "offset": 1.5}, 1.0, 3.5),
        ({}, 8, 8),
    ],
)
def test_a_reading_is_off_by_a_factor_and_an_offset(
    given: dict[str, Any], reading: Any, shown: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    chip = Chip(monkeypatch)
    Off(chip.place, {"sensor": "ra.absolute", **given}, 0)
    found = chip.at(1, reading)
    assert found == shown and type(found) is type(reading)
    assert (chip.acted[0] is None) is (shown == reading)


def test_noise_is_white_and_of_its_deviation(monkeypatch: pytest.MonkeyPatch) -> None:
    chip = Chip(monkeypatch)
    Off(chip.place, {"sensor": "ra.current_a", "deviation": 4.0}, 0)
    shown = np.array([chip.at(k, 50.0) for k in range(3000)])
    assert shown.mean() == pytest.approx(50.0, abs=0.3) and shown.std() == pytest.approx(4.0, rel=0.05)


def test_a_level_is_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    chip = Chip(monkeypatch)
    with pytest.raises(
        ValueError, match=r"^sensor: focus\.index is a level; it can be stuck, late or intermittent$"
    ):
        Off(chip.place, {"sensor": "focus.index"}, 0)


def test_a_delay_shows_the_newest_that_is_old_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    chip = Chip(monkeypatch)
    Delayed(chip.place, {"sensor": "ra.absolute", "delay": 20e-9}, 0)
    moments = (0, 10, 19, 20, 29, 30, 39, 60)
    assert [chip.at(t_ns, t_ns) for t_ns in moments] == [0, 0, 0, 0, 0, 10, 19, 39]
    long = Chip(monkeypatch)
    Delayed(long.place, {"sensor": "ra.absolute", "delay": 40.0}, 0)
    assert [
        long.at(0, 1),
        long.at(39_999_999_999, 2),
        long.at(40_000_000_000, 3),
        long.at(80_000_000_000, 4),
    ] == [1, 1, 1, 3]


@pytest.mark.parametrize(("probability", "held"), [(0.0, 0.0), (1.0, 1.0), (0.3, 0.3)])
def test_a_bad_contact_holds_a_share_of_the_readings(
    probability: float, held: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    chip = Chip(monkeypatch)
    Intermittent(chip.place, {"sensor": "ra.absolute", "probability": probability}, 0)
    assert chip.at(0, 0) == 0
    shown = [chip.at(k, k) for k in range(1, 2001)]
    assert np.mean([value != k for k, value in enumerate(shown, 1)]) == pytest.approx(held, abs=0.04)
    if 0.0 < probability < 1.0:
        assert all(value in (k, shown[k - 2]) for k, value in enumerate(shown, 1) if k > 1)


def test_a_sensor_says_itself_what_it_shows_and_its_unit(monkeypatch: pytest.MonkeyPatch) -> None:
    chip = Chip(monkeypatch)
    Sensor(chip.place, {"sensor": "x"}, 0)
    with pytest.raises(NotImplementedError):
        chip.at(0, 1)
    assert [unit(each) for each in ("ra.current_a", "focus.lvdt", "focus.index", "ra.absolute")] == [
        "A",
        "V",
        "",
        "counts",
    ]
