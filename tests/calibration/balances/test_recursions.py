"""Recursions over a log: a lag with uneven steps and a stop, by their solutions, compiled and as Python."""

from collections.abc import Callable

import numpy as np
import pytest

from calibration.balances.recursions import lowpass, stop_element, stop_operator

Recursion = Callable[..., np.ndarray]
TAU = 0.8


def python(compiled: Recursion) -> Recursion:
    return getattr(compiled, "py_func", compiled)


@pytest.mark.parametrize("lag", [lowpass, python(lowpass)])
def test_a_step_rises_as_an_exponential_whatever_the_rows(lag: Recursion) -> None:
    """From zero at the first row."""
    clock = np.cumsum([3.0, 0.1, 0.5, 0.01, 1.9, 0.3, 2.0])
    out = lag(np.full(7, 5.0), clock, TAU)
    assert out == pytest.approx(5.0 * (1 - np.exp(-(clock - clock[0]) / TAU)))


@pytest.mark.parametrize("lag", [lowpass, python(lowpass)])
def test_in_a_pause_nothing_flows(lag: Recursion) -> None:
    """Three seconds without a row: what was there decays, and the next row begins with it."""
    clock = np.array([0.0, 1.0, 4.0, 4.5])
    out = lag(np.full(4, 5.0), clock, TAU)
    before = 5.0 * (1 - np.exp(-1.0 / TAU))
    left = before * np.exp(-3.0 / TAU)
    assert out[1:] == pytest.approx([before, left, 5.0 + (left - 5.0) * np.exp(-0.5 / TAU)])


@pytest.mark.parametrize("lag", [lowpass, python(lowpass)])
def test_a_clock_that_goes_back_adds_nothing(lag: Recursion) -> None:
    out = lag(np.array([5.0, 5.0, 9.0]), np.array([0.0, 1.0, 0.5]), TAU)
    assert out[2] == out[1]


@pytest.mark.parametrize("stop", [stop_element, python(stop_element)])
def test_a_stop_follows_and_slips(stop: Recursion) -> None:
    path = np.array([5.0, 5.5, 7.0, 6.5, 4.0, 4.25, 9.0, 9.5])
    fresh = np.array([False, False, False, False, False, False, True, False])
    assert stop(path, fresh, 1.0) == pytest.approx([0.0, 0.5, 1.0, 0.5, -1.0, -0.75, 0.0, 0.5])


def test_a_run_begins_with_a_stop_that_rests() -> None:
    path, run = np.array([0.0, 0.4, 0.8, 0.8, 1.1, 0.3]), np.array([0, 0, 0, 1, 1, 1])
    assert stop_operator(path, run, 0.5) == pytest.approx([0.0, 0.4, 0.5, 0.0, 0.3, -0.5])
