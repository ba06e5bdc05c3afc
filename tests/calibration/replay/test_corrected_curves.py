"""Curves of what has no name, the facts a plant file needs, and what is written and run when."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.finding import Curve, Finding
from calibration.look.looked import Looked
from calibration.replay import corrected as module
from calibration.replay.corrected import (
    curve_of,
    knots_over,
    with_curves,
)
from tests.calibration.report.drawn import effect, fit, problem, selection

N = 600
U = np.linspace(-2.0, 4.0, N)


def test_knots_are_even_but_over_speed_denser_about_zero() -> None:
    assert knots_over("axis_angle", U) == pytest.approx(np.linspace(-2.0, 4.0, 24))
    low, high = -1e-3, 4e-3
    found = knots_over("velocity", np.array([high, 0.0, low]))
    assert (found[0], found[-1], len(found)) == (pytest.approx(low), pytest.approx(high), 24)
    z = np.sign(found) * np.log1p(np.abs(found) / 5e-5)  # even in the logarithm beyond 5e-5 rad/s
    assert np.diff(z) == pytest.approx(np.full(23, (np.log1p(high / 5e-5) + np.log1p(-low / 5e-5)) / 23))


def view(**columns: np.ndarray) -> Any:
    zero = np.zeros(N)
    return SimpleNamespace(columns=columns, x=U, speed=zero, clock=zero, rows=np.arange(N))


def curve(
    domain: str = "axis_angle", kind: str = "linear", spread: float = 0.0, held: int = 0, **more: Any
) -> Curve | None:
    """Of a column that bends once, -3 U beyond 1, with the coefficient 2."""
    column = np.where(U > 1.0, -3.0 * (U - 1.0), 0.0)
    p = problem(more.pop("y", np.zeros(N)), held, block_s=6.0)
    after = replace(fit(np.zeros(N), 2.0), covariance=np.array([[spread**2]]))
    s = selection(p, replace(effect(column, "unknown", kind=kind), domain=domain), after=after)
    return curve_of(s, 0, more.pop("view", view()))


def test_a_curve_adds_what_the_balance_lacks_the_other_way() -> None:
    found = curve()
    assert found is not None and (found.domain, found.unit, len(found.x)) == ("axis_angle", "N m", 24)
    x = np.array(found.x)
    inside = np.abs(x - 1.0) > 0.4
    assert np.array(found.y)[inside] == pytest.approx(6.0 * np.maximum(x - 1.0, 0.0)[inside], abs=0.05)


def test_a_curves_half_width_is_of_the_blocks_and_the_models_own_error() -> None:
    """Three per cent of a value, or the coefficient's error; 50 blocks of twelve rows, less two."""
    t_48 = 2.0106  # tables of Student's t, 97.5 %
    exact, spread = curve(), curve(spread=0.5)
    assert exact is not None and spread is not None
    assert exact.half[-1] == pytest.approx(t_48 * 0.03 * exact.y[-1], rel=1e-3)
    size = np.hypot(0.03 * spread.y[-1], 0.5 * 3.0 * (spread.x[-1] - 1.0))
    assert spread.half[-1] == pytest.approx(t_48 * size, rel=0.05)
    few = curve(held=560)
    assert few is not None and few.half[0] == pytest.approx(
        3.1824 * 0.03 * abs(few.y[0]), rel=1e-3
    )  # t of three


def test_a_function_of_current_is_one_of_torque() -> None:
    found = curve("current", y=10.0 + U)
    assert found is not None and found.domain == "torque"
    assert [found.x[0], found.x[-1]] == pytest.approx([8.0, 14.0])
    other = curve("temperature", view=view(temperature=U + 20.0))
    assert other is not None and other.domain == "temperature" and other.x[0] == pytest.approx(18.0)


@pytest.mark.parametrize(
    "more", [{"kind": "line"}, {"domain": "moon"}, {"domain": "time"}, {"domain": "temperature"}]
)
def test_a_line_a_domain_without_a_column_and_one_that_stands_have_no_curve(more: dict[str, Any]) -> None:
    assert curve(**more) is None


def test_only_functions_without_a_name_of_an_axis_torque_have_a_curve(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def made(s: Any, k: int, view: Any) -> Curve:
        asked.append((k, view))
        return Curve("time", "N m", (), (), ())

    monkeypatch.setattr(module, "curve_of", made)
    column = np.ones(N)
    s = selection(
        problem(np.zeros(N)), effect(column, "drag"), effect(column, "unknown"), effect(column, "unknown")
    )
    result: Any = SimpleNamespace(selections={"T": s}, views={"T": "the view"})
    effects = [
        Finding("unknown", "T", "time"), Finding("unknown", "T", "velocity"), Finding("unknown", "K", "time"),
        Finding("drag", "T", "time"),
    ]  # fmt: skip
    looked = Looked(title="", header={"axis": "ra"}, axis=result, effects=effects)
    found = with_curves(looked).effects
    assert [f.curve is not None for f in found] == [True, False, False, False] and asked == [(1, "the view")]
    for other in (replace(looked, header=None), replace(looked, axis=None)):
        assert with_curves(other) is other
    bare = replace(looked, axis=SimpleNamespace(selections={}, views={}))  # type: ignore[arg-type]
    assert with_curves(bare) is bare
