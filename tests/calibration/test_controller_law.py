"""A rig file that declares its controller: the command against its law."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.decide.selection import Selection
from calibration.errors import CalibrationInputError
from calibration.inputs.rigfile import load_rig
from calibration.report import plots
from tests.calibration.test_drives import answer

PERIOD_S = 0.001
GAINS = {"p": 900.0, "i": 2000.0, "d": 40.0}
RIG = """rig: slide
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: m}
  effort: {column: u, unit: N}
  reference: {column: r, unit: m}
response: {channel: effort, unit: N}
estimate: [inertia, viscous, coulomb, offset]
controller: {law: pid, gains: {p: 900, i: 2000, d: 40}, source: this test}
"""


def loop(
    seed: int, hertz: float = 0.0, slow: float = 1.0, square: bool = False, forward: float = 0.0
) -> tuple[np.ndarray, ...]:
    """Time, position, effort and reference of 2 kg with friction behind a PID; a sine (or a square) of 0.4 N
    at `hertz`, gains that are `slow` times as large below 0.1 m/s, and `forward` kg times the reference's
    acceleration act in front of the logged effort."""
    t = np.arange(0.0, 20.0, PERIOD_S)
    r = 0.2 * np.sin(2 * np.pi * 0.21 * t + seed) + 0.05 * np.sin(2 * np.pi * 0.83 * t)
    rng = np.random.default_rng(seed)
    ahead = forward * np.gradient(np.gradient(r, PERIOD_S), PERIOD_S)
    x = np.zeros(len(t))
    u = np.zeros(len(t))
    at, v, whole, last = r[0], 0.0, 0.0, 0.0
    for k in range(len(t)):
        x[k] = at + 2e-7 * rng.standard_normal()
        e = r[k] - x[k]
        whole += e * PERIOD_S
        rate = (e - last) / PERIOD_S if k else 0.0
        last = e
        law = GAINS["p"] * e + GAINS["i"] * whole + GAINS["d"] * rate
        quick = k == 0 or abs(r[k] - r[k - 1]) > 0.1 * PERIOD_S
        wave = np.sin(2 * np.pi * hertz * t[k] + seed)
        u[k] = (1.0 if quick else slow) * law + ahead[k] + 0.4 * (np.sign(wave) if square else wave)
        for _ in range(4):
            force = u[k] - 4.0 * v - 3.0 * np.tanh(v / 1e-3)
            v += force / 2.0 * PERIOD_S / 4
            at += v * PERIOD_S / 4
    return t, x, u, r


def report(folder: Path, rig: str, **changes: Any) -> dict[str, Any]:
    return answer(folder, rig, *[loop(k, **changes) for k in range(3)], header="t,x,u,r")


@pytest.mark.slow
def test_a_sound_loop_of_a_plain_log_writer_keeps_its_law(tmp_path: Path) -> None:
    """The position is written after the step, its zero is another, and the logged command ends at 5 N."""
    tables = []
    for k in range(3):
        t, x, u, r = loop(k)
        after = np.concatenate([x[1:], x[-1:]]) + 1e-4
        noise = 0.03 * np.random.default_rng(k).standard_normal(len(t))  # else the end is seen by itself
        tables.append((t, after, np.clip(u, -5.0, 5.0) + noise, r))
    data = answer(tmp_path, RIG.replace("source:", "limit: 5.0, source:"), *tables, header="t,x,u,r")
    assert of_the_command(data) == []
    for name, value in GAINS.items():
        assert data["calibrated"][f"gain_{name}"]["value"] == pytest.approx(value, rel=0.03)


def of_the_command(data: dict[str, Any]) -> list[dict[str, Any]]:
    return [e for e in data["effects"] if e["channel"] == "S"]


@pytest.mark.slow
def test_a_sound_loop_keeps_its_law_and_gets_its_gains(tmp_path: Path) -> None:
    data = report(tmp_path, RIG)
    assert of_the_command(data) == []
    for name, value in GAINS.items():
        assert data["calibrated"][f"gain_{name}"]["value"] == pytest.approx(value, rel=0.02)
    assert data["error"]["command"]["after"] < 0.1  # N, of 5 N


@pytest.mark.slow
def test_an_integral_goes_on_where_rows_are_missing(tmp_path: Path) -> None:
    """Three files of twenty seconds, each with three gaps of 0.3 s."""
    tables = []
    for k in range(3):
        columns = loop(k)
        keep = np.ones(len(columns[0]), dtype=bool)
        for first in (4100, 9300, 15700):
            keep[first : first + 300] = False
        tables.append(tuple(c[keep] for c in columns))
    data = answer(tmp_path, RIG, *tables, header="t,x,u,r")
    assert of_the_command(data) == []
    for name, value in GAINS.items():
        assert data["calibrated"][f"gain_{name}"]["value"] == pytest.approx(value, rel=0.03)


@pytest.mark.slow
def test_a_quick_disturbance_has_its_size_before_the_filter(tmp_path: Path) -> None:
    """The filter of the balance leaves four fifths of it (`smooth_s` says how wide it is)."""
    (found,) = of_the_command(report(tmp_path, RIG + "smooth_s: 0.02\n", hertz=26.3))
    assert found["frequency_Hz"] == pytest.approx(26.3, abs=0.02)
    assert found["parameters"]["amplitude"]["value"] == pytest.approx(0.4, rel=0.05)


@pytest.mark.slow
def test_a_square_is_one_disturbance(tmp_path: Path) -> None:
    (found,) = of_the_command(report(tmp_path, RIG, hertz=1.3, square=True))
    assert found["name"] == "command_disturbance" and found["equivalent"] == []
    assert found["parameters"]["amplitude"]["value"] == pytest.approx(0.4 * 4 / np.pi, rel=0.05)


@pytest.mark.slow
def test_a_disturbance_of_the_command_is_seen_where_the_balance_of_forces_cannot(tmp_path: Path) -> None:
    """It moves the slide, so that force and motion agree."""
    data = report(tmp_path, RIG, hertz=3.7)
    (found,) = of_the_command(data)
    assert found["name"] == "command_disturbance"
    assert found["frequency_Hz"] == pytest.approx(3.7, abs=0.01)
    assert found["parameters"]["amplitude"]["value"] == pytest.approx(0.4, rel=0.05)
    assert data["error"]["command"]["after"] < 0.5 * data["error"]["command"]["before"]
    bare = tmp_path / "bare"
    bare.mkdir()
    alone = report(bare, RIG[: RIG.index("controller")], hertz=3.7)
    assert all(abs((e["frequency_Hz"] or 0.0) - 3.7) > 0.1 for e in alone["effects"])


@pytest.mark.slow
def test_gains_that_follow_the_speed_are_unknown_over_the_command(tmp_path: Path) -> None:
    found = of_the_command(report(tmp_path, RIG, slow=0.7))
    assert [(f["name"], f["domain"]) for f in found] == [("unknown", "command")]


@pytest.mark.slow
def test_a_feed_forward_is_unknown_until_it_is_declared(tmp_path: Path) -> None:
    (found,) = of_the_command(report(tmp_path, RIG, forward=1.5))
    assert (found["name"], found["domain"]) == ("unknown", "command")
    assert "feed-forward" in found["note"]
    declared = tmp_path / "declared"
    declared.mkdir()
    data = report(declared, RIG.replace("d: 40}", "d: 40, acceleration_feedforward: 1.4}"), forward=1.5)
    assert of_the_command(data) == []
    gain = data["calibrated"]["gain_acceleration_feedforward"]
    assert gain["value"] == pytest.approx(1.5, rel=0.02) and gain["unit"] == "N s2/m"


@pytest.mark.slow
def test_another_gain_than_the_declared_one_is_told(tmp_path: Path) -> None:
    data = report(tmp_path, RIG.replace("d: 40", "d: 30"))
    (found,) = of_the_command(data)
    assert found["name"] == "unknown" and found["note"].startswith("controller: gain_d is 40")
    assert any("+3" in r and "of the declared one" in r for r in data["reasons"])


@pytest.mark.slow
def test_the_report_shows_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its picture's error is the table's: the line has the held-out file's own phase."""
    drawn: list[Selection] = []
    draw = plots.trace_plot
    monkeypatch.setattr(plots, "trace_plot", lambda s, d, title: (drawn.append(s), draw(s, d, title))[1])
    report(tmp_path, RIG, hertz=3.7)
    logs = sorted(tmp_path.glob("run*.csv"))
    assert calibrate(logs, tmp_path / "rig.yaml", [], tmp_path / "pictures") == 0
    page = (tmp_path / "pictures" / "report.html").read_text()
    assert "a law's gains among them, are those of the fitted rows" in page.replace("&#39;", "'")
    law = drawn[-1]
    after = law.model.residual(law.problem, law.problem.test)
    assert np.sqrt(np.mean(after**2)) == pytest.approx(law.held.after) and law.held.after < 0.05


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        ("law: pid", "law: cascade", "'position' is missing"),
        ("p: 900, ", "", "'p' is missing"),
        (
            "d: 40}",
            "d: 40, velocity: 2}",
            "a pid has none; it has acceleration_feedforward, d, i",
        ),
        ("  reference: {column: r, unit: m}\n", "", "needs the columns reference and effort"),
        ("{column: r, unit: m}", "{column: r, unit: mm}", "must be the position's"),
        ("law: pid", "law: pd", "'pd' is not one of pid, cascade"),
    ],
)
def test_a_wrong_controller_is_one_line(tmp_path: Path, was: str, now: str, said: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(RIG.replace(was, now))
    with pytest.raises(CalibrationInputError, match=said):
        load_rig(path)
