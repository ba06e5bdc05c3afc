"""Sealed logs of other drives: deterministic, hashed, sized as asked, physics that holds."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from calibration.inputs.rigfile import load_rig
from tests.blind.drives import cells, mount, slots, table
from tests.blind.drives.case import build, seal
from tests.blind.drives.effects import OUTSIDE, WHERE
from tests.blind.drives.families import FAMILIES
from tests.blind.drives.order import Order
from tests.blind.drives.score import score


@pytest.mark.slow
def test_same_seed_same_bytes_and_the_seal_is_the_hash_of_the_truth(tmp_path: Path) -> None:
    order = Order("x", "single", "servo", ("gravity_imbalance",), 5.0, "heavy", "spikes", 5.0)
    for name in ("one", "two"):
        seal(order, 1001, tmp_path / name / "logs", tmp_path / name / "truth")
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*") if p.is_file())
    assert [f.name for f in files] == ["SEAL", "rig.yaml", "run1.csv", "run2.csv", "run3.csv", "x.json"]
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    truth = (tmp_path / "one" / "truth" / "x.json").read_bytes()
    assert (tmp_path / "one" / "logs" / "x" / "SEAL").read_text().strip() == hashlib.sha256(truth).hexdigest()
    told = (tmp_path / "one" / "logs" / "x" / "rig.yaml").read_text() + files[0].name
    assert "gravity" not in told


def test_every_name_is_drawn_in_its_families_and_keys_are_unique() -> None:
    orders = cells.everything()
    assert len({o.key for o in orders}) == len(orders)
    for draws in (WHERE, OUTSIDE):
        for draw, kinds in draws.items():
            assert set(kinds) <= set(FAMILIES)
            drawn = {o.kind for o in orders if o.names == (draw.__name__,)}
            assert drawn - {"telescope"} == set(kinds)
    for kind, names in (("mount", cells.MOUNT), ("telescope", cells.TELESCOPE)):
        assert {o.names[0] for o in orders if o.kind == kind and o.cell == "single"} == set(names)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "name"), [("mount", "worm_error"), ("telescope", "supply_sag")])
def test_drives_of_files_of_their_own_are_sealed_the_same_way(tmp_path: Path, kind: str, name: str) -> None:
    order = Order("x", "single", kind, (name,), 5.0, seconds=1200.0)
    for folder in ("one", "two"):
        seal(order, 1004, tmp_path / folder / "logs", tmp_path / folder / "truth")
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*") if p.is_file())
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    truth = json.loads((tmp_path / "one" / "truth" / "x.json").read_text())
    assert truth["effects"][0]["reached"] == pytest.approx(5.0, rel=0.11)
    assert load_rig(tmp_path / "one" / "logs" / "x" / "rig.yaml").stages


def test_a_worm_is_as_large_as_asked_for_over_the_seeing() -> None:
    rng = np.random.default_rng(3)
    m = mount.draw(rng)
    bare, worn = (
        mount.night(np.random.default_rng(5), m, hidden, "gaussian", 0.0, 3600.0)[:, 1]
        for hidden in (None, mount.gear_error(rng, m, 4.0))
    )
    assert np.std(worn - bare) == pytest.approx(4.0 / np.sqrt(2), rel=0.1)


@pytest.mark.parametrize("kind", FAMILIES)
def test_a_pure_drive_keeps_newtons_law(kind: str) -> None:
    """Force less mass times acceleration is friction: between the Coulomb level and the viscous line."""
    made, _, _, _ = build(Order("pure", "nothing", kind, seconds=5.0), 1002)
    rows, p = made.rows[0], made.plant
    moving = np.abs(rows[:, slots.V]) > 20 * p["VS"]
    if not moving.any():
        moving = np.abs(rows[:, slots.V]) > 5 * p["VS"]
    effort, v, a = rows[:, slots.EFFORT], rows[:, slots.V], rows[:, slots.A]
    left = p["GAIN"] * effort - p["MASS"] * a
    expected = p["COUL"] * np.sign(v) + p["VISC"] * v
    error = np.median(np.abs(left - expected)[moving]) / p["COUL"]
    assert error < 0.1
    assert np.std(made.references[0] - rows[:, slots.X]) < 0.05 * np.std(made.references[0])


@pytest.mark.parametrize(
    ("name", "kind"),
    [("gravity_imbalance", "servo"), ("brake_drag", "belt"), ("channel_delay", "ball_screw")],
)
def test_the_hidden_force_has_the_ratio_asked_for(name: str, kind: str) -> None:
    _, hidden, size, _ = build(Order("sized", "single", kind, (name,), 3.0, seconds=20.0), 1003)
    assert hidden is not None and size == pytest.approx(3.0, rel=0.12)


def test_scores_count_a_wrong_name_and_how_sure_it_was() -> None:
    truth = {
        "key": "k", "cell": "single", "family": "servo", "kind": "gaussian", "spoil": "",
        "effects": [{"name": "play", "class": ["play"], "channel": "K", "domain": ["reversal"], "ratio": 2.0,
                     "reached": 2.0, "in_catalogue": True}],
    }  # fmt: skip
    told = {"failure": None, "seconds": 1.0}
    report = {"verdict": "found", "error": {}, "effects": [{"name": "presliding", "probability": 0.95}]}
    row = score(told, report, truth)
    assert (row["right"], row["wrong"], row["sure_and_wrong"]) == (False, 1, 1)
    report["effects"] = [{"name": "play", "probability": 0.6, "equivalent": []}]
    row = score(told, json.loads(json.dumps(report)), truth)
    assert (row["right"], row["wrong"], row["sure_and_wrong"]) == (True, 0, 0)


def test_an_effect_that_no_such_drive_shows_is_counted_apart() -> None:
    row = {
        "cell": "single", "truth": "channel_delay", "family": "belt", "reached": 0.4, "right": False,
        "wrong": 0, "said": [], "verdict": "nothing", "answered": True, "seconds": 1.0, "sure_and_wrong": 0,
    }  # fmt: skip
    told = table.markdown([row, {**row, "reached": 2.0, "right": True}], 1)
    assert "| one effect, ratio ≥ 2, right name or class | ≥ 90 % | 100.0 % (2.5–100.0), 1 of 1 |" in told
    assert "| the same, no plausible size comes to ratio 2 |  | 0.0 % (0.0–97.5), 0 of 1 |" in told
