"""Guide logs as mounts and PHD2 versions write them: what is summed up, what is refused, what a worm is."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.balances.guide import _air
from calibration.balances.mounts import SIDEREAL_DAY_S, known_mount
from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.guidelog import read_guide_log
from calibration.inputs.logs import read_drive
from calibration.inputs.run import Run
from calibration.look.drift import look_at_drift
from calibration.look.looked import Options
from tests.calibration import guidelogs
from tests.calibration.guidelogs import TOP, section
from tests.calibration.test_readers import GUIDE


def night(teeth: float, phases: list[float], amplitude: float = 3.0, seed: int = 5, **more: Any) -> str:
    """Sections of 80 minutes with a worm at its own phase in each, drift and star noise."""
    rng = np.random.default_rng(seed)
    text = TOP
    for k, phase in enumerate(phases):
        t = np.arange(0, 4800, 5.0) + rng.uniform(0, 0.3, 960)
        worm = amplitude * np.sin(2 * np.pi * teeth / SIDEREAL_DAY_S * t + phase)
        e = worm + 0.002 * t + np.cumsum(rng.normal(0, 0.03, 960)) + rng.normal(0, 0.3, 960)
        text += section(f"2026-01-01 2{k}:00:00", t, e, **more)
    return text


def report(tmp_path: Path, text: str, hold: list[str] | None = None) -> dict[str, Any]:
    path = tmp_path / "night.txt"
    path.write_text(text)
    assert calibrate([path], None, hold or [], tmp_path / "out", plots=False) == 0
    data: dict[str, Any] = json.loads((tmp_path / "out" / "report.json").read_text())
    return data


@pytest.mark.slow
def test_a_worm_with_a_phase_of_its_own_in_every_section_is_found_and_pays_on_held_out_frames(
    tmp_path: Path,
) -> None:
    data = report(tmp_path, night(180, [0.3, 2.0, 4.4], dither=200))
    assert [e["stage"] for e in data["effects"]] == ["worm of a 180-tooth wheel"]
    amplitude = data["effects"][0]["parameters"]["amplitude"]
    assert amplitude["low"] < 3.0 < amplitude["high"]
    assert data["error"]["position"]["after"] < 0.6 * data["error"]["position"]["before"]
    assert data["held_out"] == ["pieces of 480 s, in turn"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wheel", "phases", "found"),
    [
        (288.0, [0.4], [("gear_eccentricity", "worm of a 288-tooth wheel")]),
        (291.5, [0.4], [("unknown", None)]),  # a quarter turn off in 80 minutes, of sines of 3 in 0.3 arcsec
        (248.0, [0.4, 2.0], [("gear_eccentricity", "worm of a 248-tooth wheel")]),
    ],
)
def test_a_usual_wheel_is_assumed_where_the_period_is_its_own(
    tmp_path: Path, wheel: float, phases: list[float], found: list[tuple[str, str | None]]
) -> None:
    data = report(tmp_path, night(wheel, phases, mount="On-camera"))
    assert [(e["name"], e["stage"]) for e in data["effects"]] == found
    assert data["effects"][0]["frequency_Hz"] == pytest.approx(wheel / SIDEREAL_DAY_S, rel=0.004)


@pytest.mark.slow
def test_a_mount_without_periodic_error_gets_nothing(tmp_path: Path) -> None:
    data = report(tmp_path, night(180, [0.0, 1.0], amplitude=0.0))
    assert data["verdict"] == "nothing" and data["effects"] == []


@pytest.mark.slow
def test_short_sections_are_left_out_and_said(tmp_path: Path) -> None:
    t = np.arange(0, 60, 5.0)
    text = night(180, [0.3, 2.0]) + section("2026-01-01 23:00:00", t, 0 * t)
    data = report(tmp_path, text)
    assert data["effects"] and any("1 of 3 sections left out" in r for r in data["reasons"])
    assert np.isfinite(data["error"]["position"]["before"])


def test_a_log_of_ten_minutes_cannot_tell(tmp_path: Path) -> None:
    t = np.arange(0, 600, 5.0)
    data = report(tmp_path, section("2026-01-01 20:00:00", t, 3 * np.sin(2 * np.pi * t / 478.7)))
    assert data["verdict"] == "cannot tell" and data["reasons"]
    assert "two turns, for worm of a" in data["separating_experiment"]


def test_a_correction_that_was_never_sent_is_not_summed_up(tmp_path: Path) -> None:
    text = GUIDE.replace("0.100,0,0.050,0,10,W,0", "0.100,0,0.050,0,0,,0")
    (tmp_path / "g.txt").write_text(text)
    run = read_guide_log(tmp_path / "g.txt")[0]
    assert run.columns["ra"][:2] == pytest.approx([0.2, 0.4])  # raw x 2 arcsec/px, nothing added by hand


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"Mount",', '"AO",', "adaptive-optics"),
        ('"Mount",', '"DROP",', "every frame is marked DROP"),
        ("Pixel scale = 2.00", "Pixel scale = 0", ":14: the section above .* pixel scale '0'"),
        ("1,1.0,", "1,,", ":14: column 'Time': is no time"),
        (
            '2,2.0,"Mount",0,0,0.200,0,0.000,0',
            '2,2,0,"Mount",0,0,0,200,0,0,000,0',
            ":15: column 'mount': '0' is none of .*decimal commas",
        ),
        ("RARawDistance", "RaDist", "the column 'RARawDistance' is missing"),
    ],
)
def test_a_guide_log_that_cannot_be_summed_says_why(tmp_path: Path, old: str, new: str, says: str) -> None:
    (tmp_path / "g.txt").write_text(GUIDE.replace(old, new))
    with pytest.raises(CalibrationInputError, match=says):
        read_guide_log(tmp_path / "g.txt")


def test_code_pages_byte_order_marks_decimal_commas_in_the_scale_and_a_cut_end_are_read(
    tmp_path: Path,
) -> None:
    text = GUIDE.replace("Pixel scale = 2.00", "Pixel scale = 2,00").replace(
        "Mount = Astro", "Mount = Montüre Astro"
    )
    path = tmp_path / "g.txt"
    for content in (
        text.encode("cp1252"),
        b"\xef\xbb\xbf" + text.encode(),
        text.replace("\n", "\r\n").encode(),
    ):
        path.write_bytes(content)
        found = read_drive([path], None)
        assert found.rig is None and found.runs[0].columns["ra"][0] == pytest.approx(0.2)
    path.write_text(GUIDE[: GUIDE.index("INFO: DITHER")] + '5,5.0,"Mou')
    assert read_guide_log(path)[0].rows == 3


@pytest.mark.parametrize(
    ("name", "teeth"),
    [
        ("Celestron AVX/CGE/CGEM/CGX", (180, 144)),
        ("EQMOD HEQ5/6 (ASCOM)", (135, 180)),
        ("AstroPhysicsV2", (225,)),
        ("ZWO AM5", ()),
    ],
)
def test_the_wheel_follows_from_the_mounts_name_or_is_not_assumed(name: str, teeth: tuple[int, ...]) -> None:
    assert known_mount([Run("a", Path("a"), "a", {}, header={"mount": name})]) == teeth


@pytest.mark.slow
def test_worm_free_nights_of_fresh_seeds_get_no_worm(tmp_path: Path) -> None:
    """Seeds that nothing was set on (0 to 29 were): one wrong name in eight would be too many."""
    for seed in range(500, 508):
        text, _, _ = guidelogs.night(seed, 0.0)
        (tmp_path / str(seed)).mkdir()
        assert report(tmp_path / str(seed), text)["effects"] == [], seed


@pytest.mark.slow
def test_worms_of_fresh_seeds_are_named_where_the_mount_is_known(tmp_path: Path) -> None:
    """A worm of 4 arcsec in a wander of 1 to 3: the right wheel, or none, never another one."""
    named = 0
    for seed in range(600, 606):
        text, mount, teeth = guidelogs.night(seed, 4.0)
        (tmp_path / str(seed)).mkdir()
        data = report(tmp_path / str(seed), text)
        stages = [e["stage"] for e in data["effects"] if e["stage"]]
        rate = teeth / SIDEREAL_DAY_S
        for e in data["effects"]:
            assert not e["stage"] or abs(e["frequency_Hz"] - rate) * 7000 < 1.0, (seed, mount, stages)
        named += bool(stages)
    assert named >= 4


def named(seed: int, amplitude: float, turns: float) -> list[str | None]:
    text, _, _ = guidelogs.night(seed, amplitude, turns)
    looked = look_at_drift(read_guide_log(Path("night.txt"), text), None, Options())
    return [f.stage for f in looked.effects if f.name != "unknown"]


@pytest.mark.slow
def test_two_turns_are_enough_for_a_worm_and_wander_over_three_is_none() -> None:
    """Eight nights each, of slow quasi-periodic air; 6 arcsec of a worm stand out of it."""
    assert sum(bool(named(seed, 0.0, 3.3)) for seed in range(8)) <= 1
    assert sum(bool(named(seed, 6.0, 2.4)) for seed in range(8)) >= 6


def air() -> np.ndarray:
    """Seeing of 0.5 arcsec every 2 s, half of it with 6 s of memory."""
    rng, keep = np.random.default_rng(4), np.exp(-2.0 / 6.0)
    slow = np.zeros(3000)
    for k in range(1, len(slow)):
        slow[k] = keep * slow[k - 1] + np.sqrt(1 - keep**2) * rng.standard_normal()
    return np.asarray(0.5 * (slow + rng.standard_normal(len(slow))) / np.sqrt(2.0))


@pytest.mark.parametrize("worm", [0.0, 5.0])
@pytest.mark.parametrize("dithered_every_s", [6000, 60])
def test_the_floor_holds_the_colour_of_the_air(worm: float, dithered_every_s: int) -> None:
    """A worm of ten times that is no part of it, nor another place after a dither, which leaves out 10 s."""
    t = np.arange(0.0, 6000.0, 2.0)
    segment = (t // dithered_every_s).astype(np.int64)
    place = 20.0 * np.random.default_rng(5).standard_normal(segment.max() + 1)[segment]
    y = air() + worm * np.sin(2 * np.pi * t / 480.0) + place
    y[(t % dithered_every_s < 10.0) & (segment > 0)] = np.nan
    assert _air(y, segment, 20) == pytest.approx(0.5, rel=0.2)


def test_a_jump_is_no_air() -> None:
    y = air() + 20.0 * (np.arange(3000) > 1400)
    assert _air(y, np.zeros(3000, dtype=np.int64), 20) == pytest.approx(0.5, rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(("turns", "found"), [((1.8, 1.6), True), ((1.8, 1.0), False)])
def test_sections_tell_a_worm_together_where_one_is_too_short(
    tmp_path: Path, turns: tuple[float, float], found: bool
) -> None:
    rng, text = np.random.default_rng(8), TOP
    for k, count in enumerate(turns):
        t = np.arange(0.0, count * SIDEREAL_DAY_S / 180, 2.0)
        e = 12.0 * np.sin(2 * np.pi * 180 / SIDEREAL_DAY_S * t + 2.0 * k) + 0.002 * t
        text += section(f"2026-01-01 2{k}:00:00", t, e + rng.normal(0, 0.3, len(t)))
    effects = report(tmp_path, text)["effects"]
    worms = [each for each in effects if each["stage"] and "180" in each["stage"]]
    assert bool(worms) is found
    if found:
        assert worms[0]["parameters"]["amplitude"]["value"] == pytest.approx(12.0, rel=0.05)
