"""The response of a drive and its declared terms, column by column."""

from typing import Any

import numpy as np
import pytest

from calibration.balances import balance
from calibration.balances.balance import default_terms, problem_of, response_of, term_of
from calibration.balances.filters import Filter
from calibration.balances.view import View
from calibration.inputs.declaration import Column, Response
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 400
T: np.ndarray = PERIOD_S * np.arange(ROWS)
X: np.ndarray = 2.0 + np.sin(2 * np.pi * T / 2)
FORCE = np.cos(T)
INNER = slice(2, -2)


def view(response: Response | None = None, **more: Any) -> View:
    more.setdefault("columns", {"force": FORCE, "load": np.where(T < 1, 0.1, 2.0 + T)})
    more.setdefault("direction", np.sign(np.gradient(X)))
    return drive(more.pop("x", X), response=response or Response("force", "N"), **more).view


def response(given: Response, delay_s: float = 0.0, **more: Any) -> tuple[np.ndarray, np.ndarray]:
    return response_of(view(given, **more), delay_s)


def test_a_response_is_its_column_times_a_gain() -> None:
    y, ok = response(Response("force", "N", gain=-3.0))
    assert y == pytest.approx(-3 * FORCE) and ok.all() and len(ok) == ROWS
    late, _ = response(Response("force", "N"), 2 * PERIOD_S)
    assert late[:-2] == pytest.approx(FORCE[2:])


def test_a_second_sensor_is_taken_beside_the_first() -> None:
    y, _ = response(Response("force", "m", gain=2.0, ratio=0.5))
    assert y == pytest.approx(2 * FORCE - 0.5 * X)


def test_a_divisor_that_is_small_says_nothing() -> None:
    """Half of the median divisor and less; of a supply every row counts, by its mean."""
    below = np.full(ROWS, -4.0)
    below[:3] = -2.0, -2.001, 0.0
    y, ok = response(Response("force", "1", divide_by="load"), columns={"force": FORCE, "load": below})
    assert ok[:4].tolist() == [False, True, False, True]
    assert y[1] == pytest.approx(FORCE[1] / -2.001) and y[0] == y[2] == 0.0
    assert y[5:] == pytest.approx(FORCE[5:] / -4)
    supply = np.full(ROWS, 12.0)
    supply[0] = 0.0
    supply[1] = 6.0
    y, ok = response(Response("force", "V", divide_by="supply"), columns={"force": FORCE, "supply": supply})
    assert ok.all() and y[0] == 0.0 and y[1] == pytest.approx(FORCE[1] * supply.mean() / 6)


def test_of_an_acceleration_forces_overcome_its_opposite() -> None:
    given = Response("acceleration", "m/s2", gain=2.0)
    assert response(given)[0][INNER] == pytest.approx(2 * np.pi**2 * (X - 2)[INNER], rel=1e-3, abs=1e-9)
    own, _ = response(given, columns={"acceleration": FORCE})
    assert own == pytest.approx(-2 * FORCE)


@pytest.mark.parametrize(
    ("given", "estimate", "terms"),
    [
        (Response("velocity", "m/s"), ("viscous",), ("offset",)),
        (Response("force", "N"), (), ("viscous", "coulomb", "offset")),
        (Response("force", "N"), ("inertia",), ("inertia",)),
        (Response("position2", "m"), (), ("offset", "scale")),
        (Response("position2", "m"), ("drift",), ("offset", "scale", "drift")),
        (Response("position2", "m", ratio=1.0), ("drift",), ("offset", "drift")),
        (Response("position3", "m"), (), ("offset",)),
    ],
)
def test_terms_are_the_rig_file_s_and_what_the_kind_needs(
    given: Response, estimate: tuple[str, ...], terms: tuple[str, ...]
) -> None:
    assert default_terms(view(given, rig={"estimate": estimate})) == terms


def column(name: str, given: View | None = None) -> tuple[str, str, np.ndarray]:
    (found,) = term_of(given or view(), name)
    return found


def test_every_term_has_its_column_and_unit() -> None:
    assert column("offset")[:2] == ("offset", "N") and np.array_equal(column("offset")[2], np.ones(ROWS))
    assert column("inertia")[1] == "N s2/m"
    assert column("inertia")[2][INNER] == pytest.approx(-(np.pi**2) * (X - 2)[INNER], rel=1e-3, abs=1e-9)
    own = view(columns={"acceleration": FORCE})
    assert np.array_equal(column("inertia", own)[2], FORCE)
    assert column("viscous")[1] == "N s/m"
    assert column("viscous")[2][INNER] == pytest.approx(np.pi * np.cos(np.pi * T)[INNER], abs=1e-2)
    slow = view(speed=FORCE, dynamic=False)
    assert np.array_equal(column("viscous", slow)[2], FORCE)
    assert np.array_equal(column("coulomb")[2], np.sign(np.gradient(X)))
    assert column("drift")[1] == "N/s" and column("drift")[2] == pytest.approx(T - T.mean())
    for name in ("stiffness", "scale"):
        assert column(name)[1] == "N/m" and column(name)[2] == pytest.approx(X - X.mean())


@pytest.mark.parametrize(("channel", "sign"), [("force", 1.0), ("acceleration", -1.0)])
def test_an_applied_force_drives_an_acceleration(channel: str, sign: float) -> None:
    given = view(Response(channel, "N"), columns={"applied": FORCE, "force": FORCE})
    name, unit, x = column("applied", given)
    assert (name, unit) == ("applied", "N/1") and np.array_equal(x, sign * FORCE)
    given.rig.columns["applied"] = Column("V")
    assert column("applied", given)[1] == "N/V"


def test_offsets_per_file_stand_where_files_differ() -> None:
    files = np.repeat([0, 1], ROWS // 2)
    two = view(files=files)
    assert [name for name, _, _ in term_of(two, "offset")] == ["offset"]
    own = term_of(two, "offset_per_file")
    assert [(name, unit) for name, unit, _ in own] == [("offset_1", "N"), ("offset_2", "N")]
    assert np.array_equal(own[1][2], files.astype(float))
    sensor = view(Response("position2", "m"), files=files)
    assert len(term_of(sensor, "offset")) == 2
    assert len(term_of(view(Response("position2", "m")), "offset")) == 1
    assert len(term_of(view(rig={"estimate": ("offset_per_file",)}), "offset_per_file")) == 1


def test_a_weight_is_carried_by_its_joints() -> None:
    """Of one joint in front its angle with this one's sum; a load multiplies; a turn is 5 units here."""
    angle, joint = X * 2 * np.pi / 5, T * 2 * np.pi / 5
    alone = term_of(view(turn=5.0, columns={}), "gravity")
    assert [name for name, _, _ in alone] == ["gravity_cos", "gravity_sin"] and alone[0][1] == "N"
    assert alone[0][2] == pytest.approx(np.cos(angle)) and alone[1][2] == pytest.approx(np.sin(angle))
    plain = term_of(view(columns={}), "gravity")
    assert plain[0][2] == pytest.approx(np.cos(2 * np.pi * X))
    carried = term_of(view(turn=5.0, columns={"load": 3 + T}), "gravity")
    assert carried[1][2] == pytest.approx((3 + T) * np.sin(angle))
    two = term_of(view(turn=5.0, columns={"joint2": T}), "gravity")
    assert [name for name, _, _ in two] == [f"gravity_{k}" for k in ("cos", "sin", "cos_joint", "sin_joint")]
    assert two[2][2] == pytest.approx(np.cos(angle + joint)) and two[3][2] == pytest.approx(
        np.sin(angle + joint)
    )


def test_of_several_joints_the_principal_parts_that_a_motion_shows_are_terms() -> None:
    rng = np.random.default_rng(1)
    one, two = 3 * rng.standard_normal(ROWS), 3 * rng.standard_normal(ROWS)
    spread = view(
        turn=5.0, x=10 * rng.standard_normal(ROWS), direction=T, columns={"joint": one, "joint2": two}
    )
    parts = term_of(spread, "gravity")
    assert [name for name, _, _ in parts] == [f"gravity_{k}" for k in range(1, 19)]
    columns = np.column_stack([x for _, _, x in parts])
    norms = np.linalg.norm(columns, axis=0)
    assert (np.diff(norms) <= 1e-9).all()  # the largest first
    products = columns.T @ columns
    assert products == pytest.approx(np.diag(norms**2), abs=1e-6 * norms[0] ** 2)
    # squares of a cosine and a sine are one: either joint adds as much as there was
    assert np.sum(columns**2, axis=1) == pytest.approx(4.0)
    still = view(turn=5.0, columns={"joint": 0 * T, "joint2": 0 * T})
    assert len(term_of(still, "gravity")) == 2  # only this one moves
    few = view(turn=5.0, columns={"joint": 1e-3 * T, "joint2": 0 * T})
    assert len(term_of(few, "gravity")) == 2
    more = view(turn=5.0, columns={"joint": 0.1 * T, "joint2": 0 * T})
    assert len(term_of(more, "gravity")) > 2


def log(**more: Any) -> tuple[View, np.ndarray]:
    """Strokes with inertia 2, viscous 3, Coulomb 0.5 N; the force is exact."""
    x = back_and_forth(6, 300, 1.0)
    x = np.convolve(np.pad(x, 10, mode="edge"), np.hanning(21) / np.hanning(21).sum(), "valid")
    given = {"rig": {"estimate": ("inertia", "viscous", "coulomb"), "hold_out": 0.25}, **more}
    v = drive(x, response=Response("force", "N"), **given).view
    y = 2 * v.second(x) + 3 * v.rate(x) + 0.5 * v.direction
    v.columns["force"] = y
    v.slow = 0.05 * v.top
    return v, y


def test_a_balance_is_made_of_the_filtered_columns_and_solved_by_what_made_them() -> None:
    v, y = log()
    p = problem_of(v, [], [])
    assert (p.channel, p.unit, p.ar_order, p.period_s) == ("T", "N", 0, PERIOD_S)
    assert p.base_labels == [("inertia", "N s2/m"), ("viscous", "N s/m"), ("coulomb", "N")]
    assert p.plain_fit(p.train)[0] == pytest.approx({"inertia": 2.0, "viscous": 3.0, "coulomb": 0.5})
    assert np.array_equal(p.y, y) and p.fresh is None
    assert not p.valid[np.abs(v.speed) < v.slow].any()
    assert p.valid[np.abs(v.speed) >= v.slow].all()
    assert p.held[-450:].sum() == pytest.approx(450, abs=10) and not p.held[:-460].any()


def test_known_terms_are_taken_off_the_response() -> None:
    v, _y = log(rig={"estimate": ("viscous",), "constants": {"inertia": 2.0, "coulomb": 0.5}})
    p = problem_of(v, [], [])
    assert p.y == pytest.approx(3 * v.rate(v.x)) and p.known == {"inertia": 2.0, "coulomb": 0.5}


def test_a_known_weight_and_a_known_force_are_taken_off_the_response() -> None:
    rig = {"estimate": ("viscous",), "constants": {"gravity_sin": 0.5, "gravity_cos": -0.25, "applied": 4.0}}
    v, y = log(rig=rig, turn=2 * np.pi)
    v.columns["applied"] = np.arange(len(v.t)) / len(v.t)
    known = 0.5 * np.sin(v.x) - 0.25 * np.cos(v.x) + 4.0 * v.columns["applied"]
    assert problem_of(v, [], []).y == pytest.approx(y - known)


def test_a_standing_drive_s_rows_count_by_the_filter() -> None:
    """A fifth of the filter's weight may stand; without accelerations it is the direction that tells."""
    v, _ = log(filter=Filter(6.0))
    v.slow = 0.9 * v.top
    p = problem_of(v, [], [])
    share = v.at((np.abs(v.speed) < v.slow).astype(float))
    assert np.array_equal(p.valid, (share < 0.2) & balance._apart(p.held, v))
    assert not p.valid.all() and share.max() > 0.2
    still, _ = log(dynamic=False)
    still.direction[100:200] = 0.0
    p = problem_of(still, [], [])
    assert not p.valid[100:200].any() and p.valid[:100].all()


def test_blocks_are_a_sixtieth_of_the_time_or_two_memories_of_the_filter() -> None:
    v, _ = log()
    p = problem_of(v, [], [])
    rows = int((np.abs(v.speed) >= v.slow).sum())
    assert p.block_s == pytest.approx(rows * PERIOD_S / 60, rel=1e-6)
    v.filter = Filter(9.0)
    assert balance._memory(v) == np.ceil(2 * 2 * np.sqrt(np.pi) * 9)
    v.rows = np.arange(0, len(v.x), 3)
    assert balance._memory(v) == np.ceil(2 * 2 * np.sqrt(np.pi) * 3)
    v.rows = np.arange(0, len(v.x), 30)
    assert balance._memory(v) == 8.0
    v.dynamic = False
    assert balance._memory(v) == 20
    v.rows = np.arange(0, len(v.x), 3)
    p = problem_of(v, [], [])
    assert p.block_s == pytest.approx(max(20 * 0.03, 0.03 * 600 / 60)) and p.period_s == pytest.approx(0.03)
