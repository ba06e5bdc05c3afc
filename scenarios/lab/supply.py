"""The supplies behind the power boards: which boards hang on which relay, what current they take."""

from collections.abc import Mapping

from boards.core import Board
from plant.plant import Plant

BOARD_A = 0.15
"""Of one board with its transceiver at 24 V, ASSUMPTION."""
CHANNELS: dict[str, tuple[tuple[str, ...], ...]] = {
    "POWER_DRIVES": (
        ("AXIS_RA",), ("AXIS_DEC",), ("POSITION_RA",), ("POSITION_DEC",), ("MOTOR_RA_A", "MOTOR_RA_B"),
        ("MOTOR_DEC_A", "MOTOR_DEC_B"), (), (),
    ),
    "POWER_ROOM": (
        ("FOCUS",), ("DISPLAY",), ("AUXILIARY_RA", "AUXILIARY_DEC"), ("WEATHER_MAST",), ("WEATHER_DOME",),
        ("DOME",), (), (),
    ),
}  # fmt: skip
"""Boards by relay 1..8, ASSUMPTION. The gateway lives on USB; the power boards hang on no relay."""


class Supply:
    """What one power board measures and switches."""

    def __init__(
        self, plant: Plant, boards: Mapping[str, Board], channels: tuple[tuple[str, ...], ...]
    ) -> None:
        self._plant = plant
        self._boards = boards
        self._channels = channels
        self._names = [name for channel in channels for name in channel]

    def voltage(self, t_ns: int) -> float:
        """V; stiff where no axis is on it."""
        if "AXIS_RA" in self._names:
            return self._plant.rail(t_ns)
        return float(self._plant.model.supply.voltage.si)

    def current(self, t_ns: int) -> float:
        """A: the motors of the axes on this supply, and its boards."""
        names = self._names
        on = sum(self._boards[name].on for name in names if name in self._boards)
        motors = [
            port
            for name, port in (("AXIS_RA", self._plant.ra), ("AXIS_DEC", self._plant.dec))
            if name in names
        ]
        return BOARD_A * on + sum(port.current(t_ns, motor) for port in motors for motor in (0, 1))

    def relay(self, t_ns: int, channel: int, on: bool) -> None:
        """Relay 1..8: its boards lose or get their supply."""
        for name in self._channels[channel - 1]:
            board = self._boards.get(name)
            if board is not None:
                (board.power_on if on else board.power_off)(t_ns)
