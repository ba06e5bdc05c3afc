"""The axis board beside its plant, its power on."""

import pytest

from bus.protocol import Opcode, Result
from tests.boards.lab import Lab


@pytest.fixture
def lab() -> Lab:
    lab = Lab()
    lab.run(0.1)
    assert lab.command(Opcode.POWER, 1).result == Result.OK
    return lab
