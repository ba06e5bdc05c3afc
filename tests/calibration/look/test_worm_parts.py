"""Parts of a mount in its drive error: which are seen, what periods are tried, and wrong ones beside them."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.mounts import COMMON, SIDEREAL_DAY_S, Part, known_mount, parts
from calibration.balances.problem import Problem
from calibration.finding import UNKNOWN, Finding
from calibration.inputs.declaration import Stage
from calibration.look import drift, worm
from calibration.look.worm import Mount
from tests.calibration.names.made import drive

PERIOD_S = 3.0


def problem(*spans_s: float, clock: bool = False, valid: Any = None) -> Problem:
    """Sections of so many seconds, a thousand apart."""
    t = np.concatenate([np.arange(0.0, s + 0.1, PERIOD_S) + 1000.0 * k for k, s in enumerate(spans_s)])
    run = np.repeat(np.arange(len(spans_s)), [len(np.arange(0.0, s + 0.1, PERIOD_S)) for s in spans_s])
    none = np.zeros(len(t), dtype=bool)
    return Problem(
        channel="K", unit="arcsec", y=np.zeros(len(t)), base=np.ones((len(t), 1)),
        base_labels=[("offset", "")], t=t, run=run, session=run,
        valid=~none if valid is None else valid(t), held=none, period_s=PERIOD_S,
        domains={"clock": t + 7.0} if clock else {},
    )  # fmt: skip


def mount(*rates: float, named: bool = True) -> Mount:
    return Mount(parts=[Part(f"part {k}", rate) for k, rate in enumerate(rates)], named=named)


def test_periods_are_those_of_the_parts_the_shortest_first() -> None:
    assert mount(0.01, 0.1).periods_s == [10.0, 100.0] and mount().periods_s == [663.0]


def test_harmonics_are_pairs_of_every_section_that_turned_far_enough() -> None:
    p = problem(300.0, 90.0)
    found = worm.harmonics(p, 0.01, (1, 3))
    first = p.run == 0
    assert found.shape == (len(p.t), 4) and not found[~first].any()
    x = 2 * np.pi * 0.01 * p.t[first]
    assert found[first] == pytest.approx(
        np.column_stack([np.cos(x), np.sin(x), np.cos(3 * x), np.sin(3 * x)])
    )
    assert worm.harmonics(p, 0.0134, (1,)).shape[1] == 4 and worm.harmonics(p, 0.0132, (1,)).shape[1] == 2
    assert worm.harmonics(p, 0.001, (1,)).shape == (len(p.t), 0)
    together = problem(300.0, 90.0, clock=True)
    clocked = worm.harmonics(together, 0.01, (1,))
    assert clocked.shape[1] == 2 and clocked[:, 0] == pytest.approx(np.cos(2 * np.pi * 0.01 * (p.t + 7)))
    assert worm.sections_of(p, 0.02) == 2 and worm.sections_of(p, 0.01) == 1


@pytest.mark.parametrize(
    ("spans", "rate", "seen"),
    [
        ((201.0,), 0.01, True), ((198.0,), 0.01, False), ((150.0, 150.0), 0.01, True),
        ((150.0, 147.0), 0.01, False), ((150.0, 117.0, 117.0), 0.01, False),
        ((150.0, 120.0, 120.0), 0.01, True),
    ],
)  # fmt: skip
def test_a_part_is_seen_over_two_turns_or_three_in_all(
    spans: tuple[float, ...], rate: float, seen: bool
) -> None:
    assert worm.is_seen(problem(*spans), rate) == seen


def test_a_span_is_of_fitted_rows() -> None:
    p = problem(300.0, 90.0, valid=lambda t: (t < 60) | (t > 900))
    assert worm.longest_span(p) == 90.0 and worm.longest_span(replace(p, valid=p.t < -1)) == 0.0


def test_a_part_has_several_numbers_of_harmonics_and_none_of_another_part_s() -> None:
    p, both = problem(900.0), mount(0.01, 0.03)
    found = worm.part_candidates(p, both, both.parts[0], (1, 2, 5))
    assert sorted(c.width // 2 for c in found) == [1, 2, 4, 5]  # the third is the other's turn
    c = found[0]
    assert (c.stage, c.harmonic, c.frequency, c.kind) == ("part 0", 1, 0.01, "line")
    assert c.order == pytest.approx(0.01 * SIDEREAL_DAY_S) and c.labels == (("amplitude", "arcsec"),)
    alone = mount(0.01, 0.03, named=False)
    assert sorted(c.width // 2 for c in worm.part_candidates(p, alone, alone.parts[0], (1, 2, 5))) == [
        1,
        2,
        5,
    ]
    quick = mount(0.06)  # seven frames a turn: up to 0.4 per frame, 0.133 Hz
    assert [c.width // 2 for c in worm.part_candidates(p, quick, quick.parts[0], (1, 2, 5))] == [1, 2]


def test_free_periods_lie_between_two_turns_and_five_frames_and_beside_no_part() -> None:
    p = problem(900.0)
    rates = [c.frequency or 0.0 for c in worm.free_periods(p, mount(), 900.0)]
    assert rates[0] == pytest.approx(2 / 900) and max(rates) < 0.2 / 3 and max(rates) > 0.19 / 3
    assert np.diff(rates) == pytest.approx(0.3 / 900) and len(rates) == int(
        np.ceil((0.2 / 3 - 2 / 900) * 3000)
    )
    beside = [c.frequency or 0.0 for c in worm.free_periods(p, mount(0.01), 900.0)]
    for h in range(1, 9):
        assert min(abs(rate - 0.01 * h) for rate in beside) * 900 > (0.4 if h < 7 else 0.0)
    assert {c.name for c in worm.free_periods(p, mount(0.01), 900.0)} == {UNKNOWN}
    gear = Mount(parts=[Part("gear", 0.01, worm=False)], named=True)
    third = [c.frequency or 0.0 for c in worm.free_periods(p, gear, 900.0)]
    assert min(abs(rate - 0.03) for rate in third) * 900 < 0.4 < min(abs(rate - 0.02) for rate in third) * 900
    assumed = [c.frequency or 0.0 for c in worm.free_periods(p, mount(0.01, named=False), 900.0)]
    assert min(abs(rate - 0.02) for rate in assumed) * 900 < 0.4 and worm.free_periods(p, mount(), 0.0) == []
    long = worm.free_periods(problem(9000.0), mount(), 9000.0)
    assert max(c.frequency or 0.0 for c in long) < 80 / 9000


def test_wrong_worms_have_a_tooth_more_or_less_or_another_period() -> None:
    p = problem(30_000.0)
    columns = worm.harmonics(p, 0.002, (1, 2))
    c = Candidate(
        "gear_eccentricity", "axis_angle", columns, (("amplitude", ""),), frequency=0.002, stage="worm"
    )
    more, less, slow, quick = drift.wrong_worm(p, 0, c)
    rate = 0.002 + 1 / SIDEREAL_DAY_S
    assert more.what == f"one tooth more: {1 / rate:.2f} s" and less.what.startswith("one tooth less: ")
    assert more.columns is not None and np.array_equal(more.columns, worm.harmonics(p, rate, (1, 2)))
    assert slow.what == "wrong period: 555.6 s" and quick.what == "wrong period: 454.5 s"
    assert slow.columns is not None and slow.columns == pytest.approx(worm.harmonics(p, 0.0018, (1, 2)))
    short = drift.wrong_worm(problem(25_000.0), 0, c)
    assert (
        short[0].columns is None and short[0].note == "this log is too short to tell one tooth from the next"
    )
    assert (
        drift.wrong_worm(p, 0, replace(c, stage=None))
        == []
        == drift.wrong_worm(p, 0, replace(c, frequency=None))
    )


def test_an_effect_is_drawn_over_its_phase_or_time() -> None:
    p = problem(300.0)
    c = Candidate(UNKNOWN, "time", np.ones((1, 1)), ())
    assert drift._over(p, p.t, c) == (p.t, "time, s")
    phase, label = drift._over(p, p.t + 5, replace(c, frequency=0.01))
    assert phase == pytest.approx((p.t + 5) * 0.01 % 1) and label == "phase of the period of 100.00 s, turns"


def test_a_time_is_told_as_its_section_s_table_has_it() -> None:
    p = problem(300.0, 90.0)
    one: Any = [Some(name="a.txt", columns={"t": np.array([40.0])})]
    assert drift._when(one, p, 10) == "70 s"
    two: Any = [*one, Some(name="b.txt", columns={"t": np.array([20.0])})]
    assert drift._when(two, p, 101 + 4) == "32 s of b.txt"


def found(span: float, f: Finding, m: Mount, monkeypatch: pytest.MonkeyPatch) -> Finding:
    monkeypatch.setattr(worm, "finding_of", lambda s, k: f)
    s: Any = Some(candidates=[Some(frequency=f.frequency), Some(frequency=None)])
    (told,) = worm.findings(s, m, span)
    return told


def test_neighbours_within_the_resolution_and_an_assumed_wheel_are_noted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    f = Finding("gear_eccentricity", "K", "axis_angle", stage="part 0", frequency=0.01)
    near = mount(0.01, 0.0104)
    assert found(1000.0, f, near, monkeypatch).note == "within this log's resolution also part 1"
    assert found(1300.0, f, near, monkeypatch).note == ""
    assumed = found(1300.0, f, replace(near, named=False), monkeypatch)
    why = "the log names no mount that is known here: the wheel is the usual one that fits"
    assert assumed.note == why and assumed.equivalent == []
    both = found(1000.0, f, replace(near, named=False), monkeypatch)
    assert both.note == f"{why}; within this log's resolution also part 1" and both.equivalent == [UNKNOWN]


def header(name: str) -> Any:
    return [Some(header={"mount": name})]


@pytest.mark.parametrize(
    ("name", "teeth"),
    [
        ("SkyWatcher HEQ5 Pro", (135, 180)), ("EQ6-R", (180,)), ("Astro-Physics 1200", (225,)),
        ("iOptron CEM70", (248,)), ("Losmandy g11", (360,)), ("Advanced VX", (144,)),
        ("Celestron CPC/AVX/", (180, 144)), ("a dobson", ()),
    ],
)  # fmt: skip
def test_a_mount_s_name_tells_its_wheel(name: str, teeth: tuple[int, ...]) -> None:
    assert known_mount(header(name)) == teeth


def test_parts_of_a_mount_have_the_sidereal_day_over_their_teeth() -> None:
    """Of an EQ6: the worm of 180 teeth, and 47 to 12 teeth before it, 122.2 s."""
    one, gear = parts(header("EQ6"), None)
    assert one == Part("worm of a 180-tooth wheel", 180 / SIDEREAL_DAY_S)
    assert gear.name == "transfer gear of 122.2 s" and not gear.worm
    assert gear.rate == pytest.approx(180 * 47 / 12 / SIDEREAL_DAY_S, rel=1e-6)
    both = parts(header("HEQ5"), None)
    assert [p.name for p in both[2:]] == ["transfer gear of 122.2 s"]
    assert len(parts(header("unheard of"), None)) == len(COMMON) and 130 in COMMON and 225 in COMMON
    assert parts(header("CEM70"), None)[0].rate == pytest.approx(248 / SIDEREAL_DAY_S)


def test_a_rig_says_its_own_parts() -> None:
    stages = (Stage("disc", None, 50.0, 1, "encoder_eccentricity"), Stage("worm", None, 400.0, 1, "worm"))
    rig = drive(np.zeros(9), rig={"stages": (*stages, Stage("x", 1.0, None, 1, None))}).view.rig
    disc, own = parts(header("EQ6"), rig)
    assert disc == Part("disc", 0.02, effect="encoder_eccentricity")
    assert own == Part("worm", 0.0025, effect="gear_eccentricity")
