"""A loss of magnets in the torque alone: volts of a motor that turns would show it."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from calibration.look.axis_result import AxisResult
from calibration.look.volts import volts_deny
from calibration.names.name import candidate


@pytest.mark.parametrize(
    ("name", "error", "size", "denied"),
    [
        ("magnet_weakening", 1e-4, 0.014, True),  # 140 standard errors that no volt shows
        ("magnet_weakening", 1e-3, 0.014, False),  # volts may not see it
        ("magnet_weakening", 0.0, 0.014, False),  # a log without volts
        ("adc_gain", 1e-4, 0.014, False),  # moves no back EMF
    ],
)
def test_volts_deny_a_change_of_the_torque_constant_that_they_would_show(
    name: str, error: float, size: float, denied: bool
) -> None:
    result = cast(
        AxisResult, SimpleNamespace(constant_error=error, frame=SimpleNamespace(one_clock=np.arange(3.0)))
    )
    assert volts_deny(result, candidate(name, np.ones((3, 1)), ("size", "1")), size) is denied
