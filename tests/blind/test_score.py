"""Scoring: what counts as right, and what does not."""

from pathlib import Path
from typing import Any

import pytest

from tests.blind import score, table
from tests.blind.diagram import draw, points


def effect(name: str, equivalent: tuple[str, ...] = (), **more: Any) -> dict[str, Any]:
    return {"name": name, "equivalent": list(equivalent), "channel": "T", "parameters": {}, **more}


def truth(cell: str, *names: str, ratio: float = 2.0, klass: tuple[str, ...] | None = None) -> dict[str, Any]:
    effects = [
        {
            "name": n,
            "class": list(klass or (n,)),
            "ratio": ratio,
            "stage": None,
            "channel": "T",
            "domain": ["time"],
            "parameters": {"amplitude": {"value": 3.0, "unit": "N m"}},
        }
        for n in names
    ]
    drive = {
        "TC": 229.0,
        "TS": 621.0,
        "SIG2": 6700.0,
        "VS": 4e-4,
        "SIG0": 5.9e6,
        "SIG1": 3.9e3,
        "KA": 0.39,
        "RA": 2.2,
        "KGEAR": 3.08e6,
        "J": 1760.0,
        "JM": 8e-4,
    }
    return {
        "key": "k",
        "cell": cell,
        "kind": "mixed",
        "poor": klass is not None,
        "effects": effects,
        "drive": drive,
    }


def report(*effects: dict[str, Any], verdict: str = "found", **more: Any) -> dict[str, Any]:
    return {"verdict": verdict, "effects": list(effects), "error": {}, "calibrated": {}, **more}


ANSWER = {"seconds": 1.0, "failure": None, "status": 0}


@pytest.mark.parametrize(
    ("said", "equivalent", "wanted"),
    [
        ("gravity_imbalance", (), True),
        ("cable_wrap", (), False),
        ("position_friction", ("gravity_imbalance",), True),  # ambiguous inside the catalogue's twins
        ("coulomb_change", ("gravity_imbalance",), False),  # not twins: naming everything is not an answer
        ("unknown", (), False),
    ],
)
def test_right_name_or_class(said: str, equivalent: tuple[str, ...], wanted: bool) -> None:
    row = score.score(ANSWER, report(effect(said, equivalent)), truth("single", "gravity_imbalance"))
    assert row["right"] is wanted


def test_a_class_the_manoeuvre_leaves_may_be_answered_by_any_of_it() -> None:
    klass = ("motor_cogging", "torque_ripple")
    row = score.score(ANSWER, report(effect("torque_ripple")), truth("single", "motor_cogging", klass=klass))
    assert row["right"] and not row["exact"]


def test_two_effects_need_both_and_none_extra() -> None:
    both = truth("pair", "gear_mesh", "bearing_pass")
    one, two, three = effect("gear_mesh"), effect("bearing_pass"), effect("wind_torque")
    assert score.score(ANSWER, report(two, one), both)["right"]
    assert not score.score(ANSWER, report(one), both)["right"]
    assert not score.score(ANSWER, report(one, two, three), both)["right"]
    assert not score.score(ANSWER, report(one, one), both)["right"]


def test_nothing_is_right_only_when_nothing_is_said() -> None:
    none = truth("nothing")
    assert score.score(ANSWER, report(verdict="nothing"), none)["right"]
    assert score.score(ANSWER, report(effect("unknown"), verdict="unknown"), none)["right"] is False
    assert score.score(ANSWER, report(effect("unknown"), verdict="unknown"), none)["named"] == 0
    assert score.score(ANSWER, report(effect("gear_mesh")), none)["named"] == 1


def test_outside_needs_unknown_and_the_domain() -> None:
    hidden = truth("outside", "outside_mains")
    assert score.score(ANSWER, report(effect("unknown", domain="time")), hidden)["right"]
    assert not score.score(ANSWER, report(effect("unknown", domain="velocity")), hidden)["right"]
    assert not score.score(ANSWER, report(effect("wind_torque", domain="time")), hidden)["right"]


def test_no_answer_counts_against_the_finder() -> None:
    failed = {"seconds": 300.0, "failure": "too slow", "status": 1}
    rows = [
        score.score(failed, None, truth("single", "gear_mesh")),
        score.score(failed, None, truth("nothing")),
    ]
    lines = {line["figure"]: line["measured"] for line in table.figures(rows)}
    assert lines["right name or right class, one effect, ratio ≥ 2"]["hits"] == 0
    assert lines["logs without an effect in which one is named"]["hits"] == 1
    assert lines["cases without an answer"]["hits"] == 2


def test_worse_looks_at_the_channel_of_the_effect() -> None:
    error = {
        "torque": {"before": 2.0, "after": 2.1, "floor": 1.0},
        "position": {"before": 9.0, "after": 1.0, "floor": 1.0},
    }
    assert score.worse(report(effect("gear_mesh"), error=error))
    error["torque"]["after"] = 1.9
    assert not score.worse(report(effect("gear_mesh"), error=error))


def test_coverage_reads_effects_and_calibrated_figures() -> None:
    said = effect("gear_mesh", parameters={"amplitude": {"value": 2.9, "low": 2.5, "high": 3.2}})
    calibrated = {
        "inertia": {"value": 1700.0, "low": 1600.0, "high": 1700.0},
        "other": {"value": 1, "low": 0, "high": 2},
    }
    found = score.intervals(report(said, calibrated=calibrated), truth("single", "gear_mesh"))
    assert {(i["name"], i["inside"]) for i in found} == {("inertia", False), ("gear_mesh.amplitude", True)}


@pytest.mark.parametrize(
    ("hits", "total", "low", "high"),
    [(0, 200, 0.0, 0.018275), (10, 200, 0.024235, 0.090029), (3, 3, 0.292402, 1.0)],
)
def test_clopper_pearson(hits: int, total: int, low: float, high: float) -> None:
    """0/n and n/n: closed form 1 - 0.025^(1/n), 0.025^(1/n); 10/200: the two binomial tails are 2.5 %."""
    from scipy.stats import binom

    got = table.exact_interval(hits, total)
    if hits == 0:
        assert got[1] == pytest.approx(1 - 0.025 ** (1 / total))
    elif hits == total:
        assert got[0] == pytest.approx(0.025 ** (1 / total))
    else:
        assert binom.sf(hits - 1, total, got[0]) == pytest.approx(0.025, abs=1e-9)
        assert binom.cdf(hits, total, got[1]) == pytest.approx(0.025, abs=1e-9)
    assert got == pytest.approx((low, high), abs=2e-4)


def test_a_sure_wrong_name_is_counted_and_an_absent_probability_is_not() -> None:
    sure = effect("gear_mesh", probability=0.95)
    wrong = score.score(ANSWER, report(sure), truth("single", "motor_cogging"))
    right = score.score(ANSWER, report(sure), truth("single", "gear_mesh"))
    unsure = score.score(
        ANSWER, report(effect("gear_mesh", probability=None)), truth("single", "wind_torque")
    )
    assert [r["sure_and_wrong"] for r in (wrong, right, unsure)] == [1, 0, 0]
    assert [r["sureness"] for r in (wrong, right, unsure)] == [[[0.95, 0.0]], [[0.95, 1.0]], []]
    lines = {line["figure"]: line["measured"] for line in table.figures([wrong, right, unsure])}
    assert lines["a wrong name with probability > 0.9, all cases"]["hits"] == 1
    assert "| 0.950 | 1 | 2 |" in table.reliability([wrong, right, unsure])


def test_a_reliability_diagram_has_a_point_for_every_probability_said(tmp_path: Path) -> None:
    rows = [{"sureness": [[0.9, 1.0], [0.5, 0.0]]}, {"sureness": [[0.9, 0.0]]}, {}]
    assert points(rows) == [(0.5, 0, 1), (0.9, 1, 2)]
    draw(points(rows), "made up", tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
