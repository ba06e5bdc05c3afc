"""Wires boards, bus and plant together: `build(config, plant, seed)`."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from boards.axis import AxisBoard, AxisPins
from boards.axis.config import STEPS_PER_TURN
from boards.core import Board
from boards.core.debug import DebugPort
from boards.core.declared import uart_of
from boards.display import DisplayBoard
from boards.focus import FocusBoard, FocusConfig, FocusPins
from boards.gateway import GatewayBoard
from boards.motor_velocity import MotorVelocityBoard, MotorVelocityPins
from boards.position import PositionBoard, PositionPins
from boards.silicon.hid import HidEndpoint
from boards.silicon.uart import Uart
from bus.can import Wire
from bus.protocol import Device
from bus.protocol.nodes import AUXILIARY, KindError, kind_of
from bus.time import EventQueue, Oscillator, generator
from plant.axis import AxisPort
from plant.plant import Plant
from scenarios.drive import axis_config
from scenarios.networks import FINAL, NetworkConfig, NetworkError, NodeConfig, devices_of
from scenarios.nodes import BOARDS, Site, pins_of

if TYPE_CHECKING:
    from boards.canopen import Voice

CRYSTAL_PPM = 50.0
"""Largest rate error of a board's crystal, ASSUMPTION: tolerance of ordinary crystals."""
CRYSTAL_DRIFT_PPM_PER_HOUR = 0.2
"""Largest drift while the night cools, ASSUMPTION: 0.04 ppm/K2 of an AT cut, a few kelvin an hour."""
CRYSTAL_PHASE_NS = 1_000_000_000
"""Boards have been switched on within the same second, ASSUMPTION."""
_MAXIMUM_NODES = 64
SPARE_TYPES = tuple(
    number for number in range(0x35, 0x80) if number not in {int(device) for device in (*Device, *FINAL)}
)
"""Device types for boards beyond the lab network."""


@dataclass
class Network:
    """Everything that has been wired. Nothing has run yet: use `queue.run_until(t_ns)`."""

    queue: EventQueue
    wire: Wire
    boards: dict[str, Board]
    plant: Plant
    hid: HidEndpoint
    uarts: dict[str, Uart]
    debug: dict[str, DebugPort] = field(default_factory=dict)
    voices: dict[str, "Voice"] = field(default_factory=dict)

    def run_until(self, t_ns: int) -> None:
        """Let simulated time go on to `t_ns`."""
        self.queue.run_until(t_ns)

    def board(self, name: str) -> Board:
        """Return a board by name; raises NetworkError naming the ones there are."""
        try:
            return self.boards[name]
        except KeyError:
            known = ", ".join(self.boards)
            raise NetworkError(f"network: there is no board '{name}'; expected one of {known}") from None

    @property
    def overruns(self) -> dict[str, int]:
        """Interrupts lost so far, by board."""
        return {name: board.cpu.overruns for name, board in self.boards.items()}

    @property
    def dropped(self) -> dict[str, int]:
        """Frames lost so far for want of buffers, by board."""
        return {name: board.dropped for name, board in self.boards.items()}


def crystal(seed: int, name: str, settings: NodeConfig) -> Oscillator:
    """The oscillator of a board: rate, phase and drift from (seed, board name) unless set."""
    random = generator(seed, f"crystal.{name}")
    ppm = float(random.uniform(-CRYSTAL_PPM, CRYSTAL_PPM))
    phase_ns = int(random.integers(CRYSTAL_PHASE_NS))
    drift = float(random.uniform(-CRYSTAL_DRIFT_PPM_PER_HOUR, CRYSTAL_DRIFT_PPM_PER_HOUR))
    return Oscillator(
        ppm if settings.ppm is None else settings.ppm,
        phase_ns if settings.phase_ns is None else settings.phase_ns,
        drift,
    )


class _Wiring:
    """The parts all boards share while they are being made."""

    def __init__(self, config: NetworkConfig, plant: Plant, seed: int, devices: tuple[Device, ...]) -> None:
        self.config = config
        self.devices = devices
        self.plant = plant
        self.seed = seed
        self.queue = EventQueue()
        self.wire = Wire(self.queue, config.bitrate)
        self.boards: dict[str, Board] = {}
        self.site = Site(plant, self.boards)

    def common(self, name: str, device: int) -> tuple[str, int, EventQueue, Wire]:
        return name, int(device), self.queue, self.wire

    def crystal(self, name: str) -> Oscillator:
        return crystal(self.seed, name, self.config.nodes.get(name, NodeConfig()))

    def port(self, device: Device) -> tuple[str, AxisPort]:
        axis = "ra" if "_RA" in device.name else "dec"
        return axis, getattr(self.plant, axis)

    def limits(self, axis: str) -> tuple[int, int]:
        return self.config.limits.get(axis, (0, STEPS_PER_TURN - 1))

    def axis(self, device: Device) -> Board:
        axis, port = self.port(device)
        pins = AxisPins(port.incremental, port.drive, port.current)
        settings = axis_config(self.plant, axis, self.limits(axis), self.config.bitrate)
        side = axis.upper()
        motors = (int(Device[f"MOTOR_{side}_A"]), int(Device[f"MOTOR_{side}_B"]))
        position = int(Device[f"POSITION_{side}"])
        crystal = self.crystal(device.name)
        number = AUXILIARY.nodes[f"AUXILIARY_{side}"]
        auxiliary = number if number in self.devices else None
        return AxisBoard(
            *self.common(device.name, device), pins, crystal, settings, position, motors, auxiliary
        )

    def position(self, device: Device) -> Board:
        axis, port = self.port(device)
        crystal = self.crystal(device.name)
        pins = PositionPins(port.absolute)
        return PositionBoard(*self.common(device.name, device), pins, crystal, *self.limits(axis))

    def motor(self, device: Device) -> Board:
        _, port = self.port(device)
        encoder = port.tachometer_a if device.name.endswith("A") else port.tachometer_b
        return self.velocity(device.name, int(device), encoder)

    def velocity(self, name: str, device_type: int, encoder: Callable[[int], int]) -> Board:
        crystal = self.crystal(name)
        return MotorVelocityBoard(*self.common(name, device_type), MotorVelocityPins(encoder), crystal)

    def gateway(self, device: Device) -> Board:
        return GatewayBoard(*self.common(device.name, device), self.crystal(device.name))

    def focus(self, device: Device) -> Board:
        port = self.plant.focus
        pins = FocusPins(port.coils, port.encoder, port.index, port.lvdt)
        model = self.plant.model.focus
        settings = FocusConfig(round(model.half_steps.si), round(model.encoder.si))
        return FocusBoard(*self.common(device.name, device), pins, self.crystal(device.name), settings)

    def display(self, device: Device) -> Board:
        positions = (int(Device.POSITION_RA), int(Device.POSITION_DEC))
        crystal = self.crystal(device.name)
        return DisplayBoard(*self.common(device.name, device), crystal, positions, int(Device.FOCUS))

    def declared(self, device: Device) -> Board:
        kind = kind_of(device)
        board = BOARDS[kind.name if kind is not None else ""]
        given = self.config.nodes.get(device.name, NodeConfig()).inputs
        try:
            pins = pins_of(board, device.name, self.site, given)
            return board(*self.common(device.name, device), pins, self.crystal(device.name))
        except KindError as error:
            raise NetworkError(str(error)) from None


_MAKERS: tuple[tuple[str, Callable[[_Wiring, Device], Board]], ...] = (
    ("AXIS", _Wiring.axis),
    ("POSITION", _Wiring.position),
    ("MOTOR", _Wiring.motor),
    ("GATEWAY", _Wiring.gateway),
    ("FOCUS", _Wiring.focus),
    ("DISPLAY", _Wiring.display),
)


def build(config: NetworkConfig | None, plant: Plant, seed: int) -> Network:
    """The network, every board running from time 0 on; raises NetworkError for settings no network can
    have."""
    config = config or NetworkConfig()
    devices = devices_of(config)
    size = len(devices) if config.size is None else config.size
    if not 1 <= size <= _MAXIMUM_NODES:
        raise NetworkError(f"network: size {size} is not within 1..{_MAXIMUM_NODES}")
    wiring = _Wiring(config, plant, seed, devices[:size])
    boards = wiring.boards
    for device in wiring.devices:
        if kind_of(device) is not None:
            boards[device.name] = wiring.declared(device)
            continue
        make = next(maker for prefix, maker in _MAKERS if device.name.startswith(prefix))
        boards[device.name] = make(wiring, device)
    for device_type in SPARE_TYPES[: max(0, size - len(devices))]:
        name = f"MOTOR_{device_type:02X}"
        encoder = plant.ra.tachometer_b if device_type & 1 else plant.ra.tachometer_a
        boards[name] = wiring.velocity(name, device_type, encoder)
    unknown = set(config.nodes) - set(boards)
    if unknown:
        raise NetworkError(
            f"network: there is no board '{min(unknown)}'; expected one of {', '.join(boards)}"
        )
    gateway = boards.get(Device.GATEWAY.name)
    hid = gateway.hid if isinstance(gateway, GatewayBoard) else HidEndpoint()
    uarts = {name: uart for name, board in boards.items() if (uart := uart_of(board)) is not None}
    for name, board in boards.items():
        board.begin()
        _set_parameters(board, config.nodes.get(name, NodeConfig()))
    debug = {name: DebugPort(board, wiring.wire) for name, board in boards.items()}
    voices: dict[str, Any] = {}
    if config.canopen:
        from boards.canopen import Voice  # the package takes its time

        voices = {name: Voice(board) for name, board in boards.items()}
    return Network(wiring.queue, wiring.wire, boards, plant, hid, uarts, debug, voices)


def _set_parameters(board: Board, settings: NodeConfig) -> None:
    for number, value in settings.parameters.items():
        if board.parameters.set(number, value).result:
            reply = board.parameters.get(number)
            reason = "does not exist" if reply.result else f"does not take {value}"
            raise NetworkError(f"network: nodes.{board.name}.parameters: parameter {number} {reason}")
