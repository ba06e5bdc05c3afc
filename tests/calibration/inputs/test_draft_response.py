"""A response that a draft explains: a force, a speed or a free motion, and terms that the motion tells."""

import numpy as np
import pytest

from calibration.inputs.draft import (
    _Draft,
    _response,
    _Role,
)
from tests.calibration.inputs.test_draft_motion import K, drafted


def explained(rate: np.ndarray, *roles: _Role, **named: _Role) -> _Draft:
    d = drafted()
    d.roles = {"position": _Role("p", "deg", np.cumsum(rate))} | named
    _response(d)
    return d


FREE = np.concatenate([np.ones(600), -np.ones(400)])


@pytest.mark.parametrize(
    ("rate", "terms"),
    [
        (FREE, ["inertia", "viscous", "coulomb", "offset"]),
        (np.where(np.arange(1000) < 940, 1.0, -1.0), ["inertia", "viscous", "coulomb", "offset"]),
        (np.where(np.arange(1000) < 960, 1.0, -1.0), ["inertia", "viscous", "offset"]),
        (1.0 + 0.31 * np.sin(np.arange(1000) / 50), ["inertia", "viscous", "offset"]),
        (1.0 + 0.25 * np.sin(np.arange(1000) / 50), ["offset"]),
    ],
)
def test_terms_are_those_that_the_motion_tells_apart(rate: np.ndarray, terms: list[str]) -> None:
    d = explained(rate, effort=_Role("u", "A", rate))
    assert d.fields["response"] == ({"channel": "effort", "unit": "A"}, "")
    assert d.fields["estimate"] == (terms, "")


def test_the_first_force_is_explained_by_the_normal_one_where_both_have_a_unit() -> None:
    roles = {"effort": _Role("u", "", FREE), "force": _Role("f", "N", FREE), "normal": _Role("n", "N", FREE)}
    d = explained(FREE, **roles)
    assert d.fields["response"][0] == {"channel": "force", "unit": "1", "divide_by": "normal"}
    assert d.unsaid == ["'u' is not explained: force is"] and set(d.roles) == {"position", "force", "normal"}
    roles["normal"] = _Role("n", "kN", FREE)
    d = explained(FREE, **roles)
    assert d.fields["response"][0] == {"channel": "force", "unit": "N"} and "normal" not in d.roles
    assert explained(FREE, effort=_Role("u", "", FREE)).fields["response"][0]["unit"] == "units"


def test_a_column_that_moves_as_the_position_does_is_looked_for_without_a_force() -> None:
    d = drafted(goal=np.roll(np.cumsum(FREE), -4))
    d.roles = {"position": _Role("p", "deg", np.cumsum(FREE))}
    _response(d)
    assert d.fields["response"][0] == {"channel": "position2", "unit": "deg"}
    assert (d.roles["position"].column, d.roles["position2"].column) == ("goal", "p")


ONE_WAY = np.full(1000, 1.0)


@pytest.mark.parametrize(
    ("rate", "named", "response", "terms"),
    [
        (ONE_WAY, {"velocity": _Role("v", "deg/s", ONE_WAY)}, ("velocity", "deg/s"), ["offset"]),
        (
            FREE,
            {"velocity": _Role("v", "deg/s", FREE)},
            ("acceleration", "deg/s2"),
            ["viscous", "coulomb", "offset"],
        ),
        (FREE, {}, ("acceleration", "deg/s2"), ["viscous", "coulomb", "offset"]),
        (ONE_WAY, {}, ("position", "deg"), None),
        (FREE, {"reference": _Role("r", "", FREE)}, ("position2", "deg"), None),
    ],
)
def test_without_a_force_a_speed_or_a_free_motion_is_explained(
    rate: np.ndarray, named: dict[str, _Role], response: tuple[str, str], terms: list[str] | None
) -> None:
    d = explained(rate, **named)
    told, why = d.fields["response"]
    assert (told["channel"], told["unit"]) == response
    assert why == ("" if response[0] == "position2" else "the log shows no force")
    assert d.fields.get("estimate") == (None if terms is None else (terms, ""))


def test_a_position_at_constant_rate_has_no_stages_and_an_integral_explains_the_speed() -> None:
    d = drafted()
    d.roles, d.fields["stages"] = {"position": _Role("p", "deg", K * 1.0)}, ([], "")
    _response(d)
    assert "stages" not in d.fields
    d = drafted()
    d.roles = {
        "position": _Role("v", "deg", np.cumsum(FREE), more={"integrated": True}),
        "velocity": _Role("v", "deg/s", FREE),
        "reference": _Role("r", "", FREE),
    }
    _response(d)
    assert d.fields["response"][0]["channel"] == "velocity" and d.roles["reference"].unit == "deg"
