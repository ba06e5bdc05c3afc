"""Runs driven again and compared: what is led to the log's angle, what is told, and in which words."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.balances.frame import Frame
from calibration.replay import held as module
from calibration.replay.held import (
    as_sampled,
    drive,
    sampled_at_the_edge,
)
from calibration.replay.trace import Trace
from plant.model import load, with_effects
from tests.calibration.replay.frames import frame

N = 600
MODEL = with_effects(load("low_preload"), "ra", ())


def trace(torque: float = 0.0, position: Any = 0.0, ripple: float | None = None, n: int = N) -> Trace:
    wave, still = np.full(n, ripple) if ripple is not None else None, np.zeros(n)
    return Trace(torque=still + torque, velocity=still, position=still + position, ripple=wave)


def test_currents_sampled_at_the_edge_have_the_ripple() -> None:
    assert as_sampled(trace(1.0, ripple=0.25)).torque.tolist() == [1.25] * N
    plain = trace(1.0)
    assert as_sampled(plain) is plain


class Led:
    """An axis that ends a transient 300 arcsec off, and takes a set point's change as it is given."""

    def __init__(self, f: Frame, off: float = 300.0, start: int = 200) -> None:
        self.frame, self.off, self.start, self.nudges = f, off, start, list[np.ndarray]()

    def measured(self, rows: np.ndarray) -> Trace:
        return trace(n=int(rows.sum()))

    def again(self, model: Any, rows: np.ndarray, nudge: np.ndarray) -> Trace:
        self.nudges.append(nudge.copy())
        n = int(rows.sum())
        moved = np.where(np.arange(n) >= self.start, self.off, 0.0) + 0.01 * np.cumsum(nudge)
        return trace(position=moved, n=n)


def led(use: np.ndarray, **more: Any) -> tuple[Led, Trace, list[float]]:
    loop = Led(frame(N), **more)
    best, moved = drive(loop, MODEL, np.ones(N, dtype=bool), use)  # type: ignore[arg-type]
    return loop, best, moved.tolist()


K = np.arange(N)


def test_a_transient_is_led_to_the_logs_angle_by_its_set_point() -> None:
    loop, best, moved = led(((K > 20) & (K < 190)) | (K >= 300))
    assert moved == [0.0, 300.0]
    # half a second from a second before the rows that settled: 300 arcsec in 0.5 s
    half = list(range(200, 250))
    assert [np.flatnonzero(x).tolist() for x in loop.nudges] == [[], half, half]
    assert loop.nudges[1][200] == pytest.approx(-600.0)
    assert best.position[300:] == pytest.approx(np.zeros(300), abs=1e-9)


def test_the_first_transient_begins_at_the_run() -> None:
    loop, best, moved = led(K >= 60, start=0)
    assert moved == [300.0] and np.flatnonzero(loop.nudges[1]).tolist() == list(range(50))
    assert best.position[60] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("count", "parts"), [(100, 1), (99, 0)])
def test_a_settled_stretch_has_a_hundred_rows(count: int, parts: int) -> None:
    assert len(led((K >= 300) & (300 + count > K))[2]) == parts


def test_the_best_of_three_runs_is_kept() -> None:
    loop = Led(frame(N))
    loop.again = lambda model, rows, nudge: trace(position=next(offs), n=N)  # type: ignore[method-assign]
    offs = iter([5.0, -2.0, 3.0])
    best, moved = drive(loop, MODEL, np.ones(N, dtype=bool), K >= 100)  # type: ignore[arg-type]
    assert best.position[0] == -2.0 and moved.tolist() == [5.0]
    with pytest.raises(StopIteration):
        next(offs)


def test_training_rows_tell_how_currents_were_sampled(monkeypatch: pytest.MonkeyPatch) -> None:
    f = frame(N, N)
    held = np.arange(2 * N) < N
    for measured, edge in ((1.2, True), (1.05, False)):
        loop = SimpleNamespace(frame=f, measured=lambda rows, x=measured: trace(x, n=int(rows.sum())))
        asked: list[int] = []

        def driven(_: Any, __: Any, rows: np.ndarray, use: np.ndarray, asked: list[int] = asked) -> Any:
            asked.append(int(np.flatnonzero(rows)[0]))
            return trace(1.0, ripple=0.2, n=len(use)), np.zeros(0)

        monkeypatch.setattr(module, "drive", driven)
        assert sampled_at_the_edge(loop, held, MODEL) is edge and asked == [N]  # type: ignore[arg-type]
    assert sampled_at_the_edge(loop, np.ones(2 * N, dtype=bool), MODEL) is False  # type: ignore[arg-type]
    short = SimpleNamespace(frame=frame(200))
    assert sampled_at_the_edge(short, np.zeros(200, dtype=bool), MODEL) is False  # type: ignore[arg-type]
