"""What a log could show of a response, from a view and a balance that are given."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.balances.width import NARROW, USUAL
from calibration.inputs.declaration import Response, Rig, Stage
from calibration.inputs.rigfile import telescope
from calibration.report import rigview
from calibration.report.rigview import _power
from tests.calibration.report.test_rig_shown import record

STAGES = (Stage("motor", 2.0, None, 2, None), Stage("worm", None, 480.0, 2, None))
BENCH = Rig("bench", Path("r"), {}, (Response("force", "N"),), STAGES, estimate=("offset",))


def power(monkeypatch: pytest.MonkeyPatch, share: float = 0.08, rig: Rig = BENCH, **more: Any) -> list[str]:
    """Of 400 rows, of which three quarters are fitted, with a rest of 2 N."""
    count = more.pop("count", 400)
    train = np.arange(count) < count * more.pop("part", 0.75)
    rest = np.resize([2.0, -2.0], count)
    p = SimpleNamespace(
        train=train,
        test=~train,
        unit="N",
        blocks=25,
        plain_fit=lambda at: ({}, rest * (at == train)),
        base_labels=[("scale", "1"), ("offset", "N")],
    )
    view = SimpleNamespace(
        sigma=0.0, wide=5.0, period_s=0.01, filter=SimpleNamespace(sigma=0.0), dynamic=False, both=True,
        x=np.arange(float(count)), rows=np.arange(count),
    )  # fmt: skip
    view.__dict__.update(more)
    views = {id(USUAL): view, id(NARROW): SimpleNamespace(wide=2.0)}
    asked: list[Any] = []
    monkeypatch.setattr(rigview, "view_of", lambda *given: views[id(given[-1])])
    monkeypatch.setattr(rigview, "problem_of", lambda *given: p)
    monkeypatch.setattr(rigview, "least_share", lambda _, count: share if count == 1000 else None)
    monkeypatch.setattr(rigview, "one_filter", lambda *given: asked.append(given))
    found = list(_power([record(count)], rig, rig.responses[0]))
    assert bool(asked) is bool(view.dynamic and found)
    return found


def test_a_log_shows_what_is_plain_in_its_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    turns, rest = "  turns: 149.5 of motor", "  the declared terms leave 2 N rms"
    named = "  could be named beside that: "
    assert power(monkeypatch) == [
        "force: 300 rows to fit through no filter (0.1 s where that shows nothing), 25 independent blocks",
        turns,
        rest,
        named + "a line of 0.8 N or more, 8 % of its square",  # an amplitude of a times sqrt(2 share)
    ]
    smooth = power(monkeypatch, 0.99, sigma=3.0, filter=SimpleNamespace(sigma=3.0), wide=2.0, dynamic=True)
    assert smooth[0] == "force: 300 rows to fit through a filter of 0.15 s, 25 independent blocks"
    assert smooth[3] == named + "a line of 2.81 N or more, 99 % of its square"
    assert power(monkeypatch, 1.0)[3] == named + "nothing, as the log is too short"
    assert power(monkeypatch, rig=replace(BENCH, stages=STAGES[1:]))[1] == rest
    one_way = "  it moves one way, which does not separate Coulomb friction from an offset"
    assert power(monkeypatch, both=False)[1] == one_way
    assert power(monkeypatch, rig=replace(BENCH, estimate=()))[2] == "  its terms: scale, offset"


def test_a_short_log_one_part_or_another_kind_of_drive_has_no_power(monkeypatch: pytest.MonkeyPatch) -> None:
    assert power(monkeypatch, count=199) == [] and len(power(monkeypatch, count=200)) == 4
    assert power(monkeypatch, part=1.0) == power(monkeypatch, part=0.0) == []
    assert power(monkeypatch, rig=replace(BENCH, motors=telescope("ra").motors)) == []
    assert power(monkeypatch, rig=replace(BENCH, responses=(Response("position", "deg"),))) == []
