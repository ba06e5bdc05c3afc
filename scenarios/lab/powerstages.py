"""The power stages between an axis board's PWM and its motors, what is wrong with them, and their supply."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plant.kernels import layout as at

if TYPE_CHECKING:
    from scenarios.lab.faults.onplant import Staged
    from scenarios.lab.network import Network


class _Axis:
    """One axis while something is wrong with it. dead: without supply, whatever its switches do."""

    def __init__(self, network: Network, axis: str) -> None:
        self._name = axis
        self._pwm = getattr(network.boards[f"AXIS_{axis.upper()}"], "pwm")  # noqa: B009 - Board has none
        self._below = self._pwm.drive
        self.stages: list[Staged] = []
        self.dead = False
        view, place = network.plant.view, AXES[axis] * at.WIDTH + at.DUTY
        self._wanted = (view[place], view[place + 1])
        self._pwm.drive = self.drive

    def drive(self, t_ns: int, duty_a: float, duty_b: float) -> None:
        """In the place of the pin."""
        self._wanted = duty_a, duty_b
        self.again(t_ns)

    def again(self, t_ns: int) -> None:
        """The switches as they are now."""
        duties = self._wanted
        for stage in self.stages:
            before, duties = duties, stage.duties(duties)
            if duties != before:
                stage.evidence.act(t_ns, f"duties of {self._name}")
        self._below(t_ns, *((0.0, 0.0) if self.dead else duties))

    def leave(self) -> None:
        self._pwm.drive = self._below


AXES = {"ra": 0, "dec": 1}
"""Axis to its row of the plant's world."""


class PowerStages:
    """All axes with a stage that is not as it should be."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._axes: dict[str, _Axis] = {}

    def add(self, axis: str, stage: Staged, t_ns: int) -> None:
        """From now on, whatever the board has commanded before."""
        self._at(axis).stages.append(stage)
        self._at(axis).again(t_ns)

    def remove(self, axis: str, stage: Staged, t_ns: int) -> None:
        """The switches obey again."""
        self._axes[axis].stages.remove(stage)
        self._settle(axis, t_ns)

    def supply(self, axis: str, on: bool, t_ns: int) -> None:
        """The supply of both motors of an axis is cut, or is back."""
        self._at(axis).dead = not on
        self._settle(axis, t_ns)

    def _at(self, axis: str) -> _Axis:
        if axis not in self._axes:
            self._axes[axis] = _Axis(self._network, axis)
        return self._axes[axis]

    def _settle(self, axis: str, t_ns: int) -> None:
        one = self._axes[axis]
        one.again(t_ns)
        if not one.stages and not one.dead:
            one.leave()
            del self._axes[axis]
