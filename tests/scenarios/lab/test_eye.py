"""What a picture says of a star: its offset, the noise of a solved place, and what was known already."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from scenarios.lab import eye
from scenarios.lab.eye import Eye, look

ARCSEC = math.pi / 180 / 3600
STEP = 2 * math.pi / (1 << 29)
"""rad of an absolute step: 29 bits a turn."""


def scenario(seed: int = 1) -> Any:
    axis = SimpleNamespace(zero_steps=1 << 28)
    mount = SimpleNamespace(ra=axis, dec=SimpleNamespace(zero_steps=0))
    return SimpleNamespace(seed=seed, mount=mount, site=SimpleNamespace(latitude_rad=0.2), clock="clock")


def plant(errors: Any = None) -> Any:
    return SimpleNamespace(
        ra=SimpleNamespace(truth=lambda t_ns: (math.pi + 0.3, 0.0)),
        dec=SimpleNamespace(truth=lambda t_ns: (0.1, 0.0)),
        focus=SimpleNamespace(position_m=lambda t_ns: 0.004),
        model=SimpleNamespace(mount=errors),
    )


@pytest.fixture(autouse=True)
def focus(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(eye, "best_focus_m", lambda model, t_ns: 0.0015)


def test_a_look_is_the_axes_less_their_zeros_and_the_focus_less_the_best() -> None:
    found = look(plant(), scenario(), 7)
    assert found == pytest.approx((7, 0.3, 0.1, 0.0, 0.0025))


def test_a_mount_s_errors_turn_the_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up the declination axis the sky goes by 1e-5 rad to the north and half of that to the west."""
    asked: list[Any] = []

    def sky(hour_angles: list[float], declinations: list[float], latitude: float, errors: Any) -> Any:
        asked.append((hour_angles, declinations, latitude, errors))
        return [0.5, 0.5 + 0.5e-5 / math.cos(0.8)], [0.8, 0.8 + 1e-5]

    monkeypatch.setattr(eye, "sky", sky)
    found = look(plant("errors"), scenario(), 7)
    assert found == pytest.approx((7, 0.5, 0.8, math.atan2(0.5, 1.0), 0.0025), rel=1e-5)
    (hour_angles, declinations, latitude, errors), *_ = asked
    assert hour_angles == pytest.approx([0.3, 0.3]) and declinations == pytest.approx(
        [0.1, 0.1 + 1e-5], abs=1e-12
    )
    assert (latitude, errors) == (0.2, "errors")


def offsets(count: int, declination: float, monkeypatch: pytest.MonkeyPatch, hour_angle: float = 0.3) -> Any:
    place = SimpleNamespace(hour_angle_rad=hour_angle, declination_rad=declination)
    monkeypatch.setattr(eye, "observe", lambda star, site, clock, t_s: place)
    monkeypatch.setattr(eye, "look", lambda *_: (0, 0.3, declination - 1e-3, 0.0, 0.0))
    seen, star = Eye(plant(), scenario()), SimpleNamespace()
    one: Any = star
    return np.array([seen(one, 0) for _ in range(count)])


def test_an_offset_is_star_less_telescope_with_the_noise_of_seeing(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.3 arcsec in each coordinate of the sky; in hour angle more by one over the cosine."""
    found = offsets(2000, 1.0, monkeypatch)
    cosine = math.cos(1.0 - 1e-3)
    assert found.mean(axis=0) == pytest.approx([0.0, 1e-3], abs=0.04 * ARCSEC)
    assert found[:, 0].std() * cosine == pytest.approx(0.3 * ARCSEC, rel=0.06)
    assert found[:, 1].std() == pytest.approx(0.3 * ARCSEC, rel=0.06)


@pytest.mark.parametrize("turns", [-1, 1])
def test_a_turn_of_the_sky_is_none(turns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found = offsets(1, 0.0, monkeypatch, 0.3 + 1e-3 + turns * 2 * math.pi)
    assert found[0, 0] == pytest.approx(1e-3, abs=3 * ARCSEC)


def test_what_was_known_is_said_first_and_every_offset_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(eye, "observe", lambda *_: SimpleNamespace(hour_angle_rad=0.3, declination_rad=0.1))
    seen, told = Eye(plant(), scenario()), list[tuple[float, float]]()
    star: Any = SimpleNamespace()
    seen.replay([(1.0, 2.0), (3.0, 4.0)])
    assert seen(star, 0) == (1.0, 2.0)
    seen.told = lambda west, north: told.append((west, north))
    assert seen(star, 0) == (3.0, 4.0)
    third, alone = seen(star, 0), Eye(plant(), scenario())
    assert told == [(3.0, 4.0), third] and abs(third[0]) < 3 * ARCSEC
    assert [alone(star, 0) for _ in range(3)][2] == third  # the noise goes on meanwhile
    assert Eye(plant(), scenario(2))(star, 0) != alone(star, 0)
    assert pytest.approx(math.pi) == STEP * (1 << 28)


def test_zeros_of_both_axes_and_the_time_of_the_sky_are_in_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def observe(star: Any, site: Any, clock: str, t_s: float) -> Any:
        asked.append(t_s)
        return SimpleNamespace(hour_angle_rad=0.3, declination_rad=0.0)

    monkeypatch.setattr(eye, "observe", observe)
    moved, star = scenario(), SimpleNamespace()
    moved.mount.dec.zero_steps = round(0.1 / STEP)
    one: Any = star
    Eye(plant(), moved)(one, 2_500_000_000)
    assert asked == [2.5] and look(plant(), moved, 7).declination_rad == pytest.approx(0.0, abs=STEP)
