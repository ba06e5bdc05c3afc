"""The header of an axis log: keys, scales with their limits, and what is said of a wrong one."""

from math import inf
from pathlib import Path

import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.header import parse_header

PATH = Path("a.log")
HEAD = [
    "# format: axis-log 1", "# axis: ra", "# sample_period_s: 0.02", "# session: a", "# loop: closed",
    "# start_utc: 2026-01-15T14:00:00Z", "# a remark", "# note: with: a colon",
]  # fmt: skip


def scales(*more: str) -> dict[str, float]:
    return parse_header(PATH, [*HEAD, *more])[1]


def refused(*lines: str) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        parse_header(PATH, [*lines])
    return str(caught.value)


def test_declared_scales_stand_where_the_header_says_none() -> None:
    """paper.txt 3.2 to 3.4; log-format.md."""
    header, found, end = parse_header(PATH, [*HEAD, "t,effort", "# axis: dec"])
    assert end == 8 and header["note"] == "with: a colon" and header["axis"] == "ra"
    assert found == pytest.approx({
        "sample_period_s": 0.02, "velocity_window_s": 0.005, "tach_window_s": 0.010,
        "position_arcsec_per_count": 1_296_000 / 2**29,
        "velocity_arcsec_per_count": 1_296_000 / (4_608_000 * 24.5), "adc_A_per_count": 0.0061,
        "tach_counts_per_turn": 4096.0, "aux_arcsec_per_count": 1_296_000 / (131_072 * 10.8),
        "effort_full_scale": 3000.0, "supply_V": 24.0, "counter_torque": 0.1,
        "gear_ratio": found["gear_ratio"],
    })  # fmt: skip
    assert parse_header(PATH, HEAD)[2] == 8
    del_period = [line for line in HEAD if "sample" not in line]
    assert refused(*del_period).startswith("a.log:1: the header lacks 'sample_period_s'")


def test_a_header_overrides_a_scale_within_its_limits() -> None:
    assert scales("# supply_V: 36")["supply_V"] == 36.0
    assert scales("# counter_torque: 0")["counter_torque"] == 0.0
    assert scales("# counter_torque: 1")["counter_torque"] == 1.0
    assert scales("# gear_ratio: 1e12")["gear_ratio"] == 1e12
    assert "train_stiffness_Nm_per_rad" not in scales("# train_stiffness_Nm_per_rad: 5")


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("# supply_V: 0", "a.log:9: 'supply_V' is 0.0, must be positive (V; paper 3.2)"),
        ("# supply_V: -1", "a.log:9: 'supply_V' is -1.0, must be positive (V; paper 3.2)"),
        ("# supply_V: inf", f"a.log:9: 'supply_V' is {inf}, must be positive (V; paper 3.2)"),
        ("# supply_V: 1.1e12", "a.log:9: 'supply_V' is 1100000000000.0, must be positive (V; paper 3.2)"),
        ("# supply_V:", "a.log:9: 'supply_V' is nan, must be positive (V; paper 3.2)"),
        ("# supply_V: 24 V", "a.log:9: 'supply_V' is '24 V', must be a plain number (V; paper 3.2)"),
        (
            "# train_stiffness_Nm_per_rad: 0",
            "a.log:9: 'train_stiffness_Nm_per_rad' is 0.0, must be positive (N m/rad at the "
            "axis of one motor's "
            "gear train)",
        ),
        (
            "# counter_torque: -0.1",
            "a.log:9: 'counter_torque' is -0.1, must be 0 to 1 (fraction of the effort on the other motor; "
            "paper 3.3 says 0.10 to 0.25)",
        ),
        ("# axis: dec", "a.log:9: 'axis' is given twice ('ra', 'dec'): one file holds one axis"),
        (
            "# format: axis-log 2",
            "a.log:9: 'format' is given twice ('axis-log 1', 'axis-log 2'): one file holds one axis",
        ),
        ("# loop: shut", "a.log:9: 'loop' is 'shut', must be closed or open"),
        ("# preload: medium", "a.log:9: 'preload' is 'medium', must be low or high"),
    ],
)
def test_a_wrong_line_is_named(line: str, says: str) -> None:
    assert refused(*HEAD, line) == says


def test_what_may_stand_twice_is_the_last_one() -> None:
    header, _, _ = parse_header(PATH, [*HEAD, "# axis: ra", "# session: b", "# preload: high"])
    assert (header["session"], header["preload"]) == ("b", "high")


def test_a_key_that_is_missing_is_asked_for_or_its_nearest_is_named() -> None:
    named = [line.replace("session", "sesion") for line in HEAD]
    assert refused(*named) == "a.log:1: the header lacks 'session'; did you mean 'sesion' (line 4)?"
    gone = [line for line in HEAD if "loop" not in line]
    assert refused(*gone) == "a.log:1: the header lacks 'loop'; add '# loop: ...'"
    wrong = [HEAD[0].replace("1", "2"), *HEAD[1:]]
    assert refused(*wrong) == "a.log:1: 'format' is 'axis-log 2', must be axis-log 1"
