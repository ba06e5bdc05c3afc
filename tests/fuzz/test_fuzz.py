"""Ten thousand hostile inputs at every door, reader and pin: accepted or refused, all boards still tick."""

import pytest

from tests.fuzz.doors import ALONE, DOORS, attack

INPUTS = 10_000


@pytest.mark.slow
@pytest.mark.timeout(300)
@pytest.mark.parametrize("door", [*DOORS, *ALONE])
def test_a_door_takes_or_refuses_whatever_comes(door: str) -> None:
    found = attack(door, INPUTS)
    assert found["accepted"] > INPUTS // 1000, "the inputs are too far from anything that is understood"
    assert sum(found.values()) >= INPUTS * 0.95, "the others are error frames, which a door passes over"


@pytest.mark.parametrize("door", [*DOORS, *ALONE])
def test_a_few_of_them_in_every_run(door: str) -> None:
    assert sum(attack(door, 300, seed=2).values()) >= 270
