"""Which part of one file is held out: its end, unless that goes where the rest has not been."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, MASS, PERIOD, VISCOUS, answer, motion

LOADED = FORCE.replace("effort:", "applied: {column: f, unit: N}\n  effort:").replace(
    "offset]", "offset, applied]"
)
PART = 0.2  # of the load: friction of the teeth that carry it


def loaded(levels_n: list[float]) -> tuple[np.ndarray, ...]:
    """t, x, f, u of a mass to and fro, ten seconds under every load."""
    t = np.arange(0, 10.0 * len(levels_n), PERIOD)
    w = 2 * np.pi * np.array([0.4, 0.93])
    size = np.array([0.3, 0.1])
    x = (size * np.sin(np.outer(t, w))).sum(1)
    v = (size * w * np.cos(np.outer(t, w))).sum(1)
    a = -(size * w**2 * np.sin(np.outer(t, w))).sum(1)
    f = np.repeat(levels_n, round(10.0 / PERIOD))
    load = MASS * a - f
    u = load + VISCOUS * v + (COULOMB + PART * np.abs(load)) * np.sign(v)
    return t, x, f, u + 0.02 * np.random.default_rng(1).standard_normal(len(t))


@pytest.mark.slow
@pytest.mark.parametrize("levels", [[1.0, -2.0, 4.0, -9.0, 20.0, -40.0], [20.0, -9.0, 1.0, 4.0, 15.0, -30.0]])
def test_a_load_that_comes_last_is_fitted(tmp_path: Path, levels: list[float]) -> None:
    data = answer(tmp_path, LOADED, loaded(levels), header="t,x,f,u")
    assert [e["name"] for e in data["effects"]] == ["load_friction"]
    assert data["effects"][0]["parameters"]["coefficient"]["value"] == pytest.approx(PART, rel=0.05)
    assert data["calibrated"]["inertia"]["value"] == pytest.approx(MASS, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("reverse", [False, True])
def test_what_is_held_out_is_told(tmp_path: Path, reverse: bool) -> None:
    """As long as the rest of the log in either case; the end of an even log, else not the end."""
    levels = [1.0, -2.0, 4.0, -9.0, 20.0, -40.0]
    (told,) = answer(tmp_path, LOADED, loaded(levels[::-1] if reverse else levels), header="t,x,f,u")[
        "held_out"
    ]
    begin = float(told.split("from ")[1].split()[0])
    assert (" to " in told) is not reverse
    assert begin == pytest.approx(36.0, abs=1.0) if reverse else begin < 24.0


@pytest.mark.slow
def test_a_sweep_is_judged_where_the_rest_accelerates_as_much(tmp_path: Path) -> None:
    """Of one size at every frequency; a friction that nobody declared is then no drag from some time on."""
    t = np.arange(0, 40.0, PERIOD)
    phase = 2 * np.pi * (0.2 * t + 0.5 * (3.0 - 0.2) / t[-1] * t**2)
    rate = 2 * np.pi * (0.2 + (3.0 - 0.2) / t[-1] * t)
    size = 0.3 * np.minimum(1.0, 1.2 / rate)  # the speed is bounded, the acceleration is not
    x = size * np.sin(phase)
    v = np.gradient(x, t)
    u = MASS * np.gradient(v, t) + VISCOUS * v + COULOMB * np.sign(v)
    u += 0.02 * np.random.default_rng(1).standard_normal(len(t))
    data = answer(tmp_path, FORCE.replace(" coulomb,", ""), (t, x, u))
    assert " to " in data["held_out"][0]
    assert [e["name"] for e in data["effects"]] == ["coulomb_change"]


@pytest.mark.slow
def test_what_is_applied_is_a_load_without_accelerations(tmp_path: Path) -> None:
    """A cylinder under pressure: its friction grows with it, in a rig file that declares no mass."""
    t, x, f, _ = loaded([1.0, 5.0, 3.0, 9.0, 7.0, 2.0])
    v = np.gradient(x, t)
    u = -f + VISCOUS * v + (COULOMB + PART * f) * np.sign(v)
    u += 0.02 * np.random.default_rng(1).standard_normal(len(t))
    data = answer(tmp_path, LOADED.replace("inertia, ", ""), (t, x, f, u), header="t,x,f,u")
    assert [e["name"] for e in data["effects"]] == ["load_friction"]
    assert data["effects"][0]["parameters"]["coefficient"]["value"] == pytest.approx(PART, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("clock", [False, True])
def test_files_without_a_clock_have_no_time_among_them(tmp_path: Path, clock: bool) -> None:
    """Friction is another one from the third file on: a start among them only where somebody says when."""
    tables = []
    for more in (0.0, 0.0, 0.8, 0.8, 0.8):
        t, x, u = motion()
        tables.append((t, x, u + more * np.sign(np.gradient(x, t))))
    text = FORCE + ("wall_time: {from: order}\n" if clock else "")
    data = answer(tmp_path, text, *tables)
    starts = [p for e in data["effects"] for p in e["parameters"] if p == "start"]
    assert bool(starts) == clock


@pytest.mark.slow
def test_a_warm_up_of_files_without_a_clock_begins_in_every_file(tmp_path: Path) -> None:
    """The same friction, less from file to file: in which order they were measured, nobody says."""
    t, x, u = motion()
    way = np.sign(np.gradient(x, t))
    names = []
    for order in ((0, 1, 2, 3, 4), (3, 0, 4, 2, 1)):
        tables = [(t, x, u + 1.5 * np.exp(-k / 1.5) * way) for k in order]
        (tmp_path / str(order[0])).mkdir()
        data = answer(tmp_path / str(order[0]), FORCE, *tables)
        assert not any(p == "time_constant" for e in data["effects"] for p in e["parameters"])
        names.append(sorted(e["name"] for e in data["effects"]))
    assert names[0] == names[1]
