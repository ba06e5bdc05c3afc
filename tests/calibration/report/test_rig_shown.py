"""What `schmidt rig` prints of a drive and its files, line by line, and the picture of its columns."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest

from calibration.inputs.declaration import Column, Rig
from calibration.inputs.run import Run, Signal
from calibration.report import rigview
from calibration.report.rigview import SI, _draw, _head, _table, show_rig
from tests.calibration.logs import tiny_log

RIG = """rig: bench
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: turn}
  force: {column: u, unit: N m}
response: {channel: force, unit: N m}
estimate: [offset]
"""
SAID = ["bench", "explains force in N m", "estimates offset"]


def written(folder: Path, *logs: str) -> tuple[Path, list[Path]]:
    (folder / "rig.yaml").write_text(RIG)
    paths = [folder / f"{name}.csv" for name in "abc"[: len(logs)]]
    for path, text in zip(paths, logs, strict=True):
        path.write_text(text)
    return folder / "rig.yaml", paths


def rows(count: int, u: str = "{k}") -> str:
    return "t,x,u\n" + "".join(f"{k / 10:.1f},{k * k % 7},{u.format(k=k % 3)}\n" for k in range(count))


def test_a_declaration_without_logs_is_its_own(tmp_path: Path) -> None:
    assert show_rig(written(tmp_path)[0], []).splitlines() == SAID


def test_every_file_has_its_rows_its_rate_and_its_columns(tmp_path: Path) -> None:
    rig, logs = written(tmp_path, rows(30), rows(20))
    logs_told = show_rig(rig, logs).splitlines()
    assert logs_told == [
        *SAID,
        "files start by the order of the files, end to end",
        "",
        "a: 30 rows, 2.9 s at 10 Hz, no gaps, starts at 0 s",
        "  channel   column  unit  low  high  quantum  missing  wraps",
        "  time      t       s     0    2.9   0.1      0        0",
        "  position  x       turn  0    4     1        0        0",
        "  force     u       N m   0    2     1        0        0",
        "",
        "b: 20 rows, 1.9 s at 10 Hz, no gaps, starts at 3 s",
        "  channel   column  unit  low  high  quantum  missing  wraps",
        "  time      t       s     0    1.9   0.1      0        0",
        "  position  x       turn  0    4     1        0        0",
        "  force     u       N m   0    2     1        0        0",
    ]
    (tmp_path / "a.csv").write_text(rows(80).replace("\n5.0,1,2\n", "\n5.0,1,99\n"))
    assert "  ! force: rows 51 are far off their neighbours: left out" in show_rig(rig, logs[:1]).splitlines()


def test_a_picture_is_asked_for(tmp_path: Path) -> None:
    rig, logs = written(tmp_path, rows(30))
    out = tmp_path / "deep" / "er" / "columns.png"
    assert show_rig(rig, logs, out).splitlines()[-2:] == ["", f"plot: {out}"]
    assert out.read_bytes()[:4] == b"\x89PNG"
    assert show_rig(rig, [], tmp_path / "no.png").splitlines() == SAID and not (tmp_path / "no.png").exists()


def test_a_log_that_says_its_columns_itself_is_shown_in_si(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text(tiny_log(30))
    told = show_rig(
        Path(rigview.__file__).parents[1] / "rigs" / "schmidt_ra.yaml", [tmp_path / "a.log"]
    ).splitlines()
    at = told.index("a: 30 rows, 0.29 s")
    assert told[at - 1] == "" and told[at + 1].split() == [
        "channel", "column", "unit", "low", "high", "quantum", "missing", "wraps"
    ]  # fmt: skip
    found = {line.split()[0]: line.split()[1:3] for line in told[at + 2 :]}
    units = {
        "t": "s",
        "position": "rad",
        "velocity": "rad/s",
        "effort": "1",
        "current_a": "A",
        "motor_b": "rad/s",
    }
    assert {c: found[c] for c in units} == {c: [c, unit] for c, unit in units.items()}
    assert (SI["supply"], SI["temperature"], SI["ra"], SI["aux"]) == ("V", "degC", "arcsec", "rad")


def test_gaps_and_a_start_are_told_where_there_are_any() -> None:
    t = 0.5 * np.arange(40.0)
    t[20:] += 7.0
    t[30:] += 3.25
    r = Run("a", Path("a"), "a", {"t": t}, period_s=0.5)
    assert _head(r) == "a: 40 rows, 29.75 s at 2 Hz, 2 gaps of 11.25 s in all"
    r.start_s = 12.25
    assert _head(r).endswith(", starts at 12.25 s")


def test_a_table_is_as_wide_as_its_words() -> None:
    signals = [
        Signal("x", "a long name", "", 1.23456, -2.0, None, 3, 4),
        Signal("y", "b", "m", 0.0, 1.0, 0.0123, 0, 0),
    ]
    assert _table(signals) == [
        "  channel  column       unit  low     high  quantum  missing  wraps",
        "  x        a long name        1.2346  -2    none     3        4",
        "  y        b            m     0       1     0.0123   0        0",
    ]


def record(count: int, start_s: float | None = None) -> Run:
    t = 0.1 * np.arange(float(count))
    return Run("a", Path("a"), "a", {"t": t, "x": np.arange(float(count))}, period_s=0.1, start_s=start_s)


def drawn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, *records: Run) -> list[Any]:
    kept: list[Any] = []

    def keep(fig: Any) -> bytes:
        kept.append(fig)
        return b"picture"

    monkeypatch.setattr(rigview, "drawn", keep)
    rig = Rig("bench", Path("r"), {"time": Column("s"), "x": Column("deg"), "t": Column("s")}, (), ())
    _draw(list(records), rig, tmp_path / "new" / "a.png")
    assert (tmp_path / "new" / "a.png").read_bytes() == b"picture"
    plt.close("all")
    axes: list[Any] = kept[0].axes
    return axes


def test_every_column_is_drawn_over_the_clock_of_all_files(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    gappy = record(60, 100.0)
    gappy.columns["t"] = gappy.columns["t"] + np.where(np.arange(60) >= 30, 5.0, 0.0)
    top, low = drawn(monkeypatch, tmp_path, record(50), gappy)
    assert top.get_title(loc="left") == "bench" and (top.get_ylabel(), low.get_ylabel()) == ("x\ndeg", "t\ns")
    assert low.get_xlabel() == "time, s" and top.get_xlabel() == ""
    first, second = top.lines
    assert first.get_xdata() == pytest.approx(0.1 * np.arange(50)) and second.get_xdata()[0] == 100.0
    assert np.flatnonzero(np.isnan(second.get_ydata())).tolist() == [30]
    assert not np.isnan(first.get_ydata()).any() and (first.get_color(), second.get_color()) == ("C0", "C1")
    assert top.figure.get_size_inches() == pytest.approx([9.0, 1.6 * 2 + 0.6])


@pytest.mark.parametrize(("count", "points"), [(7999, 7999), (8000, 4000), (12_001, 4001)])
def test_a_long_file_is_thinned(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, count: int, points: int
) -> None:
    (line,) = drawn(monkeypatch, tmp_path, record(count))[0].lines
    assert len(line.get_xdata()) == points and not np.isnan(line.get_ydata()).any()
