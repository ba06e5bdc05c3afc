"""Ten thousand hostile inputs at every door, reader and pin: accepted or refused, all boards still tick."""

import pytest

from tests.fuzz.doors import ALONE, DOORS, attack, attack_apart

INPUTS = 10_000


def _attack(door: str, count: int, seed: int = 1) -> dict[str, int]:
    return (attack_apart if door == "websocket" else attack)(door, count, seed)


@pytest.mark.slow
@pytest.mark.timeout(300)
@pytest.mark.parametrize("door", [*DOORS, *ALONE])
def test_a_door_takes_or_refuses_whatever_comes(door: str) -> None:
    found = _attack(door, INPUTS)
    assert found["accepted"] > INPUTS // 1000, "the inputs are too far from anything that is understood"
    assert sum(found.values()) >= INPUTS * 0.95, "the others are error frames, which a door passes over"


@pytest.mark.parametrize("door", [*DOORS, *ALONE])
def test_a_few_of_them_in_every_run(door: str) -> None:
    assert sum(_attack(door, 300, 2).values()) >= 270
