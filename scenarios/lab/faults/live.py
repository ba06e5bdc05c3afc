"""Faults of a running network: started and cleared by a call, or by a scenario's clock."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bus.time import generator
from scenarios.lab.faults.kind import Active, Kind
from scenarios.lab.faults.place import Place
from scenarios.lab.faults.table import BY_NAME, KINDS
from scenarios.lab.layers import Evidence
from scenarios.lab.network import Network
from scenarios.language.model import Fault


@dataclass(frozen=True)
class Running:
    """A fault that is on: arguments in base units, since when."""

    number: int
    name: str
    arguments: dict[str, Any]
    since_ns: int


class Faults:
    """What is wrong with one network.

    start, clear: between slices of simulated time. Without faults nothing of this lies in anybody's way, and
    with the last one cleared everything is again what it was: pins, receivers, numbers.
    """

    def __init__(self, network: Network, seed: int) -> None:
        self._network = network
        self._seed = seed
        self.place = Place(network=network, random=np.random.default_rng(0), evidence=Evidence(""))
        self._next = 0
        self._active: dict[int, tuple[Running, Active]] = {}
        self.evidence: list[Evidence] = []
        """Of all there have been or will be: a scenario's in its order, then the others as they came."""

    @staticmethod
    def kinds() -> tuple[Kind, ...]:
        """All there are: name, level, text, parameters with units, bounds and defaults."""
        return KINDS

    @property
    def running(self) -> list[Running]:
        """What is on, oldest first."""
        return [running for running, _ in self._active.values()]

    def check(self, name: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Arguments in base units; raises ValueError with one line."""
        kind = BY_NAME.get(name)
        if kind is None:
            raise ValueError(f"no fault is called {name!r}; use one of {', '.join(BY_NAME)}")
        return kind.arguments(arguments, self.place.known())

    def start(self, name: str, **arguments: Any) -> int:
        """Start a fault now; numbers in base units, or text with a unit. Returns its number for `clear`.

        Raises ValueError, in one line, for what cannot be; then nothing has changed.
        """
        values = self.check(name, arguments)
        evidence = Evidence(name, values, self._network.queue.now_ns)
        number = self._start(values, f"fault.live.{self._next}.{name}", evidence)
        self.evidence.append(evidence)
        return number

    def _start(self, values: dict[str, Any], stream: str, evidence: Evidence) -> int:
        now_ns, name = self._network.queue.now_ns, evidence.name
        place = replace(self.place, random=generator(self._seed, stream), evidence=evidence)
        active = BY_NAME[name].make(place, values, now_ns)
        number, self._next = self._next, self._next + 1
        self._active[number] = Running(number, name, values, now_ns), active
        return number

    def clear(self, number: int) -> None:
        """End a fault now. Raises ValueError when it is not on."""
        if number not in self._active:
            on = ", ".join(f"{each.number} {each.name}" for each in self.running) or "none"
            raise ValueError(f"no fault has the number {number}; on: {on}")
        _, active = self._active.pop(number)
        active.clear(self._network.queue.now_ns)

    def schedule(self, faults: Iterable[Fault]) -> None:
        """Those of a scenario, at their times. Raises ValueError."""
        for index, fault in enumerate(faults):
            _Planned(self, index, fault)


class _Planned:
    """A fault that starts and ends by the clock."""

    def __init__(self, faults: Faults, index: int, fault: Fault) -> None:
        self._faults = faults
        self._values = faults.check(fault.kind, fault.arguments)
        self._stream = f"fault.{index}.{fault.kind}"
        self._number = -1
        queue = faults._network.queue
        start_ns = round(fault.at_s * 1e9)
        self._evidence = Evidence(fault.kind, self._values, start_ns, fault.may_not_act, fault.where)
        faults.evidence.append(self._evidence)
        self._end_ns = None if fault.until_s is None else round(fault.until_s * 1e9)
        if start_ns <= queue.now_ns:
            self._start(start_ns)
        else:
            queue.at(start_ns, self._start)
        if self._end_ns is not None:
            queue.at(self._end_ns, self._end)

    def _start(self, _t_ns: int) -> None:
        try:
            self._number = self._faults._start(self._values, self._stream, self._evidence)
        except ValueError as error:
            raise ValueError(f"{self._evidence.where}: {error}") from None

    def _end(self, _t_ns: int) -> None:
        if self._number >= 0:
            self._faults.clear(self._number)
