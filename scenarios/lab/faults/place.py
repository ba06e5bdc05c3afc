"""Where a fault acts: the network, and what several faults share on it."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from bus.can.stuck import StuckDominant
from scenarios.lab.layers import Evidence, Laid, Stacks, turned
from scenarios.lab.network import Network

_ROWS = yaml.safe_load(Path(__file__).with_name("sensors.yaml").read_text(encoding="utf-8"))
SENSORS: dict[str, tuple[str, str, str, int | None]] = {name: tuple(row) for name, row in _ROWS.items()}
"""Sensor to the board that reads it, the chip on it, the chip's pin, and the motor it is asked for."""
UNITS = {"current_a": "A", "current_b": "A", "lvdt": "V", "index": ""}
"""Unit of a sensor's readings; the others count."""
AXES = ("ra", "dec")
WORDS = {"sensor": tuple(SENSORS), "axis": AXES, "motor": ("a", "b")}
"""What an argument of each type may be, in any network."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Place:
    """network: where. random, evidence: of the fault that is being started. The rest is shared by all.

    held: how many faults keep a board off, or something else from working, by name. halted: processors that
    stand still, by their name in `held`, and the evidence of the fault that began it. stuck: one at most.
    """

    network: Network
    random: np.random.Generator
    evidence: Evidence
    dials: Stacks = field(default_factory=lambda: Stacks(turned))
    stuck: list[StuckDominant] = field(default_factory=list)
    held: dict[str, int] = field(default_factory=dict)
    halted: dict[str, tuple[Laid, Evidence]] = field(default_factory=dict)

    @property
    def layers(self) -> Stacks:
        """What lies on pins and receivers of the network."""
        return self.network.layers

    def board(self, name: str) -> Any:
        """A board of the network; raises ValueError."""
        try:
            return self.network.boards[name]
        except KeyError:
            raise ValueError(f"this network has no board {name}") from None

    def pin(self, sensor: str) -> tuple[Any, str, int | None]:
        """(chip, attribute, motor) through which a board reads a sensor; raises ValueError when none does."""
        board, chip, attribute, motor = SENSORS[sensor]
        owner = self.board(board)
        for part in filter(None, chip.split(".")):
            owner = getattr(owner, part)
        return owner, attribute, motor

    def hold(self, name: str) -> bool:
        """One more fault keeps this board off; whether it is the first."""
        self.held[name] = self.held.get(name, 0) + 1
        return self.held[name] == 1

    def let_go(self, name: str) -> bool:
        """One fewer; whether it was the last."""
        self.held[name] -= 1
        return not self.held[name]

    def known(self) -> dict[str, tuple[str, ...]]:
        """The words an argument may be, by its type."""
        return {"node": tuple(self.network.boards), **WORDS}
