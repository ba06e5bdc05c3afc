"""The focus board on a motor with currents and an LVDT with its carrier: the same frames; lost steps."""

import pytest

from bus.protocol import FocusFlag, Health, Opcode, Result, unpack_focus
from tests.boards.focus import test_board
from tests.boards.focus.test_board import Bench
from tests.plant.lvdt import CarrierLvdt
from tests.plant.stepper import MOTOR, MotorFocusPort


def bench(monkeypatch: pytest.MonkeyPatch, start: float) -> Bench:
    """The board's bench with the other motor and transducer."""
    monkeypatch.setattr(test_board, "FocusPort", MotorFocusPort)
    made = Bench(start)
    made.board.adc.pin = CarrierLvdt(made.port.lvdt)
    return made


def moved(made: Bench) -> list[tuple[int, int, int]]:
    """Position, encoder and LVDT of FOCUS at rest, after referencing and after each of some moves."""
    seen = []
    made.run(0.2)
    assert made.command(Opcode.FOCUS_REFERENCE).result == Result.OK
    made.run(6.0)
    for target in (0, -120, 333, 40):
        assert made.command(Opcode.FOCUS_MOVE_TO, target).result == Result.OK
        made.run(3.0)
        frame = unpack_focus(made.last)
        assert frame.flags & FocusFlag.REFERENCED and not frame.flags & FocusFlag.MOVING
        seen.append((frame.position, frame.encoder, frame.lvdt))
    return seen


@pytest.mark.slow
def test_P11_P12_both_motors_and_transducers_give_the_same_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    fast = moved(Bench(16.0))
    full = moved(bench(monkeypatch, 16.0))
    assert [each[0] for each in full] == [each[0] for each in fast]
    for (_, encoder, lvdt), (_, fast_encoder, fast_lvdt) in zip(full, fast, strict=True):
        assert abs(encoder - fast_encoder) <= 1  # friction leaves the rotor 0.04 half steps off: 0.2 counts
        assert abs(lvdt - fast_lvdt) <= 1


@pytest.mark.slow
def test_P11_a_load_beyond_pull_out_costs_steps_and_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = bench(monkeypatch, 16.0)
    made.run(0.2)
    made.command(Opcode.FOCUS_REFERENCE)
    made.run(6.0)
    assert made.command(Opcode.PING).value == 0
    assert isinstance(made.port, MotorFocusPort)
    made.port.motor.load = 0.9 * MOTOR.holding
    made.command(Opcode.FOCUS_MOVE_TO, 200)
    made.run(3.0)
    assert made.truth < 190
    assert made.command(Opcode.PING).value & Health.SENSOR
