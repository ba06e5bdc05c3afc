"""A draft's clock, its channels by their names, and what it tells in words."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from calibration.inputs.draft import _by_name, _clock, _Draft, draft
from calibration.inputs.loose import Loose

ROWS = 300
K: Any = np.arange(ROWS)
WAVE = np.sin(2 * np.pi * K / 100)


def named(**columns: Any) -> _Draft:
    left: dict[str | int, Any] = {str(c): x for c, x in columns.items()}
    d = _Draft(left)
    _by_name(d)
    return d


def clocked(stamp: Any = None, **columns: Any) -> _Draft:
    left: dict[str | int, Any] = {str(c): x for c, x in columns.items()}
    d = _Draft({**left})
    _clock(d, Loose(left, stamp))
    return d


@pytest.mark.parametrize(
    ("name", "stamps", "scale", "period_s"),
    [
        ("t", 0.01 * K, 1.0, 0.01),
        ("t_s", 2.0 * K, 1.0, 2.0),
        ("t", 2.0 * K, 1e-3, 2e-3),  # whole steps of one and more: ms
        ("t", 1.0 * K, 1e-3, 1e-3),
        ("t", 2.5 * K, 1.0, 2.5),
        ("t_ms", 2.0 * K, 1e-3, 2e-3),
        ("t_us", 2000.0 * K, 1e-6, 2e-3),
        ("t", 1.7e9 + K * 1.5, 1.0, 1.5),  # s since 1970 have ten digits
        ("t", 3.1e11 + K * 1.5, 1.0, 1.5),
        ("t", 3.3e11 + K * 1.5, 1e-3, 1.5e-3),
        ("t", 1.7e12 + K * 10.0, 1e-3, 1e-2),
        ("t", 1.7e15 + K * 1e4, 1e-6, 1e-2),
        ("t", 1.7e18 + K * 1e7, 1e-9, 1e-2),
        ("t", 0.25 * K**1.0, 1.0, 0.25),
        ("anything", 0.01 * K, 1.0, 0.01),
        ("b", 0.5 * K, 1.0, 0.5),
    ],
)
def test_a_clock_is_in_s_by_its_unit_its_size_or_its_steps(
    name: str, stamps: np.ndarray, scale: float, period_s: float
) -> None:
    d = clocked(x=WAVE, **{name: stamps})
    role = d.roles["time"]
    assert (role.column, role.unit) == (name, "s") and role.scale == pytest.approx(scale)
    assert d.period_s == pytest.approx(period_s)
    said = "_" in name
    assert role.why == ("" if said or scale == 1 else "its unit, by the size of its steps")
    assert d.fields == ({"wall_time": ({"from": "time"}, "")} if stamps[0] * scale > 1e9 else {})


def test_the_period_is_of_steps_that_are_no_gaps() -> None:
    steps = np.full(ROWS, 1.0)
    steps[[50, 60]] = 2.4, 2.6  # the last one is more than 2.5 of them
    d = clocked(t_s=np.cumsum(steps))
    assert d.period_s == pytest.approx((297 + 2.4) / 298)
    assert np.diff(d.roles["time"].x)[49] == pytest.approx(2.4)


def test_one_stamp_in_a_hundred_may_go_back_and_no_more() -> None:
    for stray, found in ((2, True), (3, False)):
        t = 0.01 * np.arange(201.0)
        t[50 : 50 + 10 * stray : 10] += 0.015
        assert ("time" in clocked(t=t, x=np.sin(np.arange(201.0))).roles) is found, stray
    d = clocked(x=WAVE)
    assert d.fields == {"sample_period_s": (1.0, "the log has no time; give the s between two rows")}
    assert d.roles == {} and d.period_s == 1.0


def test_a_nameless_clock_is_even_and_a_named_column_is_none() -> None:
    steps = np.where(K % 10 < 8, 1.0, 3.1)
    assert "time" not in clocked(a=np.cumsum(steps), x=WAVE).roles
    assert "time" in clocked(a=np.cumsum(np.minimum(steps, 2.9)), x=WAVE).roles
    assert "time" not in clocked(position=0.01 * K, x=WAVE).roles
    both = clocked(a=0.01 * K, time_s=0.02 * K)
    assert both.roles["time"].column == "time_s"
    columns: dict[str | int, Any] = {"t": np.where(K == 5, np.nan, 0.01 * K), "x": WAVE}
    holes = Loose(columns)
    d = _Draft({"t": 0.01 * K, "x": WAVE})
    _clock(d, holes)
    assert "time" not in d.roles


def test_a_stamp_in_words_is_the_time_of_the_day() -> None:
    d = clocked("when", when=100.0 + 0.5 * K, x=WAVE)
    assert d.roles["time"].more == {"format": "iso"} and d.roles["time"].scale == 1.0
    assert d.fields["wall_time"] == ({"from": "time"}, "")
    whole = clocked("when", when=1.0 * K, x=WAVE)
    assert whole.roles["time"].scale == 1.0 and whole.period_s == 1.0


def test_what_is_asked_for_and_where_is_a_reference() -> None:
    d = named(pos=WAVE, pos_cmd=WAVE, ref=2 * WAVE)
    assert {c: r.column for c, r in d.roles.items()} == {"position": "pos", "reference": "pos_cmd"}
    assert set(d.left) == {"ref"} and d.unsaid == []


def test_a_force_that_is_asked_for_stands_for_one_that_is_measured() -> None:
    why = "asked for, but no other column is a force"
    alone = named(torque_cmd_mNm=WAVE, pos=WAVE)
    assert (alone.roles["effort"].unit, alone.roles["effort"].why) == ("mN m", why)
    both = named(torque_cmd=WAVE, current_mA=WAVE)
    assert set(both.roles) == {"current"} and both.roles["current"].scale == 1e-3
    assert both.unsaid == ["'torque_cmd': asked for, not measured; it is left out"] and both.left == {}
    assert named(velocity_cmd=WAVE).unsaid == ["'velocity_cmd': asked for, not measured; it is left out"]


@pytest.mark.parametrize(("scatter", "channel"), [(0.19, "supply"), (0.21, "effort")])
def test_a_voltage_that_scatters_is_no_supply(scatter: float, channel: str) -> None:
    for way in (24.0, -24.0):
        found = named(volts=way * (1 + scatter * WAVE / WAVE.std()))
        assert set(found.roles) == {channel}


def test_a_label_of_whole_numbers_parts_the_runs() -> None:
    d = named(run=1.0 * (K // 100), trial=1.0 * (K // 50), pos=WAVE)
    assert d.fields == {"runs": ({"column": "run"}, "")}
    assert d.unsaid == ["'trial': label; it is left out"] and set(d.left) == set()
    assert named(run=WAVE).unsaid == ["'run': label; it is left out"]
    assert named(frame=1.0 * K).unsaid == ["'frame': count; it is left out"]
    d = named(t=0.01 * K, temp=WAVE, speed_rpm=WAVE)
    assert d.unsaid == ["'t': time; it is left out"]
    assert d.roles["velocity"].scale == pytest.approx(1 / 60) and d.roles["temperature"].unit == ""


def text(folder: Path, **columns: Any) -> str:
    path = folder / "my log.csv"
    cells = zip(*columns.values(), strict=True)
    path.write_text("\n".join([",".join(columns), *(",".join(map(str, row)) for row in cells)]) + "\n")
    return draft(path)


def test_a_draft_says_what_it_was_made_of_and_what_it_could_not_say(tmp_path: Path) -> None:
    few = [str(k) if k < 5 else "" for k in K]
    six = [str(k * k) if k < 6 else "" for k in K]
    words = ["on" if k % 7 else "off" for k in K]
    found = text(
        tmp_path, t_s=0.02 * K, pos_rad=WAVE, u=np.sign(np.cos(K / 16)), still=np.ones(ROWS),
        five=few, six=six,
        mode=words,
    )  # fmt: skip
    lines = found.splitlines()
    assert lines[0] == "# Drafted from 'my log.csv': 300 rows at 50 Hz. Check what is 'guessed'."
    assert [line for line in lines if line.startswith("# could not say: ")] == [
        f"# could not say: {what}"
        for what in (
            "'still' holds one number, or none",
            "'five' holds one number, or none",
            "'mode' holds words",
            "the gear table (stages)",
            "'six': a channel for it; it is left out",
        )
    ]
    assert lines[6:8] == ["rig: my log", "columns:"] and found.endswith("\n") and not found.endswith("\n\n")
    said = yaml.safe_load(found)
    assert said["columns"] == {
        "time": {"column": "t_s", "unit": "s"},
        "position": {"column": "pos_rad", "unit": "rad"},
        "effort": {"column": "u", "unit": "units"},
    }
    assert said["response"] == {"channel": "effort", "unit": "units"}
    assert said["estimate"] == ["inertia", "viscous", "coulomb", "offset"]
    assert set(said) == {"rig", "columns", "response", "estimate"} and "guessed: " not in found


def test_numbers_as_large_as_the_largest_are_numbers(tmp_path: Path) -> None:
    found = text(
        tmp_path, t_s=0.02 * K, pos=WAVE, u=np.where(K % 2, 1e60, -1e60), v=np.where(K % 2, 2e60, 1.0)
    )
    assert "column: u," in found and "'v' holds one number, or none" in found
