"""The sentence that says the verdict, the worth of the first effect, and the page with both."""

from typing import Any

import pytest

from calibration.report.htmlpage import CHANNELS, page, parameters, size, summary

AMPLITUDE = {"value": 7.125, "unit": "N m", "low": 7.0, "high": 7.25}
SHARE = {"value": 0.25, "unit": "1", "low": None, "high": None}
PHASE = {"value": 0.5, "unit": "rad", "low": 0.4, "high": 0.6}


def effect(name: str = "gear_mesh", **more: Any) -> dict[str, Any]:
    plain: dict[str, Any] = {
        "name": name, "equivalent": [], "stage": None, "harmonic": None, "channel": "T",
        "domain": "axis_angle",
        "order": None, "frequency_Hz": None, "note": "", "parameters": {}, "probability": None,
    }  # fmt: skip
    return plain | more


def data(verdict: str, *effects: dict[str, Any], **more: Any) -> dict[str, Any]:
    plain: dict[str, Any] = {
        "verdict": verdict, "effects": list(effects), "error": {}, "reasons": [],
        "separating_experiment": None,
        "held_out": [], "calibrated": {}, "not_identifiable": [], "controls": [],
        "thresholds": {}, "refused": [],
        "conventions": [],
    }  # fmt: skip
    return plain | more


def test_nothing_is_said_of_a_log_that_shows_nothing() -> None:
    assert summary(data("nothing")) == "Nothing is missing from the declared model that this log could show."
    left = data("nothing", reasons=["something is still missing in torque: 5 floors"])
    assert summary(left) == (
        "No effect shows in this log, with a name or without, though more is left than sensors leave."
    )


def test_a_log_that_cannot_tell_lacks_something() -> None:
    lacks = data("cannot tell", separating_experiment="a second speed", reasons=["still missing"])
    assert summary(lacks) == ("This log cannot tell whether something is missing. It lacks: a second speed.")


def test_what_has_no_name_is_a_function_of_its_domain() -> None:
    top = effect("unknown", domain="axis_angle", channel="K")
    place = "position (difference of two encoders, or of the star and the drive)"
    begin = "Something real is left that the catalogue does not name: a function of"
    assert summary(data("unknown", top)) == f"{begin} axis angle in {place}."
    more = top | {"frequency_Hz": 0.03, "note": "over time", "channel": "X"}
    assert summary(data("unknown", more)) == f"{begin} axis angle with a period of 33.33 s in X; over time."


def test_what_cannot_be_told_apart_is_named_together() -> None:
    top = effect(equivalent=["play", "gear_mesh"], stage="mesh2", parameters={"amplitude": AMPLITUDE})
    assert summary(data("ambiguous", top, effect())) == (
        "gear_mesh on mesh2 (amplitude 7.12 N m), which this log cannot tell from play, another gear_mesh."
    )


@pytest.mark.parametrize(
    ("more", "count", "said"),
    [
        ({}, 1, "gear_mesh."),
        ({"frequency_Hz": 0.03}, 2, "gear_mesh (period 33.333 s), and 1 more."),
        ({"stage": "m", "parameters": {"share_of": SHARE}}, 3, "gear_mesh on m (share of 0.25), and 2 more."),
        (
            {"frequency_Hz": 4.0, "parameters": {"phase": PHASE, "amplitude": AMPLITUDE}},
            1,
            "gear_mesh (period 0.25 s, amplitude 7.12 N m).",
        ),
    ],
)
def test_the_declared_model_lacks_the_first_effect(more: dict[str, Any], count: int, said: str) -> None:
    assert (
        summary(data("found", effect(**more), *[effect()] * (count - 1)))
        == f"The declared model lacks {said}"
    )


def test_an_effects_size_is_its_amplitude_else_the_first_that_is_no_phase() -> None:
    both = {"phase_2": PHASE, "share_of": SHARE, "amplitude": AMPLITUDE}
    assert size(effect(parameters=both)) == [("amplitude", "N m", AMPLITUDE)]
    assert size(effect(parameters={"phase": PHASE, "share_of": SHARE, "b": PHASE})) == [
        ("share of", "", SHARE)
    ]
    assert size(effect(parameters={"phase": PHASE})) == size(effect()) == []
    shape = {"amplitude": AMPLITUDE, "knot_1": SHARE, "place": PHASE}
    assert size(effect("unknown", parameters=shape)) == [("place", "rad", PHASE)]
    assert size(effect("unknown", parameters={"knot_1": SHARE})) == []
    assert parameters(effect(parameters=shape)) == [("amplitude", AMPLITUDE), ("place", PHASE)]


TORQUE = {"unit": "N m", "before": 5.2512, "after": 1.5004, "floor": 1.254}


@pytest.mark.parametrize(
    ("given", "worth"),
    [
        (data("found", effect(), error={"torque": TORQUE}), "from 5.25 to 1.5 N m (floor 1.3)."),
        (
            data("found", effect(), error={"torque": TORQUE | {"floor": None}}),
            "from 5.25 to 1.5 N m (floor not known).",
        ),
        (data("found", effect(), error={"position": TORQUE}), ""),
        (data("found", effect(channel="?"), error={"torque": TORQUE}), ""),
        (data("nothing", error={"torque": TORQUE}), ""),
    ],
)
def test_a_page_tells_what_the_first_effect_takes_away(given: dict[str, Any], worth: str) -> None:
    text = page(given, [{"image": "data:x", "alt": "a <picture>"}], "A & B", "two runs")
    said = " On data nothing was fitted to, the error goes " + worth
    assert f"{summary(given)}{said if worth else ''}</p>" in text
    assert ("On data nothing" in text) is bool(worth)
    assert "<h1>A &amp; B</h1>" in text and '<img src="data:x" alt="a &lt;picture&gt;">' in text
    assert "two runs" in text and all(f"{key} {value}" in text for key, value in CHANNELS.items())
