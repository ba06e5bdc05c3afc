"""The torque and the volts of an axis: what is looked at again, what volts deny, what currents make."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.look import torque, volts
from calibration.names.adc_offset import NAME as OFFSET

look: Any = torque
meter: Any = volts


class Rows(Some):
    """A balance of rows that fits nothing."""

    def add(self, *terms: Any) -> None:
        self.added = [name for name, _, _ in terms]

    def fit(self, x: Any = None) -> Any:
        return Some(residual=np.zeros(len(self.y)), x=x)


def rows(n: int = 800, valid: Any = None, held: Any = None) -> Any:
    train = np.ones(n, dtype=bool) if held is None else ~held
    return Rows(y=np.zeros(n), valid=np.ones(n, dtype=bool) if valid is None else valid, train=train,
                test=~train, added=[])  # fmt: skip


def chosen(*some: Any, left: float = 1.0, after: float = 1.0) -> Any:
    return Some(fitted=[(c, np.array([2.0])) for c in some], candidates=list(some), chosen=list(some),
                fitted_square=left, held=Some(after=after), after=Some(residual="residual"))  # fmt: skip


def candidate(name: str, order: float | None = None) -> Any:
    return Some(name=name, key=name, order=order, say=lambda: name, columns=np.ones((800, 1)))


def passed(
    monkeypatch: pytest.MonkeyPatch, p: Any, *names: str, findings: Any = (), electrical: Any = None,
    kinematic: Any = None, denied: Any = (), pair: Any = None, afters: Any = (1.0, 1.0), speed: float = 2e-5,
) -> tuple[Any, Any, Any, Any]:  # fmt: skip
    """One pass over these names: the result, the selection, its rows; and what was selected from."""
    asked: Any = []
    offered = [candidate(n) for n in names]
    cancelled = iter([pair])
    lefts = iter(afters)

    def select(p: Any, some: Any, rng: Any) -> Any:
        asked.append([c.name for c in some])
        return chosen(*some, after=next(lefts) if len(asked) > 1 and pair else 9.0)

    result = Some(motion=Some(speed=np.full(900, speed), rows=np.arange(800)), findings=list(findings),
                  electrical=electrical, kinematic=kinematic, views={},
                  refused=[("T", "old", "why")], rng=None)  # fmt: skip
    monkeypatch.setattr(look, "scene_of_pair", lambda *_: Some(view="view"))
    monkeypatch.setattr(look, "offered", lambda scene: offered)
    monkeypatch.setattr(look, "_of_a_gear", lambda c, found: c.name == "gear")
    monkeypatch.setattr(look, "select", select)
    monkeypatch.setattr(look, "volts_deny", lambda result, c, size: size == 2.0 and c.name in denied)
    monkeypatch.setattr(look, "cancelling", lambda s: next(cancelled, None))
    monkeypatch.setattr(look, "beside_a_stage", lambda s, scene: s)
    s, whole, moving = look._pass(result, Some(problem=p))
    assert result.views == {"T": "view"}
    return result, s, (whole, moving), asked


def test_a_pass_offers_what_no_gear_and_no_volts_have_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    held = np.arange(800) >= 600
    p = rows(held=held)
    _, _, _, asked = passed(monkeypatch, p, "ripple", "gear", OFFSET.name)
    assert asked == [["ripple", OFFSET.name]] and p.added == []
    p = rows(held=held)
    offset = Finding(OFFSET.name, "E", "current")
    _, _, _, asked = passed(monkeypatch, p, "ripple", OFFSET.name, findings=[offset], electrical="volts")
    assert asked == [["ripple"]] and p.added == ["offset_torque"]


@pytest.mark.parametrize(
    ("train", "test", "speed", "looked"),
    [
        (301, 101, 1.6e-5, True), (300, 101, 1.6e-5, False), (301, 100, 1.6e-5, False),
        (301, 101, 1.5e-5, False), (301, 101, -1.6e-5, True),
    ],
)  # fmt: skip
def test_too_little_sliding_tells_no_torque(
    monkeypatch: pytest.MonkeyPatch, train: int, test: int, speed: float, looked: bool
) -> None:
    """More than 300 rows to fit and 100 held out, quicker than 3 arcsec/s, in which teeth touch."""
    at = np.arange(800)
    engaged = (at < train) | (at >= 800 - test)
    p = rows(held=at >= 400)
    _, _, (whole, moving), asked = passed(
        monkeypatch, p, "ripple", kinematic=Some(engaged=engaged), speed=speed
    )
    assert asked == [["ripple"] if looked else []] and np.array_equal(whole, engaged)
    assert np.array_equal(moving, engaged & (abs(speed) > 1.5e-5))
    assert np.array_equal(p.valid, moving if looked else engaged)


def test_what_volts_deny_is_not_selected_and_said_once(monkeypatch: pytest.MonkeyPatch) -> None:
    p = rows(held=np.arange(800) >= 600)
    result, s, _, asked = passed(monkeypatch, p, "b", "a", "c", denied=("a", "b"))
    assert asked == [["b", "a", "c"], ["c"]] and [c.name for c in s.candidates] == ["c"]
    assert result.refused == [("T", "old", "why"), ("T", "a", look.DENIED), ("T", "b", look.DENIED)]


@pytest.mark.parametrize(("afters", "gone", "stays"), [((1.0, 2.0), "a", "b"), ((2.0, 1.0), "b", "a")])
def test_of_two_that_cancel_the_one_that_leaves_less_stays(
    monkeypatch: pytest.MonkeyPatch, afters: tuple[float, float], gone: str, stays: str
) -> None:
    p = rows(held=np.arange(800) >= 600)
    result, s, _, asked = passed(monkeypatch, p, "x", "a", "b", pair=(1, 2), afters=afters)
    assert asked == [["x", "a", "b"], ["x", "b"], ["x", "a"]]
    assert [c.name for c in s.candidates] == ["x", stays]
    assert result.refused[1:] == [("T", gone, f"cancels against {stays}")]


NUMBERS = {n: Some(value=2.0) for n in ("coulomb", "viscous", "stiction")}


def channel(
    monkeypatch: pytest.MonkeyPatch, *, first: Any, second: Any = None, blocks: int = 20, blowing: Any = None,
    findings: Any = (), exponent: float = 1.0, numbers: Any = None, used: int = 800,
) -> tuple[Any, dict[str, Any]]:  # fmt: skip
    """The torque channel over given passes: its result, and what was asked."""
    asked: dict[str, Any] = {"passes": 0}
    n = 1000
    valid = np.zeros(n, dtype=bool)
    valid[:used] = True
    moving = np.zeros(n, dtype=bool)
    moving[50] = True

    def torque_problem(m: Any, drive: Any, held: Any, declared: Any, beside: Any = None) -> Any:
        asked["beside"] = None if beside is None else beside.shape
        p = Some(blocks=blocks, block=40, train=valid, name="again" if beside is not None else "first")
        return Some(problem=p, friction=Some(coulomb=3.0, viscous=4.0), name=p.name)

    def one_pass(result: Any, torque: Any) -> Any:
        asked["passes"] += 1
        return (first if torque.name == "first" else second), np.ones(n, dtype=bool), moving

    def everything(p: Any, valid: Any) -> Any:
        asked["valid"] = valid
        train = valid if exponent < 1 else np.arange(n) < used
        return Some(train=train, design=lambda some: np.ones((n, 1)), fit=lambda x: "fit")

    monkeypatch.setattr(look, "torque_problem", torque_problem)
    monkeypatch.setattr(look, "_pass", one_pass)
    monkeypatch.setattr(look, "replace", everything)
    monkeypatch.setattr(look, "white_noise", lambda *_: None)
    monkeypatch.setattr(look, "wind", lambda *_: blowing)
    monkeypatch.setattr(look, "beside_wind", lambda f: f.name == "strong")
    monkeypatch.setattr(look, "carried", lambda fit, x, train, block: (fit, np.full(x.shape[1], block)))
    monkeypatch.setattr(look, "seen_speeds", lambda rate, declared: asked.update(seen=len(rate)))
    given = NUMBERS if numbers is None else numbers
    monkeypatch.setattr(look, "calibrated_numbers", lambda *_: (given, {
        "coulomb": Parameter(2.0, "N m"), "viscous": Parameter(0.0, "N m s"),
        "inertia": Parameter(1.0, "kg m2"),
    }))  # fmt: skip
    changed = Finding("coulomb_change", "T", "time")
    monkeypatch.setattr(look, "changes", lambda *_: [changed])
    monkeypatch.setattr(look, "telling", lambda found, *_: found)

    def retold(f: Finding, quotients: Any) -> Finding:
        asked["quotients"] = quotients
        return f.noted("retold")

    monkeypatch.setattr(look, "NAMES", dict.fromkeys(
        ("worm", "coulomb_change", "strong", "wind_torque", UNKNOWN), Some(retold=retold)
    ))  # fmt: skip
    result = Some(motion=Some(speed=np.zeros(n), rows=np.arange(n), cell_s=0.5), held=None, selections={},
                  declared=Some(stribeck_exponent=exponent), findings=list(findings), calibrated={"k": 1},
                  scale_error=0.0)  # fmt: skip
    result.collect = lambda s: asked.update(collected=s)
    look.torque_channel(result, None)
    return result, asked


WORM, STRONG = Finding("worm", "T", "time"), Finding("strong", "T", "time")
OTHER = Finding("other", "K", "time")


def test_what_is_found_is_fitted_again_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = chosen(candidate("a"), candidate("b"), left=2.0), chosen(left=1.9)
    result, asked = channel(monkeypatch, first=one, second=two, findings=[OTHER])
    assert asked["passes"] == 2 and asked["beside"] == (800, 2)
    assert result.selections == {"T": two} and result.torque.name == "again" and asked["collected"] is two
    worse, _ = channel(monkeypatch, first=one, second=chosen(left=2.0))
    assert worse.selections["T"] is one and worse.torque.name == "first"
    alone, asked = channel(monkeypatch, first=chosen())
    assert asked["passes"] == 1 and alone.calibrated["k"] == 1 and len(alone.calibrated) == 4
    assert [(f.name, f.note) for f in result.findings] == [("other", ""), ("coulomb_change", "retold")]
    assert asked["quotients"] == {"coulomb": 1.5}  # of 3 to 2; a viscous friction of nothing has none
    monkeypatch.setattr(look, "torque_problem", lambda *_: None)
    none = Some(motion=None, held=None, declared=None, selections={})
    look.torque_channel(none, None)
    assert none.torque is None and none.selections == {}


@pytest.mark.parametrize(
    ("blowing", "some", "blocks", "told"),
    [
        ("wind_torque", 1, 20, True),
        ("wind_torque", 1, 19, False),  # too few blocks to tell
        (UNKNOWN, 1, 20, False),
        (UNKNOWN, 0, 20, True),
    ],
)
def test_a_wind_stands_beside_strong_effects_alone(
    monkeypatch: pytest.MonkeyPatch, blowing: str, some: int, blocks: int, told: bool
) -> None:
    s = chosen(*[candidate("a")] * some)
    result, _ = channel(monkeypatch, first=s, second=s, blocks=blocks, findings=[WORM, STRONG, OTHER],
                        blowing=Finding(blowing, "T", "time"), numbers={})  # fmt: skip
    kept = ["strong", "other", blowing] if told else ["worm", "strong", "other"]
    assert [f.name for f in result.findings] == kept


@pytest.mark.parametrize(
    ("numbers", "blocks", "used", "changed"),
    [
        (None, 20, 800, True),  # 20 blocks of 40 rows
        (None, 20, 799, False),
        (None, 19, 800, False),
        ({**NUMBERS, "coulomb": Some(value=0.0)}, 20, 800, False),
        ({k: v for k, v in NUMBERS.items() if k != "stiction"}, 20, 800, False),
        ({**NUMBERS, "inertia": Some(value=1.0)}, 20, 800, True),
    ],
)
def test_numbers_change_where_friction_is_known_from_rows_enough(
    monkeypatch: pytest.MonkeyPatch, numbers: Any, blocks: int, used: int, changed: bool
) -> None:
    result, _ = channel(monkeypatch, first=chosen(), numbers=numbers, blocks=blocks, used=used)
    assert [f.name for f in result.findings] == ["coulomb_change"] * changed


@pytest.mark.parametrize(("exponent", "about"), [(1.0, 6), (2.0, 6), (0.9, 0)])
def test_rests_beside_a_motion_are_calibrated_on(
    monkeypatch: pytest.MonkeyPatch, exponent: float, about: int
) -> None:
    """Three seconds of half a second a row."""
    _, asked = channel(monkeypatch, first=chosen(), exponent=exponent)
    assert np.flatnonzero(asked["valid"]).tolist() == list(range(50 - about, 51 + about))


def kept(part: float, motor: float = 0.0, doubt: float = 0.0) -> Any:
    """An effect that leaves a part of the torque constant, of one motor or of both."""
    return Some(name=f"x{part}", fixed={"motor": (motor, "")} if motor else {}, part=part, doubt=doubt)


def _part(c: Any, size: float, clock: Any, quotient: float) -> Any:
    return np.full(len(clock), c.part * size * quotient)


def names(monkeypatch: pytest.MonkeyPatch, *some: Any, of_constant: bool = True) -> None:
    monkeypatch.setattr(meter, "NAMES", {
        c.name: Some(
            torque_kept=None if c.part == 0 else _part,
            torque_doubt=c.doubt, beside=Some(of_constant=of_constant),
        ) for c in some
    })  # fmt: skip


def test_currents_make_torque_of_what_effects_leave(monkeypatch: pytest.MonkeyPatch) -> None:
    both, first, second, none = kept(0.9), kept(0.8, 1.0), kept(0.5, 2.0), kept(0.0)
    names(monkeypatch, both, first, second, none)
    one = np.array([1.0])
    left = meter.weakened([(both, one), (first, one), (second, one), (none, one)], np.zeros(2))
    assert left["a"] == pytest.approx([0.72, 0.72]) and left["b"] == pytest.approx([0.45, 0.45])
    turned = meter.weakened([(first, np.array([0.5]))], np.zeros(1), 2.0)
    assert turned["a"] == pytest.approx([0.8]) and turned["b"] == pytest.approx([1.0])


def test_a_reading_s_gain_is_an_error_of_all_torques(monkeypatch: pytest.MonkeyPatch) -> None:
    sure, doubtful = kept(0.9), kept(0.8, doubt=0.5)
    names(monkeypatch, sure, doubtful)
    assert meter.reading_error([(sure, np.array([9.0])), (doubtful, np.array([-0.2]))]) == pytest.approx(0.1)
    assert meter.reading_error([]) == 0.0


@pytest.mark.parametrize(
    ("error", "of_constant", "denied"),
    [(0.0039, True, True), (0.004, True, False), (0.0, True, False), (0.0039, False, False)],
)
def test_volts_deny_a_loss_of_twenty_five_errors(
    monkeypatch: pytest.MonkeyPatch, error: float, of_constant: bool, denied: bool
) -> None:
    """A tenth is lost: less than 25 of 0.004, and more than of 0.0039."""
    c = kept(0.9)
    names(monkeypatch, c, of_constant=of_constant)
    result = Some(constant_error=error, frame=Some(one_clock=np.zeros(3)))
    assert meter.volts_deny(result, c, 1.0) == denied


def electrical(
    monkeypatch: pytest.MonkeyPatch, *, fitted: int = 201, spread: float = 0.02, ripple: Any = None,
    current: bool = True, balance: bool = True,
) -> tuple[Any, Any, list[str]]:  # fmt: skip
    """Volts of a constant of 0.05 that is declared as 0.04; what is fitted is 0.2."""
    said: Any = []
    estimates = {"torque_constant": Some(value=0.2, error=spread), "resistance": Some(value=2.0)}
    p = Some(train=np.ones(fitted, dtype=bool), fit=lambda: Some(residual=None), named=lambda fit: estimates)
    b = Some(problem=p, windings=Some(resistance=3.0, constant=0.05)) if balance else None
    frame = Some(one_clock=np.zeros(2), scale={"gear_ratio": 10.0}, get=lambda name: 1 if current else None)
    s = Some(after=None, fitted=["fitted"])
    for name, made in (
        ("undo_sampling", lambda frame, ripple: said.append(f"ripple {ripple}")),
        ("wind_up", lambda *_: None), ("electrical_problem", lambda *_: b),
        ("scene_of_balance", lambda pair, *_: Some(view="view", motor=pair.motor)),
        ("select", lambda p, some, rng, around: s if around else None), ("offered", lambda scene: [scene]),
        ("mean_currents", lambda *_: said.append("mean")), ("reading_error", lambda fitted: 0.3),
        ("weakened", lambda fitted, clock, q=1.0: (fitted, q)),
    ):  # fmt: skip
        monkeypatch.setattr(meter, name, made)
    result = Some(frame=frame, motion=Some(rows=np.arange(3)), held=None, rng=None, views={}, selections={},
                  declared=Some(ripple=ripple, torque_constant=0.04), constant_error=0.0,
                  scale_error=0.0)  # fmt: skip
    result.collect = lambda s, quotient: said.append(quotient)
    return result, meter.electrical_channel(result), said


def test_volts_tell_the_constant_where_they_are_sure(monkeypatch: pytest.MonkeyPatch) -> None:
    result, (per_ampere, left), said = electrical(monkeypatch, ripple=5)
    assert per_ampere == pytest.approx(2.0) and left == (["fitted"], pytest.approx(0.25))
    assert said == ["ripple 5", "mean", {"resistance": 1.5, "torque_constant": pytest.approx(0.25)}]
    assert result.constant_error == pytest.approx(0.1) and result.views == {"E": "view"}
    assert result.scale_error == pytest.approx(np.hypot(0.1, 0.3))
    unsure, (per_ampere, left), said = electrical(monkeypatch, spread=0.021, ripple=5, current=False)
    assert per_ampere == pytest.approx(0.4) and left == (["fitted"], 1.0) and said[0] == "mean"
    assert unsure.constant_error == 0.0 and unsure.scale_error == pytest.approx(0.3)


def test_too_few_volts_tell_no_constant(monkeypatch: pytest.MonkeyPatch) -> None:
    few, (per_ampere, left), said = electrical(monkeypatch, fitted=200)
    assert per_ampere == pytest.approx(0.5) and left == ([], 1.0) and said == [] and few.selections == {}
    _, (per_ampere, _), _ = electrical(monkeypatch, balance=False)
    assert per_ampere == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("floor", "step", "sure", "constant", "signs"),
    [
        (0.3, 0.1, 0.3, 4.0, []),
        (0.3, 0.5, 0.5, 4.0, []),  # less than its meters are sure to
        (None, 0.5, None, 4.0, []),
        (0.3, 0.1, 0.3, -4.0, ["torque_constant comes out as -4: the position counts the other way"]),
    ],
)
def test_volts_of_a_rig_are_told_with_their_floor_and_signs(
    monkeypatch: pytest.MonkeyPatch, floor: Any, step: float, sure: Any, constant: float, signs: list[str]
) -> None:
    """A resistance of 9 ohm that is 4 beside what was found: of the heat the root of 9 / 4."""
    declared = {"resistance": 9.0, "torque_constant": constant, "offset": 0.0}
    final = {"resistance": 4.0, "torque_constant": 2.0, "offset": 1.0}
    asked: dict[str, Any] = {}
    p = Some(train="train", y=np.zeros(3), step=step, by_name=lambda beta: final,
             plain_fit=lambda rows: (declared, np.ones(3)))  # fmt: skip
    b = Some(problem=p, windings="windings", floor=floor, floor_from="meters")
    s = Some(chosen=["one"], after=Some(beta=None))
    first, more = Finding("winding_heating", "E", "time"), Finding("more", "E", "time")

    def retold(f: Finding, quotients: dict[str, float]) -> Finding:
        asked["quotients"] = quotients
        return f.noted("retold")

    def left_over(of: Any, scene: Any, at: Any) -> Any:
        asked.setdefault("left", []).append(at)
        return "left" if of == "together" else "alone"

    for name, made in (
        ("volts_balance", lambda view, balance: b), ("replace", lambda view, response: response),
        ("Scene", lambda view, p, known, left, wander, windings: Some(shape=wander.shape)),
        ("offered", lambda scene: [scene]), ("select", lambda p, some, around: (some, around)),
        ("signed", lambda given: s if given[1] and given[0][0].shape == (3, 0) else None),
        ("leave_out", lambda s, rule: s), ("beyond_names", lambda s, scene: (s, "together", [more])),
        ("NAMES", {"winding_heating": Some(retold=retold)}), ("findings_of", lambda s, k: [first]),
        ("settle", lambda found, left, key: [*found, left, key]), ("left_over", left_over),
        ("calibrated", lambda s: {"resistance": 1}), ("lacking_names", lambda scene, kind: [f"lacks {kind}"]),
    ):  # fmt: skip
        monkeypatch.setattr(meter, name, made)
    found = meter.look_at_volts("view", "balance")
    assert (found.key, found.row, found.selection, found.floor) == ("E", "electrical", "together", floor)
    assert [getattr(f, "name", f) for f in found.findings] == ["winding_heating", "more", "alone", "E"]
    assert found.findings[0].note == "retold" and found.missing == "left" and asked["left"] == [sure, sure]
    wanted = {"resistance": 1.5} | ({"torque_constant": 2.0} if constant > 0 else {})
    assert asked["quotients"] == pytest.approx(wanted)
    assert found.notes == ["floor of the volts: meters", *signs, "lacks volts"]
    monkeypatch.setattr(meter, "volts_balance", lambda view, balance: None)
    assert meter.look_at_volts("view", "balance") is None
