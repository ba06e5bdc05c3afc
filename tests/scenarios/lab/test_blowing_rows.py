"""Where the wind is put into the plant's rows, how often, and how much of it comes through the slit."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from boards.weather.firmware import WeatherBoard
from plant.kernels import layout as at
from plant.model import load
from plant.rows import values
from plant.wind import torque
from scenarios.lab import blowing
from scenarios.lab.blowing import Blowing, in_the_wind
from scenarios.native import compiled

pytestmark = pytest.mark.skipif(compiled(), reason="a compiled board cannot be made without its port")
FIRST, SECOND, THIRD, FOURTH = (at.EFFECTS + number * at.ROW + at.ROW_KIND for number in range(4))
MEAN = 4
"""Of the memory of a row; three lags and a seed come before it."""


class Desk:
    """A mast on a plant of two axes that is only its rows; a fourth row is past the last."""

    def __init__(self, dome: Any = None) -> None:
        world = np.zeros((2, at.WIDTH))
        world[:, at.ROWS_ALL] = 3.0
        for row in world:
            row[[FIRST, SECOND, THIRD, FOURTH]] = [blowing._KIND, blowing._KIND + 1.0] + [blowing._KIND] * 2
        world[1, THIRD] = blowing._KIND + 1.0
        self.world = world
        self.advanced: list[int] = []
        self.queued: list[Any] = []
        mast = object.__new__(WeatherBoard)
        mast.pins = {"wind": lambda t_ns: t_ns / 1e9}
        plant = SimpleNamespace(world=world, view=world.reshape(-1), advance=self.advanced.append)
        queue = SimpleNamespace(now_ns=5_000_000_000, at=lambda *each: self.queued.append(each))
        network: Any = SimpleNamespace(boards={"WEATHER_MAST": mast}, plant=plant, queue=queue, dome=dome)
        self.blowing = Blowing(network, math.radians(30.0))

    def told(self, row: int, place: int) -> list[float]:
        """What the wind's row says from its mean on."""
        start = place - at.ROW_KIND + at.ROW_MEMORY + MEAN
        return list(self.world[row, start : start + 3])


def test_both_axes_have_a_place_for_the_wind_and_it_is_still() -> None:
    model = load("low_preload")
    windy = in_the_wind(model)
    for axis in ("ra", "dec"):
        *before, added = getattr(windy.axes, axis).effects
        assert tuple(before) == getattr(model.axes, axis).effects and added.name == "wind_torque"
        assert values(added)["mean"] == 0.0


def test_the_last_row_of_its_kind_is_the_winds() -> None:
    desk = Desk()
    assert desk.blowing.places == [THIRD, at.WIDTH + FIRST]


def test_it_blows_from_the_beginning_and_every_second() -> None:
    """In the open as on the mast: 5 m/s here at 5 s, 9 at 9 s."""
    desk = Desk()
    assert desk.advanced == [5_000_000_000]
    assert desk.told(0, THIRD) == desk.told(1, FIRST) == pytest.approx(torque(5.0))
    (t_ns, blow), *_ = desk.queued
    assert t_ns == 6_000_000_000
    blow(9_000_000_000)
    assert desk.advanced[1:] == [9_000_000_000] and desk.queued[1][0] == 10_000_000_000
    assert desk.told(0, THIRD) == pytest.approx(torque(9.0)) and desk.told(0, FIRST) == [0.0] * 3


def test_the_slit_is_as_far_from_the_wind_as_the_dome_has_turned(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def share(away_rad: float, shutter: float) -> float:
        asked.append((away_rad, shutter))
        return 0.25

    monkeypatch.setattr(blowing, "share", share)
    desk = Desk(SimpleNamespace(azimuth=lambda t_ns: 120.0, shutter=lambda t_ns: 0.5))
    assert desk.blowing.speed(8_000_000_000) == 2.0
    assert asked[-1] == (pytest.approx(math.radians(90.0)), 0.5)
