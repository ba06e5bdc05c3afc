"""Drives that nobody tuned on: what they lack is named, or said to be in its domain; never something else."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, MASS, PERIOD, SENSORS, VISCOUS, found, mass, motion
from tests.calibration.test_drives import answer as answer_of

LONG = 60.0


def domains(data: dict[str, Any]) -> set[tuple[str, str]]:
    return {(e["name"], e["domain"]) for e in data["effects"]}


def answer(folder: Path, text: str, table: tuple[np.ndarray, ...]) -> dict[str, Any]:
    """The report on t, x, u, the position in steps of 1e-5 as an encoder has it."""
    t, x, u = table
    return answer_of(folder, text, (t, np.round(x, 5), u))


def rate(x: np.ndarray) -> np.ndarray:
    return np.asarray(np.gradient(x, PERIOD))


@pytest.mark.slow
def test_two_lines_of_no_stage_are_both_found_and_are_no_delay(tmp_path: Path) -> None:
    """A motor's slots, and a third of them, in a file without a gear table."""
    t, x, u = motion(LONG)
    u = u + 1.2 * np.sin(2 * np.pi * x / 0.05 + 0.5) + 0.5 * np.sin(2 * np.pi * x / 0.11 + 1.0)
    data = answer(tmp_path, FORCE, (t, x, u))
    assert "channel_delay" not in found(data)
    sizes = {round(1 / e["order"], 3): e["parameters"]["amplitude"]["value"] for e in data["effects"]}
    assert sizes[0.05] == pytest.approx(1.2, rel=0.05)
    assert sizes[0.11] == pytest.approx(0.5, rel=0.08)


def test_an_effort_at_the_end_of_its_range_is_not_believed(tmp_path: Path) -> None:
    """A recorder that clips at two thirds of the largest force."""
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, x, np.clip(u, -4.5, 4.5)))
    assert found(data) == []
    assert mass(data) == pytest.approx(MASS, rel=0.05)
    assert any("end of its range" in r for r in data["reasons"])


@pytest.mark.slow
def test_a_gain_that_falls_with_the_effort_is_a_function_of_it(tmp_path: Path) -> None:
    """A motor that saturates: 5 % of its force at 4 N."""
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, x, u * (1 + 0.05 * (u / 4) ** 2)))
    assert domains(data) == {("unknown", "current")}
    assert data["error"]["torque"]["after"] < 0.5 * data["error"]["torque"]["before"]


@pytest.mark.slow
def test_a_spring_is_a_function_of_the_place_and_no_loop(tmp_path: Path) -> None:
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, x, u + 6.0 * x))
    assert set(found(data)) == {"unknown"} and data["effects"][0]["domain"] == "axis_angle"
    stiffness = data["effects"][0]["parameters"]["stiffness"]["value"]
    assert stiffness == pytest.approx(6.0, rel=0.05)


@pytest.mark.slow
def test_a_fixed_frequency_has_the_size_before_the_filter(tmp_path: Path) -> None:
    """The filter of 0.1 s leaves two thirds of 7.7 Hz."""
    t, x, u = motion(LONG)
    text = FORCE + "smooth_s: 0.1\n"
    data = answer(tmp_path, text, (t, x, u + 0.5 * np.sin(2 * np.pi * 7.7 * t)))
    first = data["effects"][0]
    assert first["name"] == "command_disturbance"
    assert first["parameters"]["amplitude"]["value"] == pytest.approx(0.5, rel=0.03)


@pytest.mark.slow
def test_what_no_domain_holds_is_not_nothing(tmp_path: Path) -> None:
    """A slow random force, several times what the sensors leave."""
    t, x, u = motion(LONG)
    noise = np.random.default_rng(3).standard_normal(len(t))
    slow = np.convolve(noise, np.hanning(81) / 20, "same")
    data = answer(tmp_path, FORCE, (t, x, u + 1.5 * slow))
    assert data["verdict"] in ("cannot tell", "unknown")
    assert not set(found(data)) - {"unknown"}


def test_a_position_that_leaps_is_joined(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, np.where(t > 31.0, x + 0.7, x), u))
    assert found(data) == []
    assert mass(data) == pytest.approx(MASS, rel=0.03)
    assert "leaps by 0.7" in capsys.readouterr().out


@pytest.mark.parametrize("widths", [(0.02,), (0.02, 0.06, 0.18)])
def test_lost_motion_of_several_widths_is_no_gap(tmp_path: Path, widths: tuple[float, ...]) -> None:
    """One elastoplastic element is a gap; three are a strain wave gear's hysteresis."""
    t, x, _ = motion(LONG)
    lost = np.zeros(len(x))
    for width in widths:
        z = 0.0
        for k, step in enumerate(np.diff(x, prepend=x[0])):
            z = min(max(z + step, -width), width)
            lost[k] += 1e-4 * z / width
    y = 0.02 * x - lost + 2e-7 * np.random.default_rng(2).standard_normal(len(t))
    names = domains(answer(tmp_path, SENSORS, (t, x, y)))
    assert names == ({("play", "reversal")} if len(widths) == 1 else {("unknown", "reversal")})


@pytest.mark.slow
def test_a_gap_that_is_thrown_from_flank_to_flank_is_play(tmp_path: Path) -> None:
    """The driven side has hardly any friction of its own: it leads while the drive brakes."""
    t, x, _ = motion(LONG)
    a = rate(rate(x))
    y = 0.02 * x - 1e-4 * np.sign(a) + 2e-7 * np.random.default_rng(2).standard_normal(len(t))
    first = answer(tmp_path, SENSORS, (t, x, y))["effects"][0]
    assert first["name"] == "play"
    assert first["parameters"]["gap"]["value"] == pytest.approx(2e-4, rel=0.1)


def test_an_encoder_that_bows_away_more_and_more_is_a_ratio_that_moves(tmp_path: Path) -> None:
    """In proportion to the place and to the time; neither sensor knows where it is held."""
    t, x, _ = motion(LONG)
    y = 0.02 * x + 3e-3 * (t / LONG) * (x + 0.25) + 2e-7 * np.random.default_rng(2).standard_normal(len(t))
    data = answer(tmp_path, SENSORS, (t, x, y))
    assert domains(data) == {("unknown", "time")}
    assert data["error"]["position"]["after"] < 0.05 * data["error"]["position"]["before"]


COARSE = 2e-4  # position units: steps of the sensor, which a travel of 0.8 makes 4000 of


def late_by_8_ms(folder: Path, noise_n: float) -> dict[str, Any]:
    t, x, u = motion(LONG)
    noise = noise_n * np.random.default_rng(4).standard_normal(len(t))
    x = np.round(x / COARSE) * COARSE
    data = answer(folder, FORCE, (t, x, np.interp(t - 0.008, t, u) + noise))
    assert data["error"]["torque"]["before"] < data["error"]["torque"]["floor"]
    return data


@pytest.mark.slow
def test_a_delay_below_the_floor_is_named_where_it_is_most_of_what_is_left(tmp_path: Path) -> None:
    """Under a force's noise of 0.3 N; the floor holds what steps of the position may hide, too."""
    data = late_by_8_ms(tmp_path, 0.3)
    assert found(data) == ["channel_delay"]
    assert data["effects"][0]["parameters"]["delay"]["value"] == pytest.approx(0.008, rel=0.15)
    assert data["error"]["torque"]["after"] < 0.6 * data["error"]["torque"]["before"]


def test_a_small_delay_below_the_floor_is_not_named(tmp_path: Path) -> None:
    """The same under 0.7 N."""
    assert found(late_by_8_ms(tmp_path, 0.7)) == []


@pytest.mark.slow
def test_an_asymmetry_is_no_larger_than_the_friction_it_is_of(tmp_path: Path) -> None:
    """Beyond it friction would push; each of its two sizes has the declared one's bound."""
    t, x, u = motion(LONG)
    size = 1.5 * COULOMB * np.abs(np.sign(rate(x))) + 1.5 * VISCOUS * np.abs(rate(x))
    data = answer(tmp_path, FORCE, (t, x, u + size))
    for e in data["effects"]:
        if e["name"] == "friction_asymmetry":
            p = {k: v["value"] for k, v in e["parameters"].items()}
            assert abs(p.get("coulomb_asymmetry", 0.0)) <= 1.05 * COULOMB
            assert abs(p.get("viscous_asymmetry", 0.0)) <= 1.05 * VISCOUS
    assert data["verdict"] != "nothing"


@pytest.mark.slow
def test_a_gain_that_follows_the_place_is_a_function_of_it(tmp_path: Path) -> None:
    """A motor whose winding is worse at one end of its travel."""
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, x, u * (1 + 0.3 * np.clip(x - 0.1, 0.0, None))))
    assert domains(data) == {("unknown", "axis_angle")}
    assert data["error"]["torque"]["after"] < 0.5 * data["error"]["torque"]["before"]


@pytest.mark.slow
def test_a_line_keeps_its_phase_beside_an_unnamed_function(tmp_path: Path) -> None:
    """Three files, so that the line of the one that is held out has a phase nobody fitted."""
    tables = []
    for k in range(3):
        t, x, u = motion(LONG / 2)
        weak = u * (1 + 0.3 * np.clip(x - 0.1, 0.0, None))
        tables.append((t, np.round(x, 5), weak + 0.8 * np.sin(2 * np.pi * 5.43 * t + 2.0 * k)))
    data = answer_of(tmp_path, FORCE, *tables)
    assert {"command_disturbance", "unknown"} <= set(found(data))
    assert data["error"]["torque"]["after"] < 0.2 * data["error"]["torque"]["before"]


@pytest.mark.slow
@pytest.mark.parametrize("hertz", [1.487, 3.71, 5.43])
def test_a_fixed_frequency_beside_a_multiple_of_the_motion_is_found(tmp_path: Path, hertz: float) -> None:
    """Motion that repeats itself every 8 s has a multiple every 0.12 Hz; most frequencies are near one."""
    t, x, u = motion(LONG)
    data = answer(tmp_path, FORCE, (t, x, u + 0.5 * np.sin(2 * np.pi * hertz * t)))
    first = data["effects"][0]
    assert first["name"] == "command_disturbance"
    assert first["frequency_Hz"] == pytest.approx(hertz, abs=0.01)
    assert first["parameters"]["amplitude"]["value"] == pytest.approx(0.5, rel=0.06)
