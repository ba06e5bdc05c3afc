"""The wired network on the project's own plant."""

from collections import Counter
from hashlib import sha256

import pytest

from boards.axis.firmware import AxisBoard
from boards.display.firmware import DisplayBoard
from bus.can import Frame
from bus.protocol import Device, Opcode, Reply, Result, pack_command, unpack_reply
from bus.protocol.report import pack_report, unpack_report
from bus.protocol.scales import rate_q16
from bus.protocol.serial import PacketDecoder
from bus.units import ARCSEC_PER_TURN
from plant.model import DEFAULT, load
from plant.plant import Plant
from scenarios.lab.network import Network, build
from scenarios.lab.networks import NetworkConfig, NodeConfig, config_from
from scenarios.lab.wiring import network as wired

CENTRE = 1 << 28
STEP_ARCSEC = ARCSEC_PER_TURN / (1 << 29)


class Night:
    def __init__(self, plant: str = DEFAULT, seed: int = 1, config: NetworkConfig | None = None) -> None:
        self.plant = Plant(load(plant), seed, {"ra": CENTRE, "dec": CENTRE, "focus": 7.0})
        self.network: Network = build(config, self.plant, seed)
        self.reports: list[tuple[int, bytes]] = []
        self.network.hid.to_host = lambda t_ns, report: self.reports.append((t_ns, report))
        self.wire_frames: list[tuple[int, Frame]] = []
        self.network.wire.tap(lambda t_ns, frame, _sender: self.wire_frames.append((t_ns, frame)))

    def run(self, seconds: float) -> None:
        self.network.run_until(self.network.queue.now_ns + round(seconds * 1e9))

    def command(self, device: int, opcode: int, *arguments: int) -> None:
        report = pack_report([pack_command(device, opcode, *arguments)])
        self.network.hid.write(self.network.queue.now_ns, report)

    @property
    def replies(self) -> list[Reply]:
        frames = [frame for _, report in self.reports for frame in unpack_report(report)]
        return [unpack_reply(frame.data) for frame in frames if 0x100 <= frame.identifier < 0x200]

    def digest(self) -> str:
        hash_ = sha256()
        for t_ns, frame in self.wire_frames:
            hash_.update(t_ns.to_bytes(8, "little") + frame.identifier.to_bytes(2, "little") + frame.data)
        return hash_.hexdigest()


def test_L2_eleven_nodes_talk_in_their_periods() -> None:
    night = Night()
    night.run(2.0)
    counts = Counter(frame.identifier for _, frame in night.wire_frames)
    expected = {
        "AXIS": (0x200, 200), "POSITION": (0x200, 400), "MOTOR": (0x200, 200), "FOCUS": (0x200, 40),
    }  # fmt: skip
    for device in Device:
        assert abs(counts[0x700 + device] - 2) <= 1, device.name
        base, count = expected.get(device.name.split("_")[0], (0x200, 0))
        assert abs(counts[base + device] - count) <= 1, device.name
        assert abs(counts[0x300 + device] - (8 if device in (0x11, 0x12, 0x21, 0x22) else 0)) <= 1
    assert all(frame.data[0] == frame.identifier & 0x7F for _, frame in night.wire_frames)
    assert sum(night.network.dropped.values()) == sum(night.network.overruns.values()) == 0
    assert 0.1 < night.network.wire.load < 0.2


def test_L2_everything_on_the_wire_reaches_the_pc_through_the_gateway() -> None:
    night = Night()
    night.run(1.0)
    through = Counter(frame for _, report in night.reports for frame in unpack_report(report))
    horizon = night.network.queue.now_ns - 20_000_000
    on_wire = Counter(frame for t_ns, frame in night.wire_frames if t_ns < horizon)
    assert not on_wire - through


def test_H2_power_up_with_health_check() -> None:
    night = Night()
    night.run(0.2)
    for device in Device:
        night.command(device, Opcode.PING)
        night.run(0.02)
    replies = {reply.device: reply for reply in night.replies}
    assert set(replies) == set(Device)
    assert all((reply.result, reply.value) == (Result.OK, 0) for reply in replies.values())


def test_L3_five_serial_lines() -> None:
    night = Night()
    packets: dict[str, list[bytes]] = {name: [] for name in night.network.uarts}
    for name, uart in night.network.uarts.items():
        uart.sink = lambda _t, packet, name=name: packets[name].append(packet)  # type: ignore[misc]
    night.run(2.0)
    assert set(packets) == {"AXIS_RA", "AXIS_DEC", "POSITION_RA", "POSITION_DEC", "FOCUS"}
    for name, chunks in packets.items():
        decoded = PacketDecoder().feed(b"".join(chunks))
        assert len(decoded) in (7, 8)
        assert {packet.device for packet in decoded} == {Device[name]}


def _pointing(plant: str, axis: str, seed: int) -> tuple[float, float]:
    """Largest true error, arcsec, from 8 s after the end of the profile on, and in the last 20 s."""
    night = Night(plant, seed)
    device = Device[f"AXIS_{axis.upper()}"]
    night.run(0.3)
    night.command(device, Opcode.POWER, 1)
    night.run(0.1)
    rate = rate_q16(15.041)
    target = CENTRE + round(5 * 3600 / STEP_ARCSEC)
    night.command(device, Opcode.MOVE_TO, target, 1)
    night.command(device, Opcode.TRACK_RATE, rate)
    night.run(0.05)
    board = night.network.boards[device.name]
    assert isinstance(board, AxisBoard)
    port = getattr(night.plant, axis)
    night.run(12.0)
    errors = []
    for _ in range(120):
        night.run(0.25)
        measured = port.absolute(night.network.queue.now_ns)
        errors.append(abs(board.motion.target_steps - measured) * STEP_ARCSEC)
    assert board.motion.settled
    return max(errors), max(errors[-80:])


@pytest.mark.parametrize("axis", ["ra", "dec"])
def test_B2_pointing_within_10_arcsec_and_tracking_stays_there(axis: str) -> None:
    largest, late = _pointing(DEFAULT, axis, seed=1)
    assert largest < 10.0
    assert late < 3.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3])
def test_B2_pointing_at_other_phases_of_the_encoders(seed: int) -> None:
    # High preload is left out: at tracking speed it is in limit cycles, as the paper's was (row E2).
    assert _pointing(DEFAULT, "ra", seed)[0] < 10.0


def test_P11_focus_by_the_gateway_and_on_the_display() -> None:
    night = Night()
    night.run(0.2)
    night.command(Device.FOCUS, Opcode.FOCUS_REFERENCE)
    night.run(4.0)
    night.command(Device.FOCUS, Opcode.FOCUS_MOVE_TO, -120)
    night.run(2.0)
    assert abs(night.plant.focus.position(night.network.queue.now_ns) + 120) < 1.0
    display = night.network.boards["DISPLAY"]
    assert isinstance(display, DisplayBoard)
    assert display.lines[2] == "FOC - 750.00  HOLD  "
    assert display.lines[0].startswith("RA  1")


def test_one_seed_one_trace() -> None:
    def digest(seed: int) -> str:
        night = Night(seed=seed)
        night.run(0.3)
        night.command(Device.AXIS_RA, Opcode.POWER, 1)
        night.run(0.1)
        night.command(Device.AXIS_RA, Opcode.SET_RATE, rate_q16(600.0))
        night.run(1.0)
        return night.digest()

    assert digest(5) == digest(5)
    assert digest(5) != digest(6)


@pytest.mark.parametrize("size", [4, 16, 64])
def test_B8_more_nodes(size: int) -> None:
    night = Night(config=NetworkConfig(size=size))
    assert len(night.network.boards) == size
    night.run(0.3)
    assert (
        len({frame.identifier for _, frame in night.wire_frames if frame.identifier & 0x780 == 0x200})
        >= size - 3
    )
    assert not sum(night.network.overruns.values())


def test_settings_reach_the_boards() -> None:
    config = config_from(
        {"bitrate": 500_000, "nodes": {"AXIS_RA": {"ppm": 0.0, "phase": 0.25, "parameters": {1: 20}}}},
        {"ra": (100, 200)},
    )
    network = Night(config=config).network
    board = network.boards["AXIS_RA"]
    assert isinstance(board, AxisBoard)
    assert board.counter.split == 20
    assert (board.motion.low, board.motion.high) == (100, 200)
    assert board.oscillator.local_ns(0) == 250_000_000
    assert network.wire.bitrate == 500_000


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (NetworkConfig(size=0), "size 0"),
        (NetworkConfig(size=65), "size 65"),
        (NetworkConfig(nodes={"AXIS_X": NodeConfig()}), "AXIS_X"),
        (NetworkConfig(nodes={"AXIS_RA": NodeConfig(parameters={1: 99})}), "does not take 99"),
        (NetworkConfig(nodes={"AXIS_RA": NodeConfig(parameters={77: 1})}), "77 does not exist"),
    ],
)
def test_bad_settings_are_named(config: NetworkConfig, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Night(config=config)


@pytest.mark.parametrize(("name", "number", "kept"), [("AXIS_RA", 1, True), ("WEATHER_MAST", 3, False)])
def test_what_a_loss_of_supply_does_to_parameters_is_what_their_page_says(
    name: str, number: int, kept: bool
) -> None:
    network = wired(network_name="final")
    board = network.boards[name]
    made = board.parameters.get(number).value
    assert board.parameters.set(number, made + 1).result is Result.OK
    board.power_off(0)
    board.power_on(0)
    network.run_until(1_000_000_000)
    assert board.on and board.boots == 2
    assert board.parameters.get(number).value == made + kept
