"""Sealed cases: deterministic, hashed, in the log's format, sized as asked."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from tests.blind.sealer import cells, sensors
from tests.blind.sealer import declared as d
from tests.blind.sealer.case import Order, build, seal
from tests.blind.sealer.catalogue import BY_NAME, CONFUSABLE, MONO_CLASS, OUTSIDE

SPEC = Path(__file__).parents[3] / "shared" / "spec" / "effects.md"
HEADER = "t,setpoint,effort,position,velocity,adc_a,adc_b,tach_a,tach_b"


def test_every_name_of_the_catalogue_can_be_sealed_and_no_other() -> None:
    if not SPEC.exists():
        pytest.skip("../shared/spec is not here: the catalogue cannot be compared")
    table = SPEC.read_text().split("## The catalogue")[1].split("\n## ")[0]
    rows = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    names = {part.strip().strip("`") for row in rows for part in row.split(",")}
    assert set(BY_NAME) == names
    assert set(OUTSIDE).isdisjoint(names)
    assert set(MONO_CLASS) <= names
    assert {name for pair in CONFUSABLE for name in pair} <= names


def test_the_cells_are_those_of_the_issue() -> None:
    orders = cells.everything()
    count = {cell: sum(o.cell == cell for o in orders) for cell in ("nothing", "single", "pair", "outside")}
    assert count["nothing"] >= 200
    assert count["pair"] == 40
    assert count["outside"] == 30
    for name in BY_NAME:
        for ratio in (1.0, 2.0, 5.0):
            assert sum(o.names == (name,) and o.ratio == ratio for o in orders) == 3
    assert len({o.key for o in orders}) == len(orders)


def test_same_seed_same_bytes_and_the_seal_is_the_hash_of_the_truth(tmp_path: Path) -> None:
    order = Order("x", "single", "mixed", ("gravity_imbalance",), 5.0, poor=True)
    for name in ("one", "two"):
        seal(order, 1001, tmp_path / name / "logs", tmp_path / name / "truth")
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*") if p.is_file())
    assert [f.name for f in files if f.suffix == ".log"] == [f"run{i}.log" for i in range(1, 5)]
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    truth = (tmp_path / "one" / "truth" / "x.json").read_bytes()
    assert (tmp_path / "one" / "logs" / "x" / "SEAL").read_text().strip() == hashlib.sha256(truth).hexdigest()
    log = (tmp_path / "one" / "logs" / "x" / "run1.log").read_text()
    assert "gravity" not in log
    assert "# format: axis-log 1" in log
    assert HEADER in log.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["motor_cogging", "supply_sag", "encoder_eccentricity", "roller_ratio"])
def test_the_largest_channel_has_the_ratio_asked_for(name: str) -> None:
    truth = build(Order("x", "single", "mixed", (name,), 2.0), 1002)[3]
    found = truth["effects"][0]["ratio_by_channel"]
    assert max(found.values()) == pytest.approx(2.0, rel=0.15)


@pytest.mark.slow
def test_pure_logs_read_what_they_should(tmp_path: Path) -> None:
    drive, traces, values, truth = build(Order("x", "nothing", "pure"), 1003)
    assert truth["effects"] == []
    for i, trace in enumerate(traces):
        out = sensors.columns(trace, drive, values, truth["number"], i)
        error = (
            np.unwrap(out["position"], period=d.POSITION_COUNTS) / d.POSITION_COUNTS * d.TURN - trace["theta"]
        )
        error -= np.round(error.mean() / d.TURN) * d.TURN
        assert np.abs(error).max() / d.ARCSEC < 6 * 0.0024140
        assert np.abs(out["velocity"]).max() < 4704 * 1.5  # 3 deg/s is 4704 counts in 5 ms
        for side in "ab":
            counts = np.cumsum(out[f"tach_{side}"])
            turns = (trace[f"phi_{side}"] - trace[f"phi_{side}"][0]) / d.TURN
            assert np.abs(counts / d.TACH_COUNTS - turns).max() < 1.5 / d.TACH_COUNTS
            amps = np.minimum(trace[f"i_{side}_log"] / d.ADC_A_PER_COUNT, d.ADC_TOP)
            assert np.abs(out[f"adc_{side}"] - amps).max() < 8.0


def test_every_pair_can_be_drawn_together() -> None:
    from tests.blind.sealer.case import merged
    from tests.blind.sealer.draw import drive

    rng = np.random.default_rng(5)
    drawn = drive(rng, "mixed")
    for order in cells.pairs():
        values = merged([BY_NAME[name](rng, drawn, 1.0, 2.0) for name in order.names])
        assert values


def test_quick_is_a_part_of_everything() -> None:
    names = {json.dumps([o.key, o.names, o.ratio]) for o in cells.everything()}
    assert {json.dumps([o.key, o.names, o.ratio]) for o in cells.quick()} <= names
