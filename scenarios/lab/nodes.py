"""Declared boards: found, wired to the plant, the supplies and what a scenario puts on their inputs."""

import sys
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from hashlib import sha256
from importlib.util import module_from_spec, spec_from_file_location
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import Any

import yaml

from boards import __file__ as package
from boards.auxiliary.firmware import AuxiliaryBoard
from boards.core import Board, Source
from boards.core.declared import DeclaredBoard, Pin
from boards.dome.firmware import DomeBoard
from boards.power.firmware import PowerBoard
from boards.weather.firmware import WeatherBoard
from bus.protocol.nodes import KINDS, KindError, arguments_of, check_kind, messages_of
from plant.air import Air
from plant.dome import DomePort
from plant.plant import Plant
from scenarios.language.model import Scenario

BOARD_A = 0.15
"""Of one board with its transceiver at 24 V, ASSUMPTION."""
CHANNELS: dict[str, list[list[str]]] = yaml.safe_load(
    Path(__file__).with_name("supplies.yaml").read_text(encoding="utf-8")
)


class Supply:
    """What one power board measures and switches: the boards on its relays, and what current they take."""

    def __init__(self, plant: Plant, boards: Mapping[str, Board], channels: list[list[str]]) -> None:
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
        axes = {"AXIS_RA": self._plant.ra, "AXIS_DEC": self._plant.dec}
        on = sum(self._boards[name].on for name in self._names if name in self._boards)
        motors = [axes[name] for name in self._names if name in axes]
        return BOARD_A * on + sum(port.current(t_ns, motor) for port in motors for motor in (0, 1))

    def relay(self, t_ns: int, channel: int, on: bool) -> None:
        """Relay 1..8: its boards lose or get their supply."""
        for name in self._channels[channel - 1]:
            board = self._boards.get(name)
            if board is not None:
                (board.power_on if on else board.power_off)(t_ns)


BOARDS: tuple[type[DeclaredBoard], ...] = (AuxiliaryBoard, DomeBoard, WeatherBoard, PowerBoard)
"""Those that come along."""
_COME_ALONG = Path(package).parent
_WORDS = range(-(1 << 31), 1 << 31)
_NUMBERS = range(1, 256)
"""Bounds of a number that SET_PARAMETER carries (docs/reference/protocol.md)."""
MODULE = "schmidt_board_"
"""How the modules of users' boards are called, with a digest of where the file is."""


class Input:
    """An input pin that holds a value from each of some times on. times_ns: rising, the first is 0."""

    def __init__(self, times_ns: Sequence[int], values: Sequence[float]) -> None:
        self.times_ns = list(times_ns)
        self.values = list(values)

    def __call__(self, t_ns: int) -> float:
        """The value at `t_ns`."""
        return self.values[bisect_right(self.times_ns, t_ns) - 1]


class Site:
    """What declared boards' pins may be wired to: the plant's ports, the dome, the supplies."""

    def __init__(self, plant: Plant, boards: Mapping[str, Board], humidity: float) -> None:
        self.ra, self.dec, self.focus = plant.ra, plant.dec, plant.focus
        self.air = Air(plant.model, humidity)
        self.dome = DomePort()
        self.supplies = {name: Supply(plant, boards, channels) for name, channels in CHANNELS.items()}
        self.parts: dict[str, object] = {}
        """What the boards brought along, by their names."""

    def pin(self, name: str, pin: Pin, inputs: Mapping[str, Input]) -> Callable[..., float]:
        """The callable for one pin of board `name`; raises KindError when there is no such thing."""
        if not pin.source:
            return inputs.get(pin.name) or self._free(name, pin)
        port_name, _, method = pin.source.format(side=name.rpartition("_")[2].lower()).partition(".")
        own: dict[str, Mapping[str, object]] = {"supply": self.supplies, "part": self.parts}
        port = own[port_name].get(name) if port_name in own else getattr(self, port_name, None)
        found = getattr(port, method, None) if method and not method.startswith("_") else None
        if not callable(found):
            raise KindError(f"board {name}: pin {pin.name}: there is no {pin.source} to wire it to")
        wired: Callable[..., float] = found
        return wired

    def _free(self, name: str, pin: Pin) -> Callable[..., float]:
        """The air's, at a weather station; else what the board says of a pin that no scenario sets."""
        air = getattr(self.air, pin.name, None) if name in WeatherBoard.KIND.nodes else None
        return air or Input([0], [pin.default])


def pins_of(
    board: type[DeclaredBoard], name: str, site: Site, given: Mapping[str, Any]
) -> dict[str, Callable[..., float]]:
    """All pins of a board. given: a scenario's `inputs`, pin -> number or list of {at (s), value}."""
    known = [pin.name for pin in board.PINS if not pin.source]
    for pin in given:
        if pin not in known:
            raise KindError(
                f"network: nodes.{name}.inputs: there is no input '{pin}'; "
                f"it has {', '.join(known) or 'none'}"
            )
    inputs = {pin: _input(name, pin, value, board) for pin, value in given.items()}
    if board.PART is not None:
        site.parts[name] = board.PART()
    return {pin.name: site.pin(name, pin, inputs) for pin in board.PINS}


def _input(name: str, pin: str, value: Any, board: type[DeclaredBoard]) -> Input:
    if not isinstance(value, list):
        return Input([0], [float(value)])
    times = [round(each["at"] * 1e9) for each in value]
    if times != sorted(set(times)):
        raise KindError(f"network: nodes.{name}.inputs.{pin}: the times must rise")
    first = next(each.default for each in board.PINS if each.name == pin)
    return Input([-1, *times], [first, *(float(each["value"]) for each in value)])


def load_board(file: Path, beside: Iterable[type[DeclaredBoard]] = ()) -> type[DeclaredBoard]:
    """The one declared board in a Python file.

    Raises KindError with one line for a file that cannot be used, or not `beside` other boards.
    """
    module = _module(file)
    found = [
        each
        for each in vars(module).values()
        if isinstance(each, type) and issubclass(each, DeclaredBoard) and each.__module__ == module.__name__
    ]
    if len(found) != 1:
        raise KindError(f"{file}: holds {len(found)} classes derived from DeclaredBoard, expected one")
    board = found[0]
    missing = [word for word in ("KIND", "TABLE") if not hasattr(board, word)]
    if missing:
        raise KindError(f"{file}: {board.__name__} has no {' and no '.join(missing)}")
    try:
        check_kind(board.KIND, [*KINDS, *(each.KIND for each in beside)])
        messages_of(board.KIND)
        methods = [opcode.name.lower() for opcode in arguments_of(board.KIND)]
        unfit = _unfit(board)
    except (AttributeError, TypeError, LookupError) as error:
        raise KindError(f"{file}: {board.__name__}.KIND cannot be used: {error}") from None
    if unfit:
        raise KindError(f"{file}: {board.__name__}.{unfit}")
    if unwritten := [name for name in methods if not hasattr(board, name)]:
        raise KindError(f"{file}: {board.__name__} has no method {unwritten[0]}, as its opcode is called")
    return board


def _unfit(board: type[DeclaredBoard]) -> str:
    """Which of its rows cannot be, and why; "" when all can."""
    second = range(board.FCY_HZ)
    for source in board.TABLE:
        cycles = (source.latency_cycles, source.cost_cycles) if isinstance(source, Source) else (None,)
        if not all(isinstance(each, int) and each in second for each in cycles):
            return f"TABLE: {source}: it takes rows of Source, whole cycles below FCY_HZ"
    numbers = [row.number for row in board.KIND.parameters]
    for row in board.KIND.parameters:
        whole = all(isinstance(each, int) and each in _WORDS for each in (row.low, row.default, row.high))
        if not whole or not row.low <= row.default <= row.high:
            return f"KIND: parameter {row.name}: low, high and, between them, the default are 32-bit numbers"
        if not isinstance(row.number, int) or row.number not in _NUMBERS or numbers.count(row.number) > 1:
            return f"KIND: parameter {row.name}: its number is 1 to 255, and no other's"
    names = [pin.name for pin in board.PINS]
    for pin in board.PINS:
        if not isfinite(pin.default) or names.count(pin.name) > 1:
            return f"PINS: {pin.name}: its default is a finite number, its name no other's"
    return ""


def firmware_file(folder: Path, name: str) -> Path:
    """A file of C beside the scenario, or one that comes along."""
    beside = folder / name
    return beside.resolve() if beside.exists() else next(_COME_ALONG.glob(f"*/{name}"), beside)


def board_files(scenario: Scenario) -> list[Path]:
    """The files of the boards that a scenario brings along."""
    return [scenario.file.parent / file for file in scenario.network.get("boards", ())]


def _module(file: Path) -> ModuleType:
    name = MODULE + sha256(file.resolve().as_posix().encode()).hexdigest()[:16]
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None or not file.is_file():
        raise KindError(f"{file}: no such Python file")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise KindError(f"{file}: cannot be imported: {type(error).__name__}: {error}") from None
    return module
