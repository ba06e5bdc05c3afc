"""Late columns of an axis by coefficients of rates that are given, on channels that are made up."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.decide.delays import REACH, TERM, delay_findings
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.thresholds import (
    BUS_WAIT_S,
    FEWEST_BLOCKS,
    LATE_CURRENT_S,
    SLACK_S,
    SMALLEST_LAG_S,
    SOUND_LAG_S,
    SOUND_VOLTS_LAG_S,
    SURE_LAG_S,
    SURE_VOLTS_LAG_S,
    TICK_S,
    WINDOW_DELAY_S,
)
from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import Declared
from tests.calibration.decide.made import problem, term

ROWS = 2400
RNG = np.random.default_rng(41)
RATE, OTHER, LUCK = RNG.standard_normal((3, ROWS))
MIDDLE_S = (0.003 + 0.0105) / 2


def lag(
    key: str, value: float, reach: float = 1e-5, share: float = 0.5, scale: float = 1.0, blocks: int = 90
) -> Selection:
    """A channel whose term of the lag is `value` s, and takes `share` of the mean square."""
    rows = np.arange(ROWS) < 20 * blocks
    rate, other = (x - x[rows].mean() for x in (RATE, OTHER))
    luck = LUCK - np.where(rows, rate, 0.0) * (LUCK @ (rate * rows)) / (rate @ (rate * rows))
    y = np.sqrt(share / (1 - share)) * rate / np.std(rate) + luck
    p = problem(scale * y, np.column_stack([other, rate]), held=99)
    p.valid = rows
    p.base_labels = [("other", "s"), (TERM[key], "s")]
    s = Selection.of(p)
    assert s.problem.blocks == blocks
    s.after = replace(s.after, beta=np.array([9.0, value]), covariance=np.diag([9.0, (reach / REACH) ** 2]))
    return s


def late(own: bool = False, gear_lag_s: float = 0.0, **channels: Selection) -> list[Finding]:
    declared = cast(Declared, cast(Any, SimpleNamespace(own=own, gear_lag_s=gear_lag_s)))
    return delay_findings(channels, declared)


def column(found: list[Finding]) -> tuple[str, float]:
    """Which one is late, and by how much."""
    (f,) = found
    assert f.name == "channel_delay" and f.note.endswith(" column is late")
    return f.note.removeprefix("the ").removesuffix(" column is late"), f.parameters["delay"].value


def test_a_log_without_channels_has_no_late_column() -> None:
    assert late() == []


def test_a_finding_has_the_delay_its_interval_and_the_column() -> None:
    (found,) = late(K=lag("K", -0.001, reach=1e-4))
    assert found.parameters["column"] == Parameter(4.0, "1")
    delay = found.parameters["delay"]
    assert (delay.value, delay.low, delay.high) == pytest.approx((0.001, 0.0009, 0.0011))
    assert delay.unit == "s"


@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_encoders_are_late_beyond_latency_and_a_wait_for_the_own_boards_bus(own: bool, sign: float) -> None:
    least = SMALLEST_LAG_S + (BUS_WAIT_S if own else 0.0)
    assert late(own, K=lag("K", sign * least)) == []
    assert column(late(own, K=lag("K", sign * 1.01 * least))) == ("tachometers", -sign * 1.01 * least)


def test_the_velocity_is_late_against_the_middle_of_its_window() -> None:
    """It counts over the last 5 ms: half of it is no fault."""
    assert late(S=lag("S", -WINDOW_DELAY_S)) == []
    name, delay = column(late(S=lag("S", -WINDOW_DELAY_S - 0.001)))
    assert name == "velocity" and delay == pytest.approx(0.001)
    assert column(late(S=lag("S", 0.0)))[1] == pytest.approx(-0.0025)


@pytest.mark.parametrize("key", ["K", "S"])
def test_a_lag_of_encoders_must_be_sure_and_matter(key: str) -> None:
    sound = -WINDOW_DELAY_S if key == "S" else 0.0

    def seen(delay: float = 0.001, **more: Any) -> bool:
        one: dict[str, Any] = {key: lag(key, sound - delay, **more)}
        return bool(late(**one))

    # 2.5 times the reach of a 95 % interval, five standard errors
    assert seen(2.6 * 2e-4, reach=2e-4) and not seen(2.4 * 2e-4, reach=2e-4)
    assert seen(reach=0.99 * SURE_LAG_S) and not seen(reach=1.01 * SURE_LAG_S)
    assert seen(share=0.08) and not seen(share=0.02)
    assert seen(share=0.08, scale=1e-3) and not seen(share=0.02, scale=1e-3)
    assert seen(blocks=FEWEST_BLOCKS) and not seen(blocks=FEWEST_BLOCKS - 1)


@pytest.mark.parametrize("times", [0.6, 0.75, 1.0, 1.25, 1.4, -1.0])
@pytest.mark.parametrize("delay", [0.001, -0.001])
def test_two_encoders_late_alike_say_that_the_position_is_early(times: float, delay: float) -> None:
    """Alike: but for three tenths of the tachometers' own."""
    name = "position" if 0.7 < times < 1.3 else "tachometers"
    both: dict[str, Any] = {"K": lag("K", -delay), "S": lag("S", -WINDOW_DELAY_S - times * delay, reach=2e-5)}
    (found,) = late(**both)
    said, told = column([found])
    assert said == name and told == pytest.approx(-delay if name == "position" else delay)
    assert found.parameters["column"].value == (1.0 if name == "position" else 4.0)
    assert found.parameters["delay"].half == pytest.approx(1e-5)


def test_of_two_encoders_the_one_that_is_sound_is_not_called_late() -> None:
    assert column(late(K=lag("K", 0.0), S=lag("S", -0.0035)))[0] == "velocity"
    assert column(late(K=lag("K", -0.001), S=lag("S", -WINDOW_DELAY_S)))[0] == "tachometers"
    assert column(late(K=lag("K", -0.001), S=lag("S", -0.0035, share=0.02)))[0] == "tachometers"


def currents(delay: float = 0.005, volts: float | None = None, **more: Any) -> dict[str, Any]:
    """Currents that are late by `delay`; sound volts lag by SOUND_LAG_S, these by as much more."""
    seen = SOUND_LAG_S + delay if volts is None else volts
    return {"T": lag("T", -delay, **more), "E": lag("E", seen)}


def test_currents_are_late_where_torque_and_volts_say_so() -> None:
    (found,) = late(**currents(reach=1e-4))
    assert column([found]) == ("current", 0.005)
    assert found.parameters["column"].value == 3.0 and found.parameters["delay"].half == pytest.approx(1e-4)
    assert late(T=currents()["T"]) == []
    assert column(late(E=lag("E", 0.02)))[0] == "current or effort"


def test_a_trains_lag_is_not_the_currents() -> None:
    assert column(late(gear_lag_s=0.001, **currents()))[1] == pytest.approx(0.004)
    assert late(gear_lag_s=0.004, **currents()) == []


@pytest.mark.parametrize(
    ("delay", "more", "seen"),
    [
        (LATE_CURRENT_S, {}, False),
        (1.01 * LATE_CURRENT_S, {}, True),
        (0.005, {"reach": 0.0016}, True),
        (0.005, {"reach": 0.0018}, False),  # three reaches of it
        (0.005, {"share": 0.08}, True),
        (0.005, {"share": 0.02}, False),
    ],
)
def test_a_lag_of_currents_must_be_sure_and_matter(delay: float, more: dict[str, Any], seen: bool) -> None:
    found = late(**currents(delay, **more))
    assert bool(found) is seen
    assert not found or column(found)[0] == "current"


@pytest.mark.parametrize(
    ("volts", "seen"),
    [
        (SOUND_LAG_S + 0.5 * 0.005, False),  # late against the motion, hardly against the effort
        (SOUND_LAG_S + 0.7 * 0.005, True),
        (MIDDLE_S + 0.005 / 0.65, True),
        (MIDDLE_S + 0.005 / 0.55, False),  # late against the effort, hardly against the motion
    ],
)
def test_currents_are_late_against_the_effort_as_against_the_motion(volts: float, seen: bool) -> None:
    found = late(**currents(0.005, volts))
    assert [column(found)[0] == "current" if found else False] == [seen]


@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize(("end", "way"), [(SOUND_VOLTS_LAG_S[0], -1.0), (SOUND_VOLTS_LAG_S[1], 1.0)])
def test_volts_alone_are_late_beyond_sound_ones_and_an_own_boards_tick(
    own: bool, end: float, way: float
) -> None:
    last = end + way * (SLACK_S + (TICK_S if own else 0.0))
    assert late(own, E=lag("E", last)) == []
    name, delay = column(late(own, E=lag("E", last + way * 1e-5)))
    assert name == "current or effort"
    assert delay == pytest.approx(abs(last + way * 1e-5 - MIDDLE_S))
    (found,) = late(own, E=lag("E", last + way * 1e-5))
    assert "column" not in found.parameters


def test_volts_that_are_late_must_be_sure_and_matter_without_any_effect() -> None:
    def seen(**more: Any) -> bool:
        return bool(late(E=lag("E", 0.02, **more)))

    assert seen(reach=0.99 * SURE_VOLTS_LAG_S) and not seen(reach=1.01 * SURE_VOLTS_LAG_S)
    assert seen(share=0.08) and not seen(share=0.02)
    s = lag("E", 0.02)
    one = fit_with(s.problem, s.problem.base, term("supply_sag", LUCK[:, None]))
    assert one is not None
    s.chosen = [one]
    assert late(E=s) == []


def test_encoders_tell_most_and_volts_least() -> None:
    some = currents()
    assert column(late(K=lag("K", -0.001), **some))[0] == "tachometers"
    assert column(late(K=lag("K", 0.0), **some))[0] == "current"
    assert column(late(T=lag("T", 0.0), E=lag("E", 0.02)))[0] == "current or effort"
