"""What a supply and magnets take of volts and torques."""

from typing import Any

import numpy as np
import pytest

from calibration.inputs.declaration import Response
from calibration.names import (
    magnet_weakening,
    supply_sag,
)  # fmt: skip
from calibration.names.scene import Scene
from tests.calibration.names.made import drive
from tests.calibration.names.test_electric_names import (
    CURRENT,
    DUTY,
    RATE,
    ROWS,
    K,
    T,
    V,
    effects,
    two,
    volts,
)


def test_a_supply_sags_by_what_is_drawn() -> None:
    (c,) = supply_sag.columns(volts())
    assert c.columns[:, 0] == pytest.approx(DUTY**2 * CURRENT) and c.sign == 1
    s = volts()
    s.windings = w = two()
    drawn, motors = supply_sag.columns(s)
    both = np.tile(np.sum(np.split(w.duty * w.current, 2), axis=0), 2)
    assert drawn.columns[:, 0] == pytest.approx(w.duty * both) and drawn.fixed == {}
    both = np.tile(np.sum(np.split(w.current, 2), axis=0), 2)
    assert motors.columns[:, 0] == pytest.approx(w.duty * both)
    assert motors.fixed["of_the_sum"][0] == 1.0
    logged = volts()
    logged.view.columns["supply"] = np.full(ROWS, V)
    assert supply_sag.columns(logged) == [] == supply_sag.columns(volts(duty=np.zeros(0)))


def effort(supply: np.ndarray | None, channel: str = "effort", **more: Any) -> Scene:
    columns = {} if supply is None else {"supply": supply}
    return drive(
        np.sin(T), response=Response(channel, "V", **more), columns=columns, y=3 + CURRENT, residual=CURRENT
    )


def test_an_effort_follows_a_supply_that_changes() -> None:
    supply = V * (1 + 0.05 * np.sin(T))
    (c,) = supply_sag.columns(effort(supply))
    assert c.columns[:, 0] == pytest.approx(-3.0 * (supply / supply.mean() - 1)) and c.most == 3.0
    assert (c.sign, c.labels) == (1, (("share", "1"),))
    changes = "a supply that changes by more than a percent"
    assert supply_sag.lacks(effort(V * (1 + 0.0139 * np.sin(2 * np.pi * T / 5)))) == changes
    assert supply_sag.lacks(effort(V * (1 + 0.0143 * np.sin(2 * np.pi * T / 5)))) == ""
    assert supply_sag.lacks(effort(None)) == "a column of the supply"
    over = "an effort that is not over the supply already"
    assert (
        supply_sag.lacks(effort(supply, "force"))
        == supply_sag.lacks(effort(supply, divide_by="supply"))
        == over
    )
    assert supply_sag.lacks(volts()) == ""


def test_magnets_keep_what_they_have_not_lost() -> None:
    found = magnet_weakening.columns(volts())
    assert {c.labels for c in found} == {(("loss", "1"),)} and all(
        c.sign == 1 and c.most == 1.0 for c in found
    )
    last = next(c for c in found if c.fixed["start"][0] < -c.fixed["duration"][0])
    assert last.columns[:, 0] == pytest.approx(-K * RATE)
    assert len(found) == 48 and {round(c.fixed["duration"][0] / T[-1], 3) for c in found} == {0.05, 0.4}
    half = magnet_weakening.torque_kept(last, 0.2, T, 1.5)
    assert half == pytest.approx(np.full(ROWS, 0.7))
    late = next(c for c in found if 5 < c.fixed["start"][0] < 6)
    kept = magnet_weakening.torque_kept(late, 0.2, T, 1.0)
    assert kept[0] == 1.0 and kept[-1] == pytest.approx(0.8)
    made = effects(magnet_weakening.NAME, "velocity", loss=0.1, start=30.4)
    assert made.remarks == [
        "magnet_weakening: the plant's magnets do not know the time, the loss found from 30 s on is there "
        "from the start"
    ]
    assert (
        made.effects[0].parameters["loss"].value == 0.1 and made.effects[0].parameters["motor"].value == 0.0
    )
