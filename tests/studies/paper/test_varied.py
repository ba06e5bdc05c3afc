"""`schmidt paper --vary`: which numbers are off, at which starts, and what the section says of it."""

import pytest

from plant.model import get, load
from scenarios.campaign.executor import Done
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper.experiments import EXPERIMENTS
from scenarios.studies.paper.experiments.experiment import Experiment, Limit
from scenarios.studies.paper.rows import Row
from scenarios.studies.paper.run_experiments import run_rows
from scenarios.studies.paper.starts import STARTS, Start
from scenarios.studies.paper.varied import markdown, variations
from tests.studies.paper.test_rows import experiment, row

PLANTS = {"low": load(LOW), "high": load(HIGH)}
PATHS = {
    "K": "motor.torque_constant",
    "R": "motor.resistance",
    "Tc": "friction.coulomb",
    "Ts": "friction.stiction",
}


def test_each_number_is_off_alone_below_and_above_at_both_preloads() -> None:
    found = variations(PLANTS, 10.0)
    assert list(found) == [f"{name} {sign}10 %" for name in ("J", "K", "R", "Tc", "Ts") for sign in "-+"]
    for name, plants in found.items():
        factor = 0.9 if "-" in name else 1.1
        for preload, model in plants.items():
            assert model.controller == PLANTS[preload].controller
            for number, path in PATHS.items():
                wanted = factor if name.startswith(f"{number} ") else 1.0
                where = f"axes.ra.{path}"
                assert get(model, where).value == pytest.approx(wanted * get(PLANTS[preload], where).value)
    rotors = 2 * 0.0006045 * 360.48864**2
    heavy = found["J +10 %"]["low"].axes.ra.inertia.si + rotors
    assert heavy == pytest.approx(1.1 * (1602.9 + rotors), rel=1e-6)  # the rotors' share with it


def test_the_section_tells_what_falls_here_and_stands_there() -> None:
    few = STARTS[:2]
    always = Experiment(
        id="E2", limits=(Limit(figure="peak", unit="%", high=1.0, words="peak"),), measure=dict
    )
    found = {"J -10 %": [row(12.0), Row(always, {each: {"peak": 3.0} for each in few})],
             "J +10 %": [row(40.0), Row(always, {each: {"peak": 2.0} for each in few})]}  # fmt: skip
    text = markdown(found, "schmidt paper --vary 10", 10.0)
    assert "Measured from 1 starts." in text  # that of the row with fewest
    assert "| E1 | · | **miss** |" in text and "| E2 | **miss** | **miss** |" in text
    assert "| J +10 % | E1 | peak (10–25) | 40 % |" in text
    assert "| J -10 % | E1 |" not in text and "% | E2 |" not in text  # which is missed everywhere
    failed = Row(experiment(), {}, {STARTS[0]: "it does not move"})
    assert "| b | E1 | not evaluated: it does not move |  |" in markdown(
        {"a": [row(12.0)], "b": [failed]}, "", 1
    )


def test_every_row_has_every_start_on_every_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is measured is not the question: a job answers with its start."""
    asked: list[tuple[str, Start]] = []

    def each(task, tasks, **_):
        for key, (_plants, name, start) in tasks:
            asked.append((name, start))
            yield Done(key, ({}, "not measured"))

    monkeypatch.setattr("scenarios.studies.paper.run_experiments.each", each)
    chosen = [each for each in EXPERIMENTS if each.id in ("E8", "E9")]
    for many in {"a": PLANTS}, {"a": PLANTS, "b": PLANTS}:
        asked.clear()
        found = run_rows(many, chosen, STARTS)
        assert [[len(row.failed) for row in rows] for rows in found.values()] == [[8, 8]] * len(many)
        assert [row.id for row in found["a"]] == ["E8", "E9"]
        assert [name for name, _ in asked] == ["E8"] * 8 * len(many) + ["E9"] * 8 * len(many)
