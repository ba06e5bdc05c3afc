"""What a balance needs of a log, and which of several laws a command has."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.balances import law
from calibration.balances.guide import piece_s
from calibration.balances.kinematic import kinematic_problem
from calibration.balances.volts import has_volts


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"current", "voltage"}, True),
        ({"current", "duty"}, True),
        ({"current"}, False),
        ({"voltage", "duty"}, False),
        (set(), False),
    ],
)
def test_volts_need_a_current_and_what_drives_it(columns: set[str], told: bool) -> None:
    view: Any = SimpleNamespace(columns=dict.fromkeys(columns))
    assert has_volts(view) is told


class LookedAtError(Exception):
    """The motion was asked for its rows."""


class Motion:
    @property
    def rows(self) -> None:
        raise LookedAtError


@pytest.mark.parametrize("columns", [(), ("motor_a",), ("motor_b",)])
def test_encoders_of_one_motor_alone_tell_no_lag(columns: tuple[str, ...]) -> None:
    frame: Any = SimpleNamespace(get=dict.fromkeys(columns, np.ones(3)).get)
    motion: Any = Motion()
    assert kinematic_problem(frame, motion, np.zeros(3, dtype=bool), 1.0) is None


def test_encoders_of_both_are_looked_at() -> None:
    both = {"motor_a": np.ones(3), "motor_b": np.ones(3)}
    frame: Any = SimpleNamespace(get=both.get, scale={"gear_ratio": 1})
    motion: Any = Motion()
    with pytest.raises(LookedAtError):
        kinematic_problem(frame, motion, np.zeros(3, dtype=bool), 1.0)


def test_a_piece_is_as_long_as_most_are() -> None:
    p: Any = SimpleNamespace(session=np.array([0, 0, 0, 1, 1, 2, 2, 2, 2, 2]), period_s=0.5)
    assert piece_s(p) == 1.5


@pytest.mark.parametrize(
    ("rms", "gains", "row"),
    [
        ((1.0, 2.01, 2.01), (9.0, 2.0, 2.0), 0),  # one of the rows leaves less than half
        ((2.01, 1.0, 2.01), (2.0, 9.0, 2.0), 1),
        ((1.0, 1.0, 1.0), (9.0, 5.0, 2.1), 2),  # none does: the declared gain is 2
        ((1.0, 2.0, 2.01), (9.0, 2.0, 2.0), 1),
    ],
)
def test_the_row_of_a_law_is_the_clear_one_or_the_declared_gains(
    rms: tuple[float, ...], gains: tuple[float, ...], row: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = [SimpleNamespace(rms=r, gains=np.array([g])) for r, g in zip(rms, gains, strict=True)]
    monkeypatch.setattr(law, "_command_of", lambda *given: tried[(0, 1, -1).index(given[-1])])
    monkeypatch.setattr(law, "_known", lambda *_: np.zeros(3))
    monkeypatch.setattr(law, "declared_terms", lambda _: {"kp": 2.0})
    view: Any = SimpleNamespace(at=lambda x: x, columns={"reference": np.zeros(3)})
    none: Any = None
    assert law.command_of(view, none, none) is tried[row]
