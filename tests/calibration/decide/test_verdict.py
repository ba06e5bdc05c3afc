"""The verdict's words, the kind of an answer, and an effect as the report has it."""

from dataclasses import replace

import pytest

from calibration.decide.thresholds import STILL_MISSING, Earned
from calibration.decide.verdict import (
    PHASES,
    PLACES,
    UNNAMED,
    conventions,
    effect_as_dict,
    judge,
    kind_of,
    probability,
)
from calibration.finding import UNKNOWN, Curve, Finding, Parameter, of_columns

LATE = of_columns("channel_delay", {}, 9.0, share=0.0)
DRAG = Finding("brake_drag", "T", "time")


def test_a_fault_of_a_column_is_found_but_what_the_log_lacks_is_said_first() -> None:
    assert judge([LATE]) == ("found", None)
    assert judge([LATE], ["two speeds"]) == ("cannot tell", "two speeds")
    assert judge([DRAG], ["two speeds"]) == ("found", None)
    assert judge([LATE, replace(DRAG, name=UNKNOWN)]) == (UNKNOWN, UNNAMED)


def test_the_first_effect_decides_between_found_and_ambiguous_and_any_has_experiments() -> None:
    tied = Finding("load_friction", "T", "load", equivalent=["brake_drag", UNKNOWN, "of nobody"])
    found, told = judge([DRAG, tied])
    assert found == "found" and [x.split(":")[0] for x in (told or "").split("; ") if ": " in x] == [
        "load_friction",
        "brake_drag",
        "unknown",
    ]
    assert judge([tied, DRAG])[0] == "ambiguous"


@pytest.mark.parametrize(
    ("channel", "row", "kind"),
    [
        ("T", {"torque": {"floor": 2.0, "after": 2 * STILL_MISSING}}, "sole"),
        ("K", {"position": {"floor": 1.0, "after": 1.0}}, "sole"),
        ("E", {"electrical": {"floor": 1.0, "after": 1.0}}, "sole"),
        ("S", {"velocity": {"floor": 1.0, "after": 1.0}}, "sole"),
        ("T", {"position": {"floor": 1.0, "after": 1.0}}, None),
        ("another", {"torque": {"floor": 1.0, "after": 1.0}}, None),
        ("T", {"torque": {"floor": 0.0, "after": 1.0}}, None),
    ],
)
def test_an_effect_is_judged_by_the_error_of_its_own_channel(
    channel: str, row: dict[str, dict[str, float]], kind: str | None
) -> None:
    f = Finding("brake_drag", channel, "time")
    assert kind_of(f, 0, row) == kind
    assert probability(f, 0, row, {"further": Earned(1, 1)}) is None


def test_an_effect_as_the_report_has_it() -> None:
    error = {"torque": {"floor": 1.0, "after": 1.0}}
    f = Finding(
        "gear_mesh", "T", "axis_angle", stage="mesh1", harmonic=2, order=7.5, frequency=0.25,
        equivalent=["bearing_pass"], parameters={"amplitude": Parameter(2.0, "N m", 1.0, 3.0)},
        evidence=12.5, note="a note",
    )  # fmt: skip
    assert effect_as_dict(f, 0, error, {"ambiguous": Earned(2, 2)}) == {
        "name": "gear_mesh",
        "equivalent": ["bearing_pass"],
        "stage": "mesh1",
        "harmonic": 2,
        "channel": "T",
        "probability": 0.75,  # Laplace: 3 of 4
        "parameters": {"amplitude": {"value": 2.0, "unit": "N m", "low": 1.0, "high": 3.0}},
        "domain": "axis_angle",
        "order": 7.5,
        "frequency_Hz": 0.25,
        "evidence": 12.5,
        "note": "a note",
    }
    curve = Curve("time", "N m", (0.0,), (1.0,), (0.5,))
    told = effect_as_dict(replace(f, curve=curve), 0, error, None)
    assert told["probability"] is None
    assert told["curve"] == {"domain": "time", "unit": "N m", "x": (0.0,), "y": (1.0,), "half": (0.5,)}


def test_phases_are_defined_where_there_are_any() -> None:
    def phased(unit: str) -> Finding:
        return DRAG.having(phase=Parameter(0.1, unit))

    assert conventions([DRAG]) == []
    assert conventions([DRAG, phased("rad")]) == [PHASES]
    assert conventions([phased("turn")]) == [PLACES]
    assert conventions([phased("turn"), phased("rad")]) == [PHASES, PLACES]
