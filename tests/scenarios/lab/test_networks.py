"""Named networks (L2, L3, B8) and the planned nodes on them."""

from pathlib import Path

import pytest

from boards.core.declared import DeclaredBoard
from boards.dome.firmware import DomeBoard
from bus.can import Frame
from bus.conformance import Settings, run
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import Device, Health, Opcode, Result, State, pack_command, unpack_heartbeat, unpack_reply
from bus.protocol.nodes import DOME, POWER, FrameCodec, arguments_of, documented
from bus.protocol.serial import AxisSample, PacketDecoder
from plant.model import load
from plant.plant import Plant
from scenarios.lab.network import Network, build
from scenarios.lab.networks import FINAL, LAB, NETWORKS, SERIAL, NetworkConfig, NodeConfig
from scenarios.lab.prepare import chosen, prepare
from scenarios.lab.wiring import wire
from scenarios.language.document import ScenarioError
from scenarios.run.run import Way
from scenarios.run.run import run as execute

SECOND_NS = 1_000_000_000
CODECS = {m.name: FrameCodec(m) for m in documented(FINAL).messages if m.cycle_time}


class Site:
    """The final network and a node on its bus."""

    def __init__(self, **inputs: dict[str, float | list[dict[str, float]]]) -> None:
        nodes = {name: NodeConfig(inputs=given) for name, given in inputs.items()}
        plant = Plant(load(), 1, {"ra": 1 << 28, "dec": 1 << 27})
        self.network: Network = build(NetworkConfig(nodes=nodes, name="final"), plant, 1)
        self.last: dict[int, bytes] = {}
        self.network.wire.tap(lambda _t, frame, _sender: self.last.__setitem__(frame.identifier, frame.data))
        self.pc = self.network.wire.attach("pc")

    def run(self, seconds: float) -> None:
        self.network.run_until(self.network.queue.now_ns + round(seconds * SECOND_NS))

    def said(self, name: str) -> dict[str, float]:
        codec = CODECS[name]
        return codec.unpack(self.last[codec.identifier])

    def ask(self, device: int, opcode: int, *arguments: int) -> Result:
        self.pc.send(
            Frame(0x080 + device, pack_command(device, opcode, *arguments)), self.network.queue.now_ns
        )
        self.run(0.02)
        return Result(unpack_reply(self.last[0x100 + device]).result)


def test_L2_L3_B8_the_networks_are_the_papers() -> None:
    assert len(set(LAB) - {Device.FOCUS}) == 10
    assert {device.name for device in SERIAL} == {
        "AXIS_RA",
        "AXIS_DEC",
        "POSITION_RA",
        "POSITION_DEC",
        "FOCUS",
    }
    assert set(LAB) < set(FINAL)
    assert len(set(FINAL)) > 16


@pytest.mark.parametrize("name", ["serial", "final"])
def test_B8_conformance_passes_on_what_the_lab_does_not_have(name: str) -> None:
    devices = NETWORKS[name] if name == "serial" else tuple(set(FINAL) - set(LAB))
    network = wire(*chosen(network_name=name))
    with SchmidtBus(network.wire) as bus:
        results = run(bus, devices=devices, settings=Settings(motion=True, period_tolerance=0.002))
    assert [result for result in results if not result.passed] == []
    assert not sum(network.overruns.values()) and not sum(network.dropped.values())
    if name == "final":  # motion was asked for: the dome was sent round, and is stopped at the end
        dome = network.board("DOME")
        assert isinstance(dome, DomeBoard)
        assert dome.target != 0 and not dome.seeking and not dome.direction and not dome.sliding


def test_P13_the_stations_measure_what_the_scenario_says_and_hold_unsafe() -> None:
    site = Site(
        WEATHER_MAST={"wind": [{"at": 3.0, "value": 20.0}, {"at": 6.0, "value": 1.0}], "temperature": -3.0},
        WEATHER_DOME={"humidity": 64.0},
    )
    site.run(2.9)
    mast = site.said("WEATHER_MAST_WEATHER")
    assert (mast["Unsafe"], mast["Windy"]) == (0, 0)
    assert mast["Temperature"] == pytest.approx(-3.0, abs=100 / 1023)  # ADC: -40..60 degC in 1023 steps
    assert site.said("WEATHER_DOME_WEATHER")["Humidity"] == pytest.approx(64.0, abs=0.15)
    site.run(2.0)
    mast = site.said("WEATHER_MAST_WEATHER")
    assert (mast["Unsafe"], mast["Windy"]) == (1, 1)
    assert mast["Wind"] == pytest.approx(20.0, abs=0.1)
    site.run(4.0)
    mast = site.said("WEATHER_MAST_WEATHER")
    assert (mast["Unsafe"], mast["Windy"]) == (1, 0)  # held for 300 s


@pytest.mark.slow
def test_P13_the_dome_turns_the_shorter_way_and_closes_in_bad_weather() -> None:
    site = Site(WEATHER_MAST={"rain": [{"at": 45.0, "value": 1}]})
    dome = DOME.device("DOME")
    goto, shutter, _ = arguments_of(DOME)
    site.run(1.0)
    assert site.ask(dome, goto, 34000) is Result.OK  # 340 deg: 20 deg backwards
    assert site.ask(dome, shutter, 1) is Result.OK
    site.run(5.0)
    assert site.said("DOME_DOME")["Azimuth"] > 340
    assert site.said("DOME_DOME")["Moving"] == 1
    assert unpack_heartbeat(site.last[0x700 + dome]).state == State.ACTIVE
    site.run(30.0)
    there = site.said("DOME_DOME")
    assert there["Azimuth"] == pytest.approx(340.0, abs=0.6)  # parameter 1: 0.5 deg, encoder 0.1 deg
    assert (there["Moving"], there["Opened"], there["Shutter"]) == (0, 1, 100)
    site.run(12.0)
    assert site.said("DOME_DOME")["BadWeather"] == 1
    site.run(35.0)
    assert site.said("DOME_DOME")["Closed"] == 1
    assert site.ask(dome, shutter, 1) is Result.NOT_ALLOWED


def test_P13_a_silent_station_is_bad_weather() -> None:
    site = Site()
    site.run(2.0)
    site.network.board("WEATHER_MAST").power_off(site.network.queue.now_ns)
    site.run(11.0)
    assert site.said("DOME_DOME")["BadWeather"] == 1
    assert site.ask(0x71, Opcode.PING) is Result.OK
    assert unpack_reply(site.last[0x171]).value == Health.STALE


def test_B8_a_relay_takes_the_supply_of_its_boards_and_gives_it_back() -> None:
    site = Site()
    site.run(1.0)
    power = POWER.device("POWER_DRIVES")
    (relay,) = arguments_of(POWER)
    before = site.said("POWER_DRIVES_POWER")
    assert before["Voltage"] == pytest.approx(24.0, abs=0.05)
    assert site.ask(power, relay, 3, 0) is Result.OK  # POSITION_RA
    site.last.clear()
    site.run(1.0)
    assert 0x221 not in site.last
    after = site.said("POWER_DRIVES_POWER")
    assert after["Relays"] == 0xFB
    assert before["Current"] - after["Current"] == pytest.approx(0.15, abs=0.06)  # a board less, ADC of 39 mA
    assert site.ask(power, relay, 3, 1) is Result.OK
    site.run(1.0)
    assert 0x221 in site.last


def test_P10_the_auxiliary_encoder_reads_10_8_turns_per_turn_of_the_axis() -> None:
    site = Site()
    site.run(0.5)
    plant = site.network.plant
    for side, name in (("ra", "AUXILIARY_RA"), ("dec", "AUXILIARY_DEC")):
        steps = int(site.said(f"{name}_ENCODER")["Position"])
        assert abs(steps - getattr(plant, side).auxiliary(site.network.queue.now_ns)) <= 1


@pytest.mark.parametrize("arcsec_s", [0.0, 600.0, -3600.0])
def test_P10_the_axis_log_has_the_auxiliary_encoder_at_the_moment_of_the_shafts(arcsec_s: float) -> None:
    """Both columns are the axis' angle: steps of 0.002414″ and, through 1:10.8, of 0.9155″ (hardware.md 1.3).
    Between two frames of 10 ms the reading is carried on: two counts at 600″/s, six at a slew's 3600″/s with
    its 33 a frame."""
    site = Site()
    site.run(0.5)
    packets: list[bytes] = []
    site.network.uarts["AXIS_RA"].sink = lambda _t, packet: packets.append(packet)
    axis = Device.AXIS_RA
    assert site.ask(axis, Opcode.POWER, 1) is Result.OK
    assert site.ask(axis, Opcode.SET_RATE, round(arcsec_s * 0.005 / 0.0114827 * 65536)) is Result.OK
    site.run(4.0)
    samples = [AxisSample(*row) for p in PacketDecoder().feed(b"".join(packets)) for row in p.rows][-100:]
    wrong = []
    for sample in samples:
        counts = sample.position * 1296000 / 2**29 / (1296000 / 10.8 / 2**17)
        wrong.append((sample.aux - counts + 2**16) % 2**17 - 2**16)
    assert max(map(abs, wrong)) <= (2 if abs(arcsec_s) < 1000 else 6), (min(wrong), max(wrong))
    assert (len({sample.aux for sample in samples}) == 1) == (not arcsec_s)


def test_P10_without_auxiliary_boards_the_column_is_zero() -> None:
    site = Site()
    for name in ("AUXILIARY_RA", "AUXILIARY_DEC"):
        site.network.board(name).power_off(0)
    packets: list[bytes] = []
    site.network.uarts["AXIS_DEC"].sink = lambda _t, packet: packets.append(packet)
    site.run(1.1)
    found = [AxisSample(*row) for p in PacketDecoder().feed(b"".join(packets)) for row in p.rows]
    assert found and not any(sample.aux for sample in found)


def test_B9_declared_boards_send_rs232_packets() -> None:
    site = Site()
    packets: list[bytes] = []
    uart = site.network.uarts["AUXILIARY_RA"]
    uart.sink = lambda _t, packet: packets.append(packet)
    site.run(1.1)
    found = PacketDecoder({0x23}).feed(b"".join(packets))
    assert [packet.sequence for packet in found] == [0, 1, 2, 3]
    sequences = [sample[6] for packet in found for sample in packet.rows]
    assert sequences == list(range(1, 101))  # byte 7 of ENCODER counts the frames


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (NetworkConfig(name="finale"), "no network 'finale'; expected one of lab, serial, final"),
        (
            NetworkConfig(name="final", nodes={"WEATHER_DOME": NodeConfig(inputs={"ice": 1})}),
            "no input 'ice'",
        ),
        (NetworkConfig(name="final", nodes={"DOME": NodeConfig(inputs={"wind": 1})}), "it has none"),
        (NetworkConfig(nodes={"DOME": NodeConfig()}), "no board 'DOME'"),
    ],
)
def test_what_a_network_cannot_have_is_one_line(config: NetworkConfig, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        build(config, Plant(load(), 1), 1)


def test_a_scenario_names_its_network(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    file.write_text(
        "name: x\nstart_utc: 2026-02-10T14:00:00Z\n"
        "network: {name: final, nodes: {WEATHER_MAST: {inputs: {rain: [{at: 1 min, value: 1}]}}}}\n"
        "steps: [{wait: {for: 1 s}}]\n"
    )
    made = wire(*chosen(file))
    assert len(made.boards) == 18
    mast = made.board("WEATHER_MAST")
    assert isinstance(mast, DeclaredBoard)
    assert [mast.read("rain", t * SECOND_NS) for t in (0, 59, 60)] == [0, 0, 1]


def test_a_step_or_fault_of_a_board_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    start = "name: x\nstart_utc: 2026-02-10T14:00:00Z\nnetwork: {name: serial}\nsteps:\n  - "
    for text in ("display: {brightness: 5}\n", "wait: {for: 1 s}\nfaults: [{node_off: {node: GATEWAY}}]\n"):
        file.write_text(start + text)
        with pytest.raises(ScenarioError, match=r"x\.yaml:\d+: the network 'serial' has no board"):
            prepare(file)


@pytest.mark.slow
def test_L3_the_host_runs_the_five_boards_by_their_serial_lines(tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    file.write_text(
        "name: x\nstart_utc: 2026-02-10T14:00:00Z\nnetwork: {name: serial}\n"
        "plant: {file: low-preload-bridge, mount: false}\nsteps:\n"
        "  - power_on: {}\n  - name: go\n    goto: {target: {ra: '04:31:00.0', dec: '+29:40:00'}}\n"
        "  - name: follow\n    track: {for: 8 s}\n"
        "expect: [{pointing_error: {during: follow, settle: 3 s, source: truth, at_most: 10 arcsec}},"
        " {error_log_entries: {at_most: 0}}]\n"
    )
    scenario, model = prepare(file)
    result = execute(scenario, model, tmp_path / "out", lambda *_: None, Way(report=False))
    assert result.passed, result.verdicts
