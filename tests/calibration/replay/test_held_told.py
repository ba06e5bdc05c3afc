"""Errors of a replayed run, rows near a break-away, and every sentence that a report has of them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.frame import Frame
from calibration.replay import held as module
from calibration.replay.gains import Gains
from calibration.replay.held import (
    Replay,
    _beside,
    _conditions,
    _judge,
    replay,
)
from plant.model import with_effects
from tests.calibration.logs import effect
from tests.calibration.replay.frames import frame
from tests.calibration.replay.test_held import MODEL, K, N, trace


def judged(
    before: float, after: float, noise: float = 0.0, chaos: int = 0
) -> tuple[dict[str, Any], list[str]]:
    """Torques off by so much, over a log of such noise; the last `chaos` rows break away."""
    log = replace(trace(), torque=noise * np.resize([1.0, -1.0], N) * np.sqrt(70) / 16)
    whole = np.ones(N, dtype=bool)
    pairs = {key: [(log, trace(off), whole)] for key, off in (("before", before), ("after", after))}
    return _judge(pairs, [np.arange(N) >= N - chaos])


@pytest.mark.parametrize(
    ("before", "after", "noise", "worse"),
    [(2.0, 1.0, 0.0, False), (1.0, 1.25, 0.0, False), (1.0, 1.26, 0.0, True), (0.1, 0.5, 1.0, False)],
)
def test_worse_is_a_quarter_more_and_well_above_the_floor(
    before: float, after: float, noise: float, worse: bool
) -> None:
    rows, reasons = judged(before, after, noise)
    assert rows["torque"]["before"] == pytest.approx(np.hypot(before, noise * np.sqrt(70) / 16))
    assert rows["torque"]["after"] == pytest.approx(np.hypot(after, noise * np.sqrt(70) / 16))
    assert (rows["torque"]["unit"], rows["position"]["unit"]) == ("N m", "arcsec")
    assert rows["torque"]["floor"] == pytest.approx(noise)
    said = "closed loop replayed: the corrected plant is WORSE than the declared one in torque"
    assert reasons == [f"{said}: 1 before, 1.26 N m after"] * worse


@pytest.mark.parametrize(
    ("chaos", "told"),
    [
        (0, ""),
        (12, ""),  # a fiftieth of the rows
        (13, "2 %"),
        (500, "83 %"),
        (501, "sticking"),
    ],
)
def test_rows_near_a_break_away_are_left_out_and_told(chaos: int, told: str) -> None:
    reasons = judged(2.0, 1.0, chaos=chaos)[1]
    if told == "sticking":
        assert reasons == ["closed loop replayed: the whole of the held-out rows is sticking and slipping"]
    elif told:
        assert reasons == [
            f"closed loop replayed: {told} of the settled rows are within a second of a passage through the "
            "Stribeck speed and left out. The moment of breaking away cannot be repeated. With "
            "them torque 2 before, "
            "1 N m after, velocity 0 before, 0 arcsec/s after, position 0 before, 0 arcsec after"
        ]
    else:
        assert reasons == []


def test_how_far_transients_move_the_axis_is_told() -> None:
    assert _beside({"before": [], "after": []}) == []
    assert _beside({"before": [3.0, 4.0], "after": [1.0, -1.0]}) == [
        "closed loop replayed: each of 2 transients moves it against the log by 3.54 arcsec "
        "before, 1 arcsec after "
        "(rms); the set point of a transient takes that out"
    ]


def test_the_gains_and_what_is_left_out_are_told() -> None:
    f = frame(10)
    told = _conditions(Gains(1.23456, 0.5), {"b", "a"}, f)
    begin = "closed loop replayed"
    assert told == [
        f"{begin} with gains identified from set point, velocity and effort: Kp 1.235, Ki 0.5",
        f"{begin} without a: its trace or phase is a new one in every run",
        f"{begin} without b: its trace or phase is a new one in every run",
    ]
    unknown = "the log does not tell the gains, the plant file's were used"
    assert _conditions(None, set(), f) == [f"{begin}: {unknown}"]
    f.columns["setpoint"][:] = np.nan
    assert _conditions(None, set(), f) == [f"{begin}: the log is open loop, its effort was replayed"]


def replayed(
    monkeypatch: pytest.MonkeyPatch, f: Frame, held: np.ndarray, fails: str = "", **more: Any
) -> tuple[Replay, list[Any]]:
    """With the torque that a model's first effect says, else 2 N m."""
    asked: list[Any] = []

    def driven(loop: Any, model: Any, whole: np.ndarray, use: np.ndarray) -> Any:
        if fails:
            raise ValueError(fails)
        effects = model.axes.ra.effects
        asked.append((np.flatnonzero(whole).tolist()[:: int(whole.sum()) - 1], int(use.sum()), loop.gains))
        size = effects[0].parameters["amplitude"].value if effects else 2.0
        return trace(size, ripple=0.5, n=int(whole.sum())), np.array([size])

    monkeypatch.setattr(module, "drive", driven)
    monkeypatch.setattr(module, "identify", lambda _, rows: Gains(1.0, 1.0) if rows[0] else None)
    mesh = effect("gear_mesh", "mesh3", amplitude=(1.0, "N m"), phase=(0.7, "rad"))
    corrected = more.pop("corrected", with_effects(MODEL, "ra", [mesh]))
    return replay(f, held, MODEL, corrected, 50.0, **more), asked


def test_every_run_with_held_out_rows_is_driven_by_both_models_up_to_the_last_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    f = frame(300, 400, 400, position=np.cumsum(np.full(1100, 1e-4)))
    at = np.arange(1100)
    held = ((at >= 300) & (at < 600)) | (at >= 950)
    got, asked = replayed(monkeypatch, f, held, mean_currents=True)
    # of the run from 300 on, rows 401 to 599 are settled; of the last one those from 950 on
    assert [x[:2] for x in asked] == [([300, 599], 199)] * 2 + [([700, 1099], 150)] * 2
    assert asked[0][2] == Gains(1.0, 1.0) and got.run == "run2"
    assert got.rows["torque"]["before"] == 2.0 and got.rows["torque"]["after"] == 1.0
    assert got.time.tolist() == pytest.approx((0.01 * np.arange(300)).tolist()) and got.use.sum() == 199
    assert got.after is not None and got.before is not None and got.before.torque[0] == 2.0
    assert any(
        "2 transients moves it against the log by 2 arcsec before, 1 arcsec after" in r for r in got.reasons
    )


def test_currents_at_the_edge_are_compared_with_the_ripple(monkeypatch: pytest.MonkeyPatch) -> None:
    held = np.arange(600) >= 300
    monkeypatch.setattr(module, "sampled_at_the_edge", lambda *_: True)
    got, asked = replayed(monkeypatch, frame(300, 300), held)
    assert got.rows["torque"]["after"] == 1.5
    assert replayed(monkeypatch, frame(300, 300), held, mean_currents=True)[0].rows["torque"]["after"] == 1.0
    same, asked = replayed(monkeypatch, frame(300, 300), held, corrected=MODEL)
    assert len(asked) == 1 and same.rows["torque"]["before"] == same.rows["torque"]["after"] == 2.5


def test_what_cannot_be_replayed_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    f = frame(600)
    got, _ = replayed(monkeypatch, f, np.arange(600) >= 0, fails="the drive runs away")
    assert got.reasons == ["closed loop not replayed: the drive runs away"] and got.rows == {}
    nothing = ["closed loop not replayed: the held-out rows hold no settled motion"]
    for held in (np.zeros(600, dtype=bool), (K >= 101) & (K < 200)):
        assert replayed(monkeypatch, f, held, mean_currents=True)[0].reasons == nothing
    got, _ = replayed(monkeypatch, f, (K >= 101) & (K < 201), mean_currents=True)
    assert got.run == "run1" and got.use.sum() == 100
