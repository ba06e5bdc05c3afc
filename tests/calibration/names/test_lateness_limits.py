"""Which delay of an effort is told: its limits, beside searches that are given."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import NORMAL
from calibration.inputs.declaration import Response
from calibration.names import lateness
from tests.calibration.names.made import drive

late: Any = lateness
ROWS = 100


def told(
    monkeypatch: pytest.MonkeyPatch, delay: float = 0.05, error: float = 0.001, *, finer: Any = (0.05, 1.0),
    share: float = 0.5, everywhere: bool = True, period_s: float = 0.01, terms: int = 2, slow: int = 0,
    gain: float = 1.0,
) -> Any:  # fmt: skip
    """Of a force on a hundred rows, all but some of which are quicker than a fifth of the usual top speed."""
    speed = np.where(np.arange(ROWS) < slow, 0.2, 1.0)
    force = np.arange(float(ROWS))
    s = drive(force, response=Response("force", "N", gain=gain), columns={"force": force}, y=3.0 * force,
              base=np.ones((ROWS, terms)), speed=speed, period_s=period_s)  # fmt: skip
    steps = iter([(delay, error), finer])
    asked: Any = []
    rivals = [np.full((ROWS, 1), 7.0), np.full((ROWS, 1), 8.0)]
    monkeypatch.setattr(late, "plain", lambda s: np.full((ROWS, 1), 5.0))
    monkeypatch.setattr(late.stribeck_change, "columns", lambda s: [Some(columns=x) for x in rivals])
    monkeypatch.setattr(late, "any_friction_curve", lambda s: np.full((ROWS, 1), 9.0))

    def converge(s: Any, moved: Any, more: Any) -> Any:
        assert moved(0.0) == pytest.approx(s.problem.y)  # what constants took off is known
        asked.append(more[0].tolist())
        return next(steps)

    def left(s: Any, y: Any, more: Any) -> float:
        moved = not np.array_equal(y, s.problem.y)
        return (10.0 if more[0, 2] == 8.0 else 20.0) * (np.sqrt(1 - share) if moved else 1.0)

    monkeypatch.setattr(late, "_converge", converge)
    monkeypatch.setattr(late, "_left", left)
    monkeypatch.setattr(late, "_everywhere", lambda s, y, d, more: everywhere and more[0, 2] == 8.0)
    f, said = late.effort_delay(s, np.full((ROWS, 1), 6.0))
    assert not asked or asked[0] == [5.0, 6.0, 8.0]  # the friction that leaves least, of three
    assert len(asked) < 2 or asked[1] == [5.0, 6.0, 9.0]
    return f, said


@pytest.mark.parametrize(
    ("given", "there"),
    [
        ({}, True),
        ({"delay": 0.05, "error": 0.0099}, True),  # five errors
        ({"delay": 0.05, "error": 0.01}, False),
        ({"delay": 0.002, "error": 1e-5}, False),  # a fifth of a period
        ({"delay": 0.0021, "error": 1e-5}, True),
        ({"delay": -0.0021, "error": 1e-5}, True),
        ({"delay": 0.249}, True),  # twenty-five periods
        ({"delay": 0.25}, False),
        ({"delay": 0.099, "period_s": 0.001}, True),  # or a tenth of a second
        ({"delay": -0.1, "period_s": 0.001}, False),
        ({"everywhere": False}, False),
        ({"terms": 5}, True),  # twenty rows a term
        ({"terms": 6}, False),
        ({"terms": 4, "slow": 20}, True),
        ({"terms": 4, "slow": 21}, False),  # slow rows say nothing
        ({"share": 0.021}, True),
        ({"share": 0.019}, False),
    ],
)
def test_a_delay_is_told_within_its_limits(
    monkeypatch: pytest.MonkeyPatch, given: dict[str, Any], there: bool
) -> None:
    f, said = told(monkeypatch, **given)
    assert (f is not None) == there and (said == "") == (given.get("share") != 0.019)
    if f is not None:
        assert f.share == pytest.approx(given.get("share", 0.5))
        assert f.parameters["delay"].value == given.get("delay", 0.05)
        assert f.note.startswith("the force column is " + ("late" if given.get("delay", 1) > 0 else "early"))


@pytest.mark.parametrize(
    ("delay", "error", "share", "took"),
    [
        (0.05, 0.001, 0.0051, "0.5"),
        (0.05, 0.001, 0.0049, ""),  # half a hundredth
        (0.0089, 0.001, 0.0123, ""),  # six tenths of a period and three errors
        (0.0091, 0.001, 0.0123, "1.2"),
    ],
)
def test_a_delay_that_takes_little_is_close(
    monkeypatch: pytest.MonkeyPatch, delay: float, error: float, share: float, took: str
) -> None:
    f, said = told(monkeypatch, delay, error, share=share)
    what = f"channel_delay of force, {delay * 1000:.2g} +- 1 ms, was close"
    why = f"it takes {took} % of the held-out mean square"
    assert f is None and said == (f"{what} ({why}): quicker turns and a quieter effort" if took else "")


@pytest.mark.parametrize(
    ("finer", "value", "error"),
    [
        ((0.06, 0.0119), 0.06, float(np.hypot(0.0119, 0.005))),  # a fifth of it, and half the distance
        ((0.06, 0.012), 0.05, 0.001),
        ((-0.06, 0.001), 0.05, 0.001),  # the other way
        ((0.0, 0.0), 0.05, 0.001),
    ],
)
def test_a_size_beside_any_friction_curve_is_taken_where_it_is_told(
    monkeypatch: pytest.MonkeyPatch, finer: tuple[float, float], value: float, error: float
) -> None:
    f, _ = told(monkeypatch, finer=finer, gain=2.0)
    p = f.parameters["delay"]
    assert p.value == value and p.high - p.value == pytest.approx(NORMAL * error)


@pytest.mark.parametrize(("best", "start"), [(0.0, 0.0), (0.0125, 0.0125), (-0.25, -0.25), (0.249, 0.25)])
def test_the_search_begins_at_the_best_of_forty_one_delays(
    monkeypatch: pytest.MonkeyPatch, best: float, start: float
) -> None:
    """From 25 periods early to as many late, an eightieth of a second apart."""
    s = drive(np.arange(float(ROWS)), base=np.ones((ROWS, 1)))
    wave = np.sin(np.arange(ROWS))
    seen: Any = []

    def step(s: Any, y: Any, more: Any) -> Any:
        seen.append(float(np.sqrt(np.abs((y @ wave) / (wave @ wave)))))
        return 0.0, 0.5

    monkeypatch.setattr(late, "_step", step)
    found, error = late._converge(s, lambda d: (d - best) ** 2 * wave, np.zeros((ROWS, 0)))
    assert found == pytest.approx(start) and error == 0.5 and len(seen) == 1


@pytest.mark.parametrize(
    ("steps", "taken", "found"),
    [
        ((0.001, 0.001, 0.001, 0.001, 0.001, 0.001), 5, 0.005),  # five rounds
        ((0.00011, 0.00009, 1.0), 2, 0.0002),  # a hundredth of a period ends it
        ((0.0001, 1.0, 0.0), 3, 0.25),
        ((-9.0, 0.0), 2, -0.25),  # no further than is looked at
    ],
)
def test_the_search_ends_after_a_small_step(
    monkeypatch: pytest.MonkeyPatch, steps: Any, taken: int, found: float
) -> None:
    s = drive(np.arange(float(ROWS)), base=np.ones((ROWS, 1)))
    each = iter(steps)
    count: Any = []
    monkeypatch.setattr(late, "_step", lambda s, y, more: (count.append(1) or next(each), 0.5))
    wave = np.sin(np.arange(ROWS))
    got, _ = late._converge(s, lambda d: d * wave, np.zeros((ROWS, 0)))
    assert (len(count), got) == (taken, pytest.approx(found))
