"""Wires boards, bus and plant together: `build(config, plant, seed)`."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from boards.axis.config import AxisPeers, AxisPins
from boards.axis.config import settings as programmed
from boards.axis.firmware import AxisBoard
from boards.c.board import Chips, FirmwareBoard
from boards.c.isolated import IsolatedMemory
from boards.c.library import FirmwareError, Memory
from boards.core import Board, Place
from boards.core.debug import DebugPort
from boards.core.declared import board_error, uart_of
from boards.display.firmware import DisplayBoard
from boards.focus.config import FocusConfig, FocusPins
from boards.focus.firmware import FocusBoard
from boards.gateway.firmware import GatewayBoard
from boards.motor_velocity.firmware import MotorVelocityBoard
from boards.position.firmware import PositionBoard
from boards.silicon.adc import CurrentAdc
from boards.silicon.endat import EndatEncoder, EndatMaster
from boards.silicon.hid import HidEndpoint
from boards.silicon.pwm import MotorPwm
from boards.silicon.qei import Qei
from boards.silicon.uart import Uart
from bus.can import Wire
from bus.protocol import Device
from bus.protocol.nodes import AUXILIARY, KindError, kind_of
from bus.protocol.scales import STEPS_PER_TURN
from bus.time import EventQueue, Oscillator, generator
from plant.axis import AxisPort
from plant.dome import DomePort
from plant.plant import Plant
from scenarios.lab.drive import axis_config
from scenarios.lab.layers import Stacks, chained
from scenarios.lab.networks import FINAL, NetworkConfig, NodeConfig, devices_of
from scenarios.lab.nodes import BOARDS, Site, pins_of

if TYPE_CHECKING:
    from boards.canopen import Voice
    from scenarios.lab.blowing import Blowing
    from scenarios.lab.chain import Chain

Firmware = TypeVar("Firmware")
CRYSTAL_PPM = 50.0
"""Largest rate error of a board's crystal, ASSUMPTION: tolerance of ordinary crystals."""
CRYSTAL_DRIFT_PPM_PER_HOUR = 0.2
"""Largest drift while the night cools, ASSUMPTION: 0.04 ppm/K2 of an AT cut, a few kelvin an hour."""
CRYSTAL_PHASE_NS = 1_000_000_000
"""Boards have been switched on within the same second, ASSUMPTION."""
_MAXIMUM_NODES = 64
SPARE_TYPES = tuple(sorted(set(range(0x35, 0x80)) - {int(device) for device in (*Device, *FINAL)}))
"""Device types for boards beyond the lab network."""


@dataclass
class Network:
    """Everything that has been wired. Nothing has run yet: use `queue.run_until(t_ns)`."""

    queue: EventQueue
    wire: Wire
    boards: dict[str, Board]
    devices: tuple[Device, ...]
    plant: Plant
    hid: HidEndpoint
    uarts: dict[str, Uart]
    debug: dict[str, DebugPort] = field(default_factory=dict)
    voices: dict[str, "Voice"] = field(default_factory=dict)
    layers: Stacks = field(default_factory=lambda: Stacks(chained))
    chain: "Chain | None" = None
    dome: DomePort | None = None
    """None: no dome board, the telescope stands in the open."""
    blowing: "Blowing | None" = None

    def run_until(self, t_ns: int) -> None:
        """Let simulated time go on to `t_ns`."""
        self.queue.run_until(t_ns)

    def board(self, name: str) -> Board:
        """Return a board by name; raises ValueError naming the ones there are."""
        try:
            return self.boards[name]
        except KeyError:
            known = ", ".join(self.boards)
            raise ValueError(f"network: there is no board '{name}'; expected one of {known}") from None

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

    def __init__(
        self, config: NetworkConfig, plant: Plant, seed: int, devices: tuple[Device, ...], humidity: float
    ) -> None:
        self.config = config
        self.devices = devices
        self.plant = plant
        self.seed = seed
        self.queue = EventQueue()
        self.wire = Wire(self.queue, config.bitrate)
        self.boards: dict[str, Board] = {}
        self.site = Site(plant, self.boards, humidity)

    def place(self, name: str, kind: int) -> Place:
        oscillator = crystal(self.seed, name, self.config.node(name))
        return Place(name=name, device_type=kind, queue=self.queue, wire=self.wire, oscillator=oscillator)

    def of(self, device: Device) -> Place:
        return self.place(device.name, int(device))

    def port(self, device: Device) -> tuple[str, AxisPort]:
        axis = "ra" if "_RA" in device.name else "dec"
        return axis, getattr(self.plant, axis)

    def limits(self, axis: str) -> tuple[int, int]:
        return self.config.limits.get(axis, (0, STEPS_PER_TURN - 1))

    def axis(self, device: Device) -> Board:
        axis, port = self.port(device)
        pins = AxisPins(encoder=port.incremental, drive=port.drive, current=port.current)
        settings = axis_config(self.plant, axis, self.limits(axis), self.config.bitrate)
        side = axis.upper()
        auxiliary = AUXILIARY.nodes[f"AUXILIARY_{side}"]
        peers = AxisPeers(
            position=int(Device[f"POSITION_{side}"]),
            motor_a=int(Device[f"MOTOR_{side}_A"]),
            motor_b=int(Device[f"MOTOR_{side}_B"]),
            auxiliary=auxiliary if auxiliary in self.devices else None,
        )
        memory = self.memory(device)
        if memory is None:
            return AxisBoard(self.of(device), pins, settings, peers)
        pwm = MotorPwm(pins.drive, settings.pwm_steps, settings.pwm_hz)
        chips = Chips(qei=Qei(pins.encoder), pwm=pwm, adc=CurrentAdc(pins.current))
        return FirmwareBoard(self.of(device), memory, chips, programmed(settings, peers))

    def memory(self, device: Device) -> Memory | None:
        """Of a board that runs compiled C; None: it runs its own firmware."""
        file = self.config.node(device.name).firmware
        make = IsolatedMemory if self.config.isolated else Memory
        return None if file is None else self._loaded(device, lambda: make(file))

    def binary(self, device: Device) -> Board | None:
        """A board that runs a program for an AVR; None: it runs something else."""
        file = self.config.node(device.name).firmware
        if file is None or file.suffix != _AVR:
            return None
        from boards.avr import AvrBoard

        return self._loaded(device, lambda: AvrBoard(self.of(device), file))

    @staticmethod
    def _loaded(device: Device, load: Callable[[], Firmware]) -> Firmware:
        try:
            return load()
        except FirmwareError as error:
            raise ValueError(f"network: nodes.{device.name}.firmware: {error}") from None

    def position(self, device: Device) -> Board:
        axis, port = self.port(device)
        memory = self.memory(device)
        if memory is not None:
            chips = Chips(endat=EndatMaster(EndatEncoder(port.absolute)))
            return FirmwareBoard(self.of(device), memory, chips, self.limits(axis))
        return PositionBoard(self.of(device), port.absolute, *self.limits(axis))

    def motor(self, device: Device) -> Board:
        _, port = self.port(device)
        encoder = port.tachometer_a if device.name.endswith("A") else port.tachometer_b
        memory = self.memory(device)
        if memory is not None:
            return FirmwareBoard(self.of(device), memory, Chips(qei=Qei(encoder)))
        return self.velocity(device.name, int(device), encoder)

    def velocity(self, name: str, device_type: int, encoder: Callable[[int], int]) -> Board:
        return MotorVelocityBoard(self.place(name, device_type), encoder)

    def focus(self, device: Device) -> Board:
        port = self.plant.focus
        pins = FocusPins(coils=port.coils, encoder=port.encoder, index=port.index, lvdt=port.lvdt)
        model = self.plant.model.focus
        settings = FocusConfig(
            half_steps_per_turn=round(model.half_steps.si), counts_per_turn=round(model.encoder.si)
        )
        return FocusBoard(self.of(device), pins, settings)

    def gateway(self, device: Device) -> Board:
        return GatewayBoard(self.of(device))

    def display(self, device: Device) -> Board:
        positions = (int(Device.POSITION_RA), int(Device.POSITION_DEC))
        return DisplayBoard(self.of(device), positions, int(Device.FOCUS))

    def declared(self, device: Device) -> Board:
        board = next(each for each in (*self.config.extra, *BOARDS) if device.name in each.KIND.nodes)
        given = self.config.node(device.name).inputs
        try:
            pins = pins_of(board, device.name, self.site, given)
            made = board(self.of(device), pins)
            if not isinstance(made, board):
                raise TypeError(f"its class makes a {type(made).__name__}")
            return made
        except KindError as error:
            raise ValueError(str(error)) from None
        except BaseException as error:
            raise board_error(board, device.name, 0, error) from None


_AVR = ".elf"
"""Ending of a program for an ATmega328P."""
_IN_C = ("AXIS_", "POSITION_", "MOTOR_")
"""Boards whose chips firmware.h knows."""
_IN_AVR = ("MOTOR_", "DISPLAY")
"""Boards that need the bus alone: the emulated AVR has no RS232, no USB and no pins to the plant."""


def build(config: NetworkConfig | None, plant: Plant, seed: int, humidity: float = 0.5) -> Network:
    """The network, every board running from time 0 on; raises ValueError for settings that cannot be.

    humidity: relative, of the air, 0 to 1.
    """
    config = config or NetworkConfig()
    devices = devices_of(config)
    size = len(devices) if config.size is None else config.size
    if not 1 <= size <= _MAXIMUM_NODES:
        raise ValueError(f"network: size {size} is not within 1..{_MAXIMUM_NODES}")
    wiring = _Wiring(config, plant, seed, devices[:size], humidity)
    boards = wiring.boards
    _check_firmware(config)
    for device in wiring.devices:
        if kind_of(device) is None and config.node(device.name).inputs:
            raise ValueError(f"network: nodes.{device.name}.inputs: this board has no inputs")
        if kind_of(device) is not None:
            boards[device.name] = wiring.declared(device)
            continue
        make = getattr(wiring, device.name.partition("_")[0].lower())
        boards[device.name] = wiring.binary(device) or make(device)
    for device_type in SPARE_TYPES[: max(0, size - len(devices))]:
        name = f"MOTOR_{device_type:02X}"
        encoder = plant.ra.tachometer_b if device_type & 1 else plant.ra.tachometer_a
        boards[name] = wiring.velocity(name, device_type, encoder)
    if other := set(config.nodes) - set(boards):
        raise ValueError(f"network: there is no board '{min(other)}'; expected one of {', '.join(boards)}")
    gateway = boards.get(Device.GATEWAY.name)
    hid = gateway.hid if isinstance(gateway, GatewayBoard) else HidEndpoint()
    uarts = {name: uart for name, board in boards.items() if (uart := uart_of(board)) is not None}
    for name, board in boards.items():
        board.begin()
        _set_parameters(board, config.node(name))
    debug = {name: DebugPort(board, wiring.wire) for name, board in boards.items()}
    voices: dict[str, Any] = {}
    if config.canopen:
        from boards.canopen import Voice  # the package takes its time

        voices = {name: Voice(board) for name, board in boards.items()}
    made = Network(wiring.queue, wiring.wire, boards, wiring.devices, plant, hid, uarts, debug, voices)
    made.dome = wiring.site.dome if "DOME" in boards else None
    return made


def _check_firmware(config: NetworkConfig) -> None:
    firmware = {name: settings.firmware for name, settings in config.nodes.items() if settings.firmware}
    for name, file in firmware.items():
        where = f"network: nodes.{name}.firmware"
        what, boards = ("a program for an AVR", _IN_AVR) if file.suffix == _AVR else ("C", _IN_C)
        if not name.startswith(boards):
            raise ValueError(f"{where}: {what} runs on boards {', '.join(boards)} only")
        if config.canopen:
            raise ValueError(f"{where}: a board with firmware of its own has no CANopen voice")


def _set_parameters(board: Board, settings: NodeConfig) -> None:
    for number, value in settings.parameters.items():
        if board.parameters.set(number, value).result:
            reply = board.parameters.get(number)
            reason = "does not exist" if reply.result else f"does not take {value}"
            raise ValueError(f"network: nodes.{board.name}.parameters: parameter {number} {reason}")
