"""Kernels as plain Python against closed forms, each number by itself."""

import numpy as np
import pytest

from plant.kernels.drive import back_emf, train, winding
from plant.kernels.noise import normal, uniform

emf_of, push_of, wound, normal_of, uniform_of = (
    each.py_func  # type: ignore[attr-defined]
    for each in (back_emf, train, winding, normal, uniform)
)


def test_P4_a_winding_tends_to_its_target_and_the_diode_stops_it_at_nothing() -> None:
    assert wound(2.0, 5.0, 0.25, 0.5) == (5.0 - 3.0 * 0.25, 5.0 - 3.0 * 0.5)
    assert wound(2.0, -5.0, 0.25, 0.5) == (0.0, 0.0)
    assert wound(0.5, 0.1, 0.25, 0.5) == pytest.approx((0.2, 0.3))
    assert wound(2.0, -5.0, 0.9, 0.95) == (-5.0 + 7.0 * 0.9, -5.0 + 7.0 * 0.95)
    assert wound(2.0, -5.0, 0.5, 0.9) == (0.0, -5.0 + 7.0 * 0.9)


@pytest.mark.parametrize(("speed", "applied", "leads", "diode", "expected"), [
    (10.0, 6.0, True, 0.0, 4.0), (10.0, 6.0, False, 1.0, 4.0), (1.0, 6.0, False, 1.0, 0.4),  # its own way
    (-10.0, 6.0, True, 0.0, -4.0), (-10.0, 3.0, True, 0.0, -3.0), (-10.0, 6.0, False, 0.0, 0.0),
    (-10.0, 6.0, False, 1.0, -3.3), (-10.0, 3.0, True, 0.5, -3.15), (-1.0, 6.0, False, 1.0, 0.0),
])  # fmt: skip
def test_P4_back_emf_of_either_way(
    speed: float, applied: float, leads: bool, diode: float, expected: float
) -> None:
    assert emf_of(speed, 0.4, applied, leads, diode, 0.7) == pytest.approx(expected)


def test_P3_teeth_push_beyond_the_play_and_never_pull() -> None:
    assert push_of(0.3, 2.0, 100.0, 5.0, 0.1) == pytest.approx(100.0 * 0.2 + 10.0)
    assert push_of(-0.3, 2.0, 100.0, 5.0, 0.1) == pytest.approx(-100.0 * 0.2 + 10.0)
    assert push_of(0.1005, 0.1, 100.0, 5.0, 0.1) == pytest.approx(0.55)
    assert push_of(-0.1005, -0.1, 100.0, 5.0, 0.1) == pytest.approx(-0.55)
    assert push_of(0.3, -5.0, 100.0, 5.0, 0.1) == push_of(-0.3, 5.0, 100.0, 5.0, 0.1) == 0.0
    assert push_of(-0.1005, 0.1, 100.0, 5.0, 0.1) == push_of(0.1005, -0.1, 100.0, 5.0, 0.1) == 0.0
    assert push_of(0.1, 9.0, 100.0, 5.0, 0.1) == push_of(-0.1, -9.0, 100.0, 5.0, 0.1) == 0.0


def test_noise_is_standard_normal_and_every_number_by_itself() -> None:
    with np.errstate(over="ignore"):  # whole numbers of 64 bits
        rows = np.array([[normal_of(float(seed), float(k)) for k in range(4000)] for seed in (1, 2)])
        plain = [uniform_of(np.uint64(1), np.uint64(k)) for k in range(3)]
        pairs_of = [[uniform_of(np.uint64(2), np.uint64(2 * k + j)) for j in (0, 1)] for k in range(3)]
        told = [np.sqrt(-2.0 * np.log(a)) * np.cos(2.0 * np.pi * b) for a, b in pairs_of]
    assert np.abs(rows.mean(axis=1)).max() < 0.06 and np.abs(rows.std(axis=1) - 1.0).max() < 0.04
    pairs = [
        (rows[0], rows[1]),
        *((rows[0][:-k], rows[0][k:]) for k in (1, 2)),
        (rows[0][::2], rows[0][1::2]),
    ]
    for a, b in [*pairs, (np.abs(rows[0][:-1]), np.abs(rows[0][1:]))]:
        assert abs(np.corrcoef(a, b)[0, 1]) < 0.08
    assert rows[1][:3] == pytest.approx(told)  # no two share a uniform number
    assert min(plain) > 0.0 and max(plain) < 1.0 and len(set(plain)) == 3


def test_uniform_numbers_are_those_of_the_published_generator() -> None:
    """The first of SplitMix64 from seed 1234567, as its authors' C code prints them; 53 bits of each."""
    known = (6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431)
    with np.errstate(over="ignore"):
        made = [uniform_of(np.uint64(1234567), np.uint64(k)) for k in range(4)]
    assert made == [((number >> 11) + 0.5) / 2**53 for number in known]
