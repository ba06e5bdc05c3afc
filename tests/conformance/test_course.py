"""Counters of a board, and how each is judged: uptime, overruns, errors on the bus, state, sequence."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.conformance.timing import Row, check_course
from bus.protocol import State
from tests.conformance.scripted import told


def course(**signals: list[Any]) -> list[str]:
    """Rows a second apart with these signals."""
    columns = zip(*signals.values(), strict=True)
    rows = [Row(8.0 + k, dict(zip(signals, each, strict=True))) for k, each in enumerate(columns)]
    return told(check_course("X", rows, 0.0))


@pytest.mark.parametrize(
    ("took_s", "first", "last", "uncertainty_s", "level"),
    [
        (3.0, 5, 8, 0.0, "ok"),
        (3.0, 5, 7, 0.0, "ok"),
        (3.0, 5, 9, 0.0, "ok"),
        (3.01, 5, 7, 0.0, "error"),
        (2.99, 5, 9, 0.0, "error"),
        (3.25, 5, 7, 0.25, "ok"),
        (3.26, 5, 7, 0.25, "error"),
        (2.0, 65535, 1, 0.0, "ok"),
        (2.0, 8, 6, 0.0, "error"),
    ],
)
def test_uptime_counts_seconds_and_wraps(
    took_s: float, first: int, last: int, uncertainty_s: float, level: str
) -> None:
    rows = [Row(8.0, {"Uptime": first}), Row(8.0 + took_s, {"Uptime": last})]
    expected = f"{took_s:.2f} s more, ± {1 + uncertainty_s:.3f} s"
    said = f"{level} uptime: X: {expected} | {(last - first) % 65536} s more"
    assert told(check_course("X", rows, uncertainty_s)) == [said]


@given(st.integers(0, 65535), st.lists(st.integers(0, 3), min_size=1, max_size=20))
def test_uptime_is_the_sum_of_what_passed_wherever_it_wraps(start: int, steps: list[int]) -> None:
    readings = [(start + sum(steps[:k])) % 65536 for k in range(len(steps) + 1)]
    (said,) = course(Uptime=readings)
    assert said.endswith(f"| {sum(steps)} s more")
    assert said.startswith("ok") == (abs(sum(steps) - len(steps)) <= 1)


@pytest.mark.parametrize(
    ("signals", "said"),
    [
        ({"Overruns": [7, 7, 7]}, "ok overruns: X: none new | 7 at first, 7 at last"),
        ({"Overruns": [7, 7, 8]}, "error overruns: X: none new | 7 at first, 8 at last"),
        ({"Overruns": [0, 9]}, "error overruns: X: none new | 0 at first, 9 at last"),
        ({"Tec": [0, 96, 3]}, "ok error counter: X: TEC up to 96 | TEC 96"),
        ({"Tec": [97, 96, 3]}, "error error counter: X: TEC up to 96 | TEC 97"),
        ({"State": [State.READY, State.ACTIVE]}, "ok state: X: no FAULT | none"),
        ({"State": [1, 3, 1]}, "error state: X: no FAULT | FAULT"),
        ({"Sequence": [254, 255, 0, 1]}, "ok sequence: X: one more in every frame | steps of 1"),
        ({"Sequence": [4]}, "ok sequence: X: one more in every frame | steps of none"),
        ({"Sequence": [4, 5, 5]}, "error sequence: X: one more in every frame | steps of 0, 1"),
        ({"Sequence": [4, 6, 6]}, "error sequence: X: one more in every frame | steps of 0, 2"),
        ({"Sequence": [4, 5, 7]}, "issue sequence: X: one more in every frame | steps of 1, 2"),
        ({"Sequence": [4, 3]}, "issue sequence: X: one more in every frame | steps of 255"),
        ({"Sequence": [10, 20, 22]}, "issue sequence: X: one more in every frame | steps of 2, 10"),
        ({"Azimuth": [1, 2]}, None),
    ],
)
def test_a_counter_word_by_word(signals: dict[str, list[Any]], said: str | None) -> None:
    assert course(**signals) == ([] if said is None else [said])


def test_all_counters_of_a_frame_are_judged() -> None:
    found = course(Uptime=[1, 2], Overruns=[0, 0], Tec=[0, 0], State=[1, 1], Sequence=[1, 2])
    assert [line.split(":")[0] for line in found] == [
        "ok uptime", "ok overruns", "ok error counter", "ok state", "ok sequence",
    ]  # fmt: skip
    assert course(Uptime=[], Overruns=[]) == []
