"""Faults of a scenario: boards without supply, lost frames, disturbed bits, sensors that stick."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from bus.can import Flip, Frame
from bus.can.length import frame_bits
from bus.protocol import COMMAND_BASE, REPLY_BASE, device_named
from bus.time import generator
from scenarios.model import Fault

if TYPE_CHECKING:
    from plant.plant import Plant
    from scenarios.network import Network

_FOREVER = 1 << 62
_PINS = {
    "incremental": ("incremental", None),
    "absolute": ("absolute", None),
    "auxiliary": ("auxiliary", None),
    "tachometer_a": ("tachometer_a", None),
    "tachometer_b": ("tachometer_b", None),
    "current_a": ("current", 0),
    "current_b": ("current", 1),
    "encoder": ("encoder", None),
    "index": ("index", None),
    "lvdt": ("lvdt", None),
}
"""Sensor of the scenario language to the plant port's method and the motor it is asked for."""


def stick_sensors(plant: Plant, faults: Iterable[Fault]) -> None:
    """Put the stuck sensors between plant and boards; to be called before the boards are wired."""
    for fault in faults:
        if fault.kind == "sensor_stuck":
            part, sensor = fault.arguments["sensor"].split(".")
            method, motor = _PINS[sensor]
            port = getattr(plant, part)
            setattr(port, method, _stuck(getattr(port, method), motor, *_window_ns(fault)))


def apply(network: Network, faults: Iterable[Fault], seed: int) -> None:
    """Arrange everything else on a built network."""
    for index, fault in enumerate(faults):
        start_ns, end_ns = _window_ns(fault)
        random = generator(seed, f"fault.{index}.{fault.kind}")
        if fault.kind == "node_off":
            board = network.boards[fault.arguments["node"]]
            network.queue.at(start_ns, board.power_off)
            if end_ns < _FOREVER:
                network.queue.at(end_ns, board.power_on)
        elif fault.kind == "frame_loss":
            _lose(
                network,
                _selector(fault.arguments),
                fault.arguments.get("probability", 1.0),
                random,
                start_ns,
                end_ns,
            )
        elif fault.kind == "bit_errors":
            _disturb(network, fault.arguments, random, start_ns, end_ns)


def _window_ns(fault: Fault) -> tuple[int, int]:
    end_ns = _FOREVER if fault.until_s is None else round(fault.until_s * 1e9)
    return round(fault.at_s * 1e9), end_ns


def _stuck(read: Callable[..., Any], motor: int | None, start_ns: int, end_ns: int) -> Callable[..., Any]:
    """The same pin, showing from `start_ns` to `end_ns` what it showed at the start."""
    held: list[Any] = []

    def reading(t_ns: int, *which: int) -> Any:
        if not start_ns <= t_ns < end_ns or (motor is not None and which != (motor,)):
            return read(t_ns, *which)
        if not held:
            held.append(read(t_ns, *which))
        return held[0]

    return reading


def _selector(given: dict[str, Any]) -> Callable[[Frame], bool]:
    """Which frames are meant: those with an identifier, or those a node sends."""
    if "identifier" in given:
        wanted = given["identifier"]
        return lambda frame: frame.identifier == wanted
    device = device_named(given["node"])
    return lambda frame: (
        frame.identifier & 0x7F == device and not COMMAND_BASE <= frame.identifier < REPLY_BASE
    )


def _lose(
    network: Network,
    meant: Callable[[Frame], bool],
    probability: float,
    random: Any,
    start_ns: int,
    end_ns: int,
) -> None:
    """Every receiver misses the frames that are meant, each for itself: its buffer was overwritten."""

    def deaf(hear: Callable[[int, Frame], None]) -> Callable[[int, Frame], None]:
        def receive(t_ns: int, frame: Frame) -> None:
            if start_ns <= t_ns < end_ns and meant(frame) and random.random() < probability:
                return
            hear(t_ns, frame)

        return receive

    for port in network.wire.ports:
        if port.on_receive is not None:
            port.on_receive = deaf(port.on_receive)


def _disturb(network: Network, given: dict[str, Any], random: Any, start_ns: int, end_ns: int) -> None:
    probability, node = given["probability"], given.get("node")

    def disturb(_t_ns: int, frame: Frame, sender: str) -> Flip | None:
        if (node is None or sender == node) and random.random() < probability:
            return Flip(int(random.integers(frame_bits(frame) - 3)))
        return None

    network.queue.at(start_ns, lambda _t: network.wire.disturb(disturb))
    if end_ns < _FOREVER:
        network.queue.at(end_ns, lambda _t: network.wire.disturb(None))
