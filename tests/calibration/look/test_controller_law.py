"""What is told of a law: gains that held-out rows have, lines above the effort's step, pulses."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide.parameters import interval
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.look import controllerlaw

look: Any = controllerlaw
ROWS, HELD = 600, 60


def law(
    terms: Any, y: Any, gains: tuple[float, ...] = (1.0,), error: float = 1e-3, held: int = HELD,
    base: float = 0.0,
) -> Any:  # fmt: skip
    """A command whose fitted gains leave y; the last rows are held out."""
    label = np.zeros(ROWS, dtype=np.int64)
    p = Problem(
        channel="S", unit="V", y=np.zeros(ROWS) + y, base=np.full((ROWS, 1), base), base_labels=[("o", "V")],
        t=np.arange(0.0, ROWS) / 100, run=label, session=label, valid=label == 0,
        held=np.arange(ROWS) >= ROWS - held, period_s=0.01,
    )  # fmt: skip
    x = np.zeros((ROWS, len(gains))) + terms
    sizes = [Some(value=g, error=error) for g in gains]
    labels = [("gain_p", "V/m"), ("gain_d", "V s/m")][: len(gains)]
    return Some(problem=p, terms=x, gains=np.array(gains), sizes=sizes, labels=labels)


END = (np.arange(ROWS) >= ROWS - HELD).astype(float)[:, None]
FEWER = np.roll(END, 1) * END
RANDOM = np.random.default_rng(3).standard_normal((ROWS, 2))
NOISE = np.random.default_rng(4).standard_normal(ROWS)
SMALL = {"gain_p": 2.0, "gain_d": 1.0}


@pytest.mark.parametrize(
    ("command", "declared", "told"),
    [
        (law(END, 0.1), {"gain_p": 9.0}, 1),  # held-out rows alone tell it
        (law(FEWER, 0.1, held=59), {"gain_p": 9.0}, 0),  # fewer than sixty are not asked
        (law(np.ones((ROWS, 1)) - END, 0.1), {"gain_p": 9.0}, 0),
        (law(RANDOM[:, :1], 5.0 + 0.01 * NOISE, base=1.0), {"gain_p": 2.0}, 1),  # beside an offset
        (law(RANDOM[:, :1], 0.5 * RANDOM[:, 0]), {"gain_p": 0.5}, 1),  # 1.0 t is left, of 0.5 t
        (law(RANDOM[:, :1], 0.5 * RANDOM[:, 0]), {"gain_p": 2.0}, 0),
        (law(RANDOM, 0.5 * NOISE, (2.0, 1.03)), SMALL, 0),  # no better than by luck
        (law(RANDOM, 0.0, (2.0, 1.0)), SMALL, 0),
        (law(1.0, -1.0, (3.0,)), {"gain_p": 4.0}, 1),  # a square has no sign
    ],
)  # fmt: skip
def test_gains_are_others_where_held_rows_leave_a_tenth_less(
    command: Any, declared: dict[str, float], told: int
) -> None:
    assert len(look._others(command, declared)[0]) == told


@pytest.mark.parametrize(
    ("gain", "error", "told", "found"),
    [
        (51.0, 1e-3, 1, 0),  # just two hundredths
        (50.9, 1e-3, 0, 0),
        (51.0, 0.2, 1, 0),  # just five errors
        (51.0, 0.21, 0, 0),
        (60.0, 1e-3, 1, 0),  # just a fifth
        (60.1, 1e-3, 1, 1),
        (39.9, 1e-3, 1, 1),
    ],
)
def test_a_gain_is_told_from_two_hundredths_and_found_from_a_fifth_on(
    gain: float, error: float, told: int, found: int
) -> None:
    said, other = look._others(law(RANDOM[:, :1], 1e-3 * NOISE, (gain,), error), {"gain_p": 50.0})
    assert (len(said), len(other)) == (told, found)
    assert all(f.share == 1.0 and f.domain == "command" and f.channel == "S" for f in other)


@pytest.mark.parametrize(
    ("f", "domain", "note"),
    [
        (Finding(UNKNOWN, "S", "time"), "command", look.BEFORE),
        (Finding(UNKNOWN, "S", "reference"), "command", look.FORWARD),
        (Finding("command_disturbance", "S", "time"), "time", look.BEFORE),
        (Finding(UNKNOWN, "S", "reference", note="told"), "command", "told"),
    ],
)
def test_a_finding_of_a_law_has_the_plant_s_domain_and_a_note(f: Finding, domain: str, note: str) -> None:
    told = look._of_the_law(f)
    assert (told.domain, told.note) == (domain, note)


@pytest.mark.parametrize("unknown", [True, False])
def test_a_law_has_its_gains_and_what_it_does_not_explain(
    monkeypatch: pytest.MonkeyPatch, unknown: bool
) -> None:
    c = law(RANDOM, NOISE, (2.0, 3.0), 0.5)
    c.follows = RANDOM
    wave = look.Candidate("w", "time", RANDOM, (("a", "N"), ("b", "N")), twins=("x",))
    offered: Any = []
    first = Finding(UNKNOWN if unknown else "command_disturbance", "S", "time")
    other = Finding(UNKNOWN, "S", "command", note="another gain")
    monkeypatch.setattr(look, "command_of", lambda view, balance, law: c)

    def lines(scene: Any, driven: Any) -> Any:
        assert scene.wander.shape == (ROWS, 0) and driven == pytest.approx(RANDOM @ [2.0, 3.0])
        return [wave]

    def select(p: Any, some: Any) -> Any:
        offered.extend(some)
        return Some(chosen=[1])

    monkeypatch.setattr(look, "lines", lines)
    monkeypatch.setattr(look, "changed_below", lambda c: ["below"])
    monkeypatch.setattr(look, "_forward", lambda view, c: "forward")
    monkeypatch.setattr(look, "select", select)
    monkeypatch.setattr(look, "findings_of", lambda s, k: [first])
    monkeypatch.setattr(look, "declared_terms", lambda law: {"gain_p": 1.0})
    monkeypatch.setattr(look, "_others", lambda c, declared: (["said"], [other]))
    b = look.look_at_law(Some(rig=Some(controller="law")), None)
    assert offered[1:] == ["below", "forward"]
    assert (offered[0].labels, offered[0].twins) == ((("amplitude", "V"),), ())
    assert [f.note for f in b.findings] == [look.BEFORE, *([] if unknown else ["another gain"])]
    assert (b.key, b.row, b.remarks) == ("U", "command", [] if unknown else ["said"])
    low, high = interval(2.0, 0.5, c.problem.blocks, 0.0)  # of the log alone
    assert b.numbers["gain_p"] == Parameter(2.0, "V/m", low, high) and low == pytest.approx(4 - high)
    assert b.numbers["gain_d"].unit == "V s/m"
    assert look.look_at_law(Some(rig=Some(controller=None)), None) is None


def channel(monkeypatch: pytest.MonkeyPatch, *looks: Any, floor: float = 1.0, pulse: Any = None) -> Any:
    """The result of selections that are made in turn, how often it was selected, and what was collected."""
    p = Some(floor=floor)
    each, asked = iter(looks), []

    def select(p: Any, some: Any, rng: Any, margin: float = 0.0) -> Any:
        asked.append((list(some), margin))
        return next(each)

    monkeypatch.setattr(look, "incremental_law", lambda *_: Some(problem=p))
    monkeypatch.setattr(look, "_lines_of_steps", lambda p: ["line"])
    monkeypatch.setattr(look, "changed_below", lambda law: ["below"])
    monkeypatch.setattr(look, "select", select)
    monkeypatch.setattr(look, "pulses", lambda p, residual: pulse)
    got: Any = []
    result = Some(frame=None, held=None, declared=Some(own=None), rng=None, selections={}, findings=[],
                  collect=got.append)  # fmt: skip
    look.command_channel(result)
    return result, asked, got


def selected(name: str = "", kind: str = "smooth", before: float = 9.0, sizes: Any = ()) -> Any:
    some = [Some(name=name, kind=kind)] if name else []
    return Some(chosen=some, candidates=some, held=Some(before=before), after=Some(residual=None),
                sizes=lambda k: np.array(sizes, dtype=float))  # fmt: skip


@pytest.mark.parametrize(
    ("name", "before", "floor", "again"),
    [
        (UNKNOWN, 1.2, 1.0, False),  # just a fifth more than rounding
        (UNKNOWN, 1.19, 1.0, True),
        (UNKNOWN, 0.61, 0.5, False),
        ("command_disturbance", 1.0, 1.0, False),
        ("", 1.0, 1.0, False),
    ],
)
def test_a_law_of_its_own_is_above_rounding(
    monkeypatch: pytest.MonkeyPatch, name: str, before: float, floor: float, again: bool
) -> None:
    first, second = selected(name, before=before), selected()
    result, asked, got = channel(monkeypatch, first, second, floor=floor)
    assert asked == [(["line", "below"], look.NOISE_SHARE), *([([], 0.0)] if again else [])]
    kept = second if again else first
    assert result.selections == {"U": kept} and got == [kept] and result.findings == []


@pytest.mark.parametrize(
    ("kind", "sizes", "told"),
    [
        ("line", (0.48, 0.64), False),  # 0.8 steps of the effort
        ("line", (0.48, 0.65), True),
        ("line", (0.1, 0.1, 0.0, 0.81), True),  # of the largest run
        ("smooth", (0.1, 0.1), True),
    ],
)
def test_a_line_on_the_command_is_larger_than_the_effort_s_step(
    monkeypatch: pytest.MonkeyPatch, kind: str, sizes: Any, told: bool
) -> None:
    s = selected("command_disturbance", kind, sizes=sizes)
    result, _, got = channel(monkeypatch, s, pulse=Finding("pulses", "S", "time"))
    assert got == ([s] if told else []) and result.selections == {"U": s}
    assert [f.name for f in result.findings] == ["pulses"]


def test_an_axis_without_a_law_has_no_command_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(look, "incremental_law", lambda *_: None)
    result = Some(frame=None, held=None, declared=Some(own=None), selections={}, findings=[])
    look.command_channel(result)
    assert result.selections == {} and result.findings == []
