"""Rates that bring an axis to a place, however rarely they are taken."""

import pytest

from bus.time import generator
from host.procedures.autoguide import TICK_S, Shifting


def went(gaps_s: list[float], wanted: float) -> tuple[list[float], list[float]]:
    """Places after every command and rates, of a drive that does what it is told until it is told anew."""
    shifting, made, t_s = Shifting(0.0, 0.0), 0.0, 0.0
    places, rates = [], []
    for gap_s in gaps_s:
        rates.append(shifting.rate(wanted, t_s))
        t_s += gap_s
        made += rates[-1] * gap_s
        places.append(made)
    return places, rates


def test_a_command_each_tick_is_there_within_one() -> None:
    places, _ = went([TICK_S] * 3, 2.0)
    assert places == pytest.approx([2.0] * 3)


@pytest.mark.parametrize("ticks", [(2.2, 3.0), (1.2, 4.5), (4.0, 6.0)])
def test_late_commands_do_not_run_away(ticks: tuple[float, float]) -> None:
    gaps = [float(each) * TICK_S for each in generator(1, "gaps").uniform(*ticks, 200)]
    places, rates = went(gaps, 2.0)
    assert max(abs(each) for each in places) < 2.0 * 2 * max(ticks)
    assert places[-1] == pytest.approx(2.0, abs=0.01) and abs(rates[-1]) < 0.1
