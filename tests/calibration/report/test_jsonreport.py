"""report.json from what was looked at: what of every balance stands where, and what is left out."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.decide import verdict
from calibration.decide.heldout import HeldOut
from calibration.decide.selection import Refusal
from calibration.finding import Finding
from calibration.look.looked import Balance, Looked
from calibration.replay.held import Replay
from calibration.report import jsonreport
from calibration.report.jsonreport import report_of
from tests.calibration.report.drawn import problem, scores, selection


def balance(key: str, row: str | None, value: float, before: float = 2.0, **more: Any) -> Balance:
    s = selection(
        problem(np.zeros(8)), held=HeldOut(before=before, after=1.0), scores=scores([value], 3.5, [1.0])
    )
    s.refused = [Refusal("drag", "too small"), Refusal("drag", "again"), Refusal("play", f"in {key}")]
    given: dict[str, Any] = {"key": key, "row": row, "selection": s}
    return Balance(**(given | more))


def made(**more: Any) -> Looked:
    balances = [
        balance("T", "torque", 7.0, notes=["a note"], floor=0.5, controls=[{"what": "half a turn"}]),
        balance("K", None, np.inf, remarks=["a remark"]),
        balance("E", "electrical", 1e7, before=float("nan")),
    ]
    given: dict[str, Any] = {
        "title": "a drive", "balances": balances, "notes": ["first", "a note"],
        "rows": {"velocity": {"unit": "1"}},
        "held_out": ["run4"], "refused": [("S", "late", "no clock")],
    }  # fmt: skip
    return Looked(**(given | more))


def test_every_balance_has_its_rows() -> None:
    told = report_of(made(), Replay(reasons=["not replayed"]))
    assert told["error"] == {
        "torque": {"unit": "N m", "before": 2.0, "after": 1.0, "floor": 0.5}, "velocity": {"unit": "1"}
    }  # fmt: skip
    assert told["thresholds"] == {
        "T": {"threshold": 3.5, "statistic": 7.0},
        "K": {"threshold": 3.5, "statistic": 1e6},
        "E": {"threshold": 3.5, "statistic": 1e6},
    }
    assert told["controls"] == [{"what": "half a turn", "channel": "T"}]
    assert told["reasons"][:3] == ["first", "a note", "not replayed"] and told["reasons"][-1] == "a remark"
    assert len(told["reasons"]) == len(set(told["reasons"]))
    assert told["held_out"] == ["run4"] and "closed_loop" not in told
    why = [("S", "late", "no clock")]
    for key in "TKE":
        why += [(key, "drag", "too small"), (key, "play", f"in {key}")]
    assert [(x["channel"], x["what"], x["why"]) for x in told["refused"]] == why


def test_a_replayed_loop_has_its_figures() -> None:
    rows = {"torque": {"unit": "N m", "before": 2.0, "after": 1.0, "floor": 1.0}}
    assert report_of(made(), Replay(rows=rows))["closed_loop"] == rows


def test_what_was_earned_is_for_answers_of_two_names_at_most(monkeypatch: Any) -> None:
    asked: list[Any] = []

    def noted(e: Finding, k: int, error: Any, earned: Any) -> dict[str, Any]:
        asked.append((e.name, k, earned))
        return {}

    monkeypatch.setattr(jsonreport, "effect_as_dict", noted)
    monkeypatch.setattr(jsonreport, "judge", lambda *_: ("found", None))
    monkeypatch.setattr(verdict, "conventions", lambda *_: [])
    earned: dict[str, Any] = {"drag": 1}
    drag, play, mesh = (Finding(name, "T", "time", share=0.5) for name in ("drag", "play", "gear_mesh"))
    clock = Finding("clock_drift", "S", "clock")
    for effects, told in (
        ([drag, play], earned),
        ([drag, play, drag, clock], earned),
        ([drag, play, mesh], None),
        ([drag, play, replace(play, stage="mesh2")], None),
    ):
        asked.clear()
        report_of(made(effects=effects, earned=earned), Replay())
        assert asked == [(e.name, k, told) for k, e in enumerate(effects)]
