"""`schmidt rig`: what a log could show, before anything is fitted."""

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from calibration.report.rigview import show_rig
from scenarios.cli import cli

RIG = """rig: r
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: turn}
  force: {column: u, unit: N m}
response: {channel: force, unit: N m}
estimate: [offset]
analyse_period_s: 0.01
stages:
  - {name: motor, period: 0.5, harmonics: [2, 5]}
"""


@pytest.mark.parametrize("seconds", [400.0, 3.0])
def test_the_power_of_a_log_is_told(tmp_path: Path, seconds: float) -> None:
    """Noise of 0.5 N m at 2 turns a second; the end of the log, 40 %, is held out."""
    t = np.arange(0.0, seconds, 0.01)
    noise = 0.5 * np.random.default_rng(3).standard_normal(len(t))
    rows = "\n".join(f"{a:.2f},{2 * a:.4f},{u:.6f}" for a, u in zip(t, noise, strict=True))
    (tmp_path / "a.csv").write_text(f"t,x,u\n{rows}\n", encoding="utf-8")
    (tmp_path / "rig.yaml").write_text(RIG, encoding="utf-8")
    text = show_rig(tmp_path / "rig.yaml", [tmp_path / "a.csv"])
    assert "force: " in text and "no filter, " in text
    turns = re.search(r"turns: ([\d.]+) of motor", text)
    assert turns is not None
    assert float(turns[1]) == pytest.approx(0.6 * seconds * 2 / 0.5, rel=0.02)
    leave = re.search(r"terms leave ([\d.]+) N m rms", text)
    assert leave is not None
    assert float(leave[1]) == pytest.approx(0.5, rel=0.2)
    line = re.search(r"a line of ([\d.]+) N m", text)
    # an amplitude of 0.5 has half of the noise's mean square: plain in 24 000 rows, lost in 180
    assert (
        (line is not None and float(line[1]) < 0.25)
        if seconds > 100
        else line is None or float(line[1]) > 0.3
    )


def test_the_rig_file_may_be_named_as_calibrate_takes_it(tmp_path: Path) -> None:
    t = np.arange(0.0, 4.0, 0.01)
    rows = "\n".join(f"{a:.2f},{2 * a:.4f},{np.sin(9 * a):.6f}" for a in t)
    log, rig = tmp_path / "a.csv", tmp_path / "rig.yaml"
    log.write_text(f"t,x,u\n{rows}\n", encoding="utf-8")
    rig.write_text(RIG, encoding="utf-8")
    plain, named = (
        CliRunner().invoke(cli, ["rig", *map(str, words)]) for words in ((rig, log), (log, "--rig", rig))
    )
    assert (named.exit_code, named.stdout) == (0, plain.stdout) and "force: " in named.stdout


def test_of_many_runs_the_first_have_a_table_and_all_a_line(tmp_path: Path) -> None:
    rows = "\n".join(f"{k},{0.01 * k + 0.02 * a:.4f},{a % 3}" for k in range(6) for a in range(30))
    (tmp_path / "a.csv").write_text(f"run,x,u\n{rows}\n", encoding="utf-8")
    rig = RIG.replace("  time: {column: t, unit: s}\n", "").replace("analyse_period_s: 0.01\n", "")
    (tmp_path / "rig.yaml").write_text(rig + "sample_period_s: 0.01\nruns: {column: run}\n", encoding="utf-8")
    lines = show_rig(tmp_path / "rig.yaml", [tmp_path / "a.csv"]).splitlines()
    assert sum(line.startswith("a{") for line in lines) == 6
    assert sum(line.startswith("  channel ") for line in lines) == 4
