"""Which boards are on the bus, in the order they are wired, and what is set on them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from boards.core.declared import DeclaredBoard
from bus.protocol import Device
from bus.protocol.nodes import KINDS
from scenarios.lab.nodes import firmware_file, load_board
from scenarios.language.model import Scenario

LAB = (
    Device.AXIS_RA, Device.POSITION_RA, Device.MOTOR_RA_A, Device.MOTOR_RA_B, Device.AXIS_DEC,
    Device.POSITION_DEC, Device.MOTOR_DEC_A, Device.MOTOR_DEC_B, Device.GATEWAY, Device.FOCUS, Device.DISPLAY,
)  # fmt: skip
"""The ten nodes of L2 and the focus board; those that make up one axis first."""
SERIAL = (Device.AXIS_RA, Device.POSITION_RA, Device.AXIS_DEC, Device.POSITION_DEC, Device.FOCUS)
"""The five boards with RS232 (L3); the host reaches them by their serial lines."""
FINAL = (*LAB, *(device for kind in KINDS for device in kind.devices()))
"""All, the paper's "over sixteen" (B8). Which they are is an ASSUMPTION."""

NETWORKS: dict[str, tuple[Device, ...]] = {"lab": LAB, "serial": SERIAL, "final": FINAL}
"""By the name a scenario and the command line give them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeConfig:
    """What may be set per board.

    ppm, phase_ns: crystal error and phase; None: drawn from the seed. parameters: by number. inputs: those of
    a declared board, by pin. firmware: a file of C in the place of the board's own.
    """

    ppm: float | None = None
    phase_ns: int | None = None
    parameters: Mapping[int, int] = field(default_factory=dict)
    inputs: Mapping[str, Any] = field(default_factory=dict)
    firmware: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkConfig:
    """bitrate: of the CAN bus, bit/s. nodes: settings by board name. limits: soft limits (low, high)
    in steps by axis.

    name: which network (`scenarios/lab/networks.py`). extra: declared boards beside it.
    isolated: firmware in C runs in processes of its own.
    canopen: every board speaks CANopen, too (`boards/canopen/`); the host starts it.
    size: number of boards, None: those of the network. Fewer leaves out boards from its end, more adds motor
        velocity boards of unassigned device types (for scaling measurements).
    """

    bitrate: int = 1_000_000
    nodes: Mapping[str, NodeConfig] = field(default_factory=dict)
    limits: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    size: int | None = None
    name: str = "lab"
    extra: tuple[type[DeclaredBoard], ...] = ()
    canopen: bool = False
    isolated: bool = False

    def node(self, name: str) -> NodeConfig:
        """Settings of a board."""
        return self.nodes.get(name, NodeConfig())


def devices_of(config: NetworkConfig) -> tuple[Device, ...]:
    """The devices a configuration asks for; raises ValueError for a network nobody knows."""
    if config.name not in NETWORKS:
        known = ", ".join(NETWORKS)
        raise ValueError(f"network: there is no network '{config.name}'; expected one of {known}")
    own = dict.fromkeys(device for board in config.extra for device in board.KIND.devices())
    return NETWORKS[config.name] + tuple(device for device in own if device not in NETWORKS[config.name])


def devices_in(scenario: Scenario) -> tuple[Device, ...]:
    """The boards of a scenario's network, those of one's own too; raises as `devices_of` and `load_board`."""
    return devices_of(config_from(scenario.network, {}, scenario.file.parent))


def in_order(devices: Sequence[Device]) -> tuple[Device, ...]:
    """As a host expects boards: those of the protocol, in its order, then the declared ones."""
    written = tuple(device for device in Device if device in devices)
    return written + tuple(device for device in devices if device not in written)


def config_from(
    network: Mapping[str, Any], limits: Mapping[str, tuple[int, int]], folder: Path = Path()
) -> NetworkConfig:
    """The configuration of a scenario's checked `network` section (bit/s, s, ppm, parameters by number).

    folder: where its `boards` are looked for.
    """
    nodes = {
        name: NodeConfig(
            ppm=settings.get("ppm"),
            phase_ns=None if settings.get("phase") is None else round(settings["phase"] * 1e9),
            parameters={int(number): int(value) for number, value in settings.get("parameters", {}).items()},
            inputs=settings.get("inputs", {}),
            firmware=firmware_file(folder, settings["firmware"]) if "firmware" in settings else None,
        )
        for name, settings in network.get("nodes", {}).items()
    }
    extra: tuple[type[DeclaredBoard], ...] = ()
    for file in network.get("boards", ()):
        extra += (load_board(folder / file, extra),)
    return NetworkConfig(
        bitrate=round(network.get("bitrate", 1_000_000)),
        nodes=nodes,
        limits=dict(limits),
        name=network.get("name", "lab"),
        extra=extra,
        canopen=bool(network.get("canopen", False)),
        isolated=bool(network.get("isolated", False)),
    )
