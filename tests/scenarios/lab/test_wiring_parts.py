"""Which part of the plant is wired to which board, and what runs on it; the boards are stand-ins."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from boards.c.library import FirmwareError
from bus.protocol import Device
from bus.protocol.nodes import AUXILIARY, DOME
from plant.model import load
from plant.plant import Plant
from scenarios.lab import network
from scenarios.lab.network import _Wiring, build
from scenarios.lab.networks import LAB, NetworkConfig, NodeConfig, config_from, in_order

CONFIG = NetworkConfig()
WIRED = ("incremental", "absolute", "drive", "current", "tachometer_a", "tachometer_b")


class Desk:
    """Boards that are only what they are made of, on a plant of names."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.patch = monkeypatch
        for name in ("AxisBoard", "PositionBoard", "MotorVelocityBoard", "FirmwareBoard", "Chips", "Qei",
                     "EndatMaster", "EndatEncoder", "MotorPwm", "CurrentAdc"):  # fmt: skip
            monkeypatch.setattr(network, name, self.stand_in(name))
        for name in ("Memory", "IsolatedMemory"):
            monkeypatch.setattr(network, name, lambda file, name=name: f"{name} of {file}")
        settings = SimpleNamespace(pwm_steps=3000, pwm_hz=20_000.0)
        monkeypatch.setattr(network, "axis_config", lambda plant, axis, limits, bitrate: settings)
        monkeypatch.setattr(network, "programmed", lambda settings, peers: peers)
        axes = {axis: SimpleNamespace(**{k: f"{axis}.{k}" for k in WIRED}) for axis in ("ra", "dec")}
        monkeypatch.setattr(network, "AxisPins", SimpleNamespace)
        self.plant: Any = SimpleNamespace(**axes)
        monkeypatch.setattr(network, "Site", lambda *_: None)

    @staticmethod
    def stand_in(name: str) -> Any:
        return lambda *given, **more: (name, *given, *more.values())

    def wiring(self, config: NetworkConfig = CONFIG, devices: Any = LAB) -> Any:
        made: Any = _Wiring(config, self.plant, 1, devices, 0.5)
        made.place = lambda name, kind: name
        return made

    def with_c(self, device: Device, isolated: bool = False) -> Any:
        nodes = {device.name: NodeConfig(firmware=Path("own.c"))}
        return self.wiring(NetworkConfig(nodes=nodes, isolated=isolated))


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_soft_limits_are_the_whole_turn_unless_told(desk: Desk) -> None:
    """29 bits of the absolute encoder."""
    assert desk.wiring().limits("ra") == (0, (1 << 29) - 1)
    assert desk.wiring(NetworkConfig(limits={"ra": (5, 6)})).limits("ra") == (5, 6)


@pytest.mark.parametrize(("device", "position", "a", "b", "side"), [
    (Device.AXIS_RA, Device.POSITION_RA, Device.MOTOR_RA_A, Device.MOTOR_RA_B, "RA"),
    (Device.AXIS_DEC, Device.POSITION_DEC, Device.MOTOR_DEC_A, Device.MOTOR_DEC_B, "DEC"),
])  # fmt: skip
@pytest.mark.parametrize("beside", [False, True])
def test_an_axis_board_knows_its_peers(
    device: Device, position: Device, a: Device, b: Device, side: str, beside: bool, desk: Desk
) -> None:
    """An auxiliary board where the network has one."""
    auxiliary = AUXILIARY.nodes[f"AUXILIARY_{side}"]
    devices = (*LAB, auxiliary) if beside else LAB
    _, place, pins, _, peers = desk.wiring(devices=devices).axis(device)
    axis = side.lower()
    assert place == device.name
    wired = {"encoder": "incremental", "drive": "drive", "current": "current"}
    assert vars(pins) == {pin: f"{axis}.{part}" for pin, part in wired.items()}
    assert (peers.position, peers.motor_a, peers.motor_b) == (position, a, b)
    assert peers.auxiliary == (auxiliary if beside else None)


@pytest.mark.parametrize("isolated", [False, True])
def test_firmware_in_c_runs_here_or_in_a_process(isolated: bool, desk: Desk) -> None:
    memory = "IsolatedMemory of own.c" if isolated else "Memory of own.c"
    name, place, found, chips, _ = desk.with_c(Device.AXIS_RA, isolated).axis(Device.AXIS_RA)
    assert (name, place, found) == ("FirmwareBoard", "AXIS_RA", memory)
    pwm = ("MotorPwm", "ra.drive", 3000, 20_000.0)
    assert chips == ("Chips", ("Qei", "ra.incremental"), pwm, ("CurrentAdc", "ra.current"))
    assert desk.wiring().memory(Device.AXIS_RA) is None


def test_a_position_board_reads_the_absolute_encoder(desk: Desk) -> None:
    whole = (0, (1 << 29) - 1)
    made = desk.wiring().position(Device.POSITION_DEC)
    assert made == ("PositionBoard", "POSITION_DEC", "dec.absolute", *whole)
    *_, chips, limits = desk.with_c(Device.POSITION_RA).position(Device.POSITION_RA)
    assert chips == ("Chips", ("EndatMaster", ("EndatEncoder", "ra.absolute"))) and limits == whole


@pytest.mark.parametrize(("device", "encoder"), [
    (Device.MOTOR_RA_A, "ra.tachometer_a"), (Device.MOTOR_RA_B, "ra.tachometer_b"),
    (Device.MOTOR_DEC_B, "dec.tachometer_b"),
])  # fmt: skip
def test_a_motor_board_reads_its_own_motor(device: Device, encoder: str, desk: Desk) -> None:
    assert desk.wiring().motor(device) == ("MotorVelocityBoard", device.name, encoder)
    assert desk.with_c(device).motor(device)[3] == ("Chips", ("Qei", encoder))


@pytest.mark.parametrize(("file", "made"), [("x.elf", True), ("x.c", False), (None, False)])
def test_a_program_for_an_avr_runs_on_one(file: str | None, made: bool, desk: Desk) -> None:
    from boards import avr

    desk.patch.setattr(avr, "AvrBoard", lambda place, file: f"{place} runs {file}")
    nodes = {} if file is None else {"DISPLAY": NodeConfig(firmware=Path(file))}
    found = desk.wiring(NetworkConfig(nodes=nodes)).binary(Device.DISPLAY)
    assert found == ("DISPLAY runs x.elf" if made else None)


def test_firmware_that_cannot_be_loaded_is_named(desk: Desk) -> None:
    def broken(file: Path) -> None:
        raise FirmwareError("no compiler")

    desk.patch.setattr(network, "Memory", broken)
    with pytest.raises(ValueError, match=r"^network: nodes\.AXIS_RA\.firmware: no compiler$"):
        desk.with_c(Device.AXIS_RA).memory(Device.AXIS_RA)


@pytest.mark.parametrize("size", [0, 65])
def test_a_network_has_between_one_board_and_sixty_four(size: int) -> None:
    nothing: Any = None
    with pytest.raises(ValueError, match=rf"^network: size {size} is not within 1\.\.64$"):
        build(NetworkConfig(size=size), nothing, 1)


def test_one_board_is_a_network() -> None:
    assert list(build(NetworkConfig(size=1), Plant(load(), 1, {}), 1).boards) == ["AXIS_RA"]


@pytest.mark.parametrize(("node", "file", "canopen", "words"), [
    ("DISPLAY", "x.c", False, "C runs on boards AXIS_, POSITION_, MOTOR_ only"),
    ("AXIS_RA", "x.elf", False, "a program for an AVR runs on boards MOTOR_, DISPLAY only"),
    ("AXIS_RA", "x.c", True, "a board with firmware of its own has no CANopen voice"),
])  # fmt: skip
def test_firmware_that_cannot_be_on_a_board_is_refused(
    node: str, file: str, canopen: bool, words: str
) -> None:
    config = NetworkConfig(nodes={node: NodeConfig(firmware=Path(file))}, canopen=canopen)
    with pytest.raises(ValueError) as caught:
        build(config, Plant(load(), 1, {}), 1)
    assert str(caught.value) == f"network: nodes.{node}.firmware: {words}"


def test_spare_boards_read_both_motors_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """An odd device type is on motor B. No spare has the number of a board that is known."""
    spare: list[Any] = []
    velocity = _Wiring.velocity

    def made(wiring: Any, name: str, kind: int, encoder: Any) -> Any:
        spare.append((name, kind, encoder))
        return velocity(wiring, name, kind, encoder)

    monkeypatch.setattr(_Wiring, "velocity", made)
    plant = Plant(load(), 1, {})
    found = build(NetworkConfig(size=len(LAB) + 3), plant, 1)
    extra = [each for each in spare if each[1] not in LAB]
    assert [name for name, _, _ in extra] == list(found.boards)[len(LAB) :]
    for name, kind, encoder in extra:
        assert name == f"MOTOR_{kind:02X}"
        assert encoder == (plant.ra.tachometer_b if kind % 2 else plant.ra.tachometer_a)
    assert {kind % 2 for _, kind, _ in extra} == {0, 1} and found.dome is None


def test_a_host_expects_boards_of_the_protocol_first_in_its_order() -> None:
    dome = DOME.device("DOME")
    assert in_order([dome, Device.GATEWAY, Device.AXIS_RA]) == (Device.AXIS_RA, Device.GATEWAY, dome)


def test_a_phase_is_in_nanoseconds() -> None:
    assert config_from({"nodes": {"FOCUS": {"phase": 2.0}}}, {}).nodes["FOCUS"].phase_ns == 2_000_000_000


def test_a_network_that_says_nothing_is_the_usual_one() -> None:
    assert config_from({}, {}) == NetworkConfig()
    assert config_from({"isolated": True}, {}).isolated is True
