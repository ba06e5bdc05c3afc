"""`canopen`'s own master, unmodified, on the emulated network; it reads each board's EDS."""

from collections.abc import Iterator
from pathlib import Path

import can
import canopen
import pytest
from canopen.sdo.exceptions import SdoAbortedError

from boards.canopen.dictionary import EMCY_BASE, FRAMES, PARAMETERS
from bus import protocol as p
from bus.outside.lockstep import LockstepBus
from plant.model import load
from plant.plant import Plant
from scenarios.commands.describing import write_eds
from scenarios.lab.network import Network, build
from scenarios.lab.networks import NetworkConfig

RA = p.Device.AXIS_RA
RATE_600 = 17_123_328
"""600"/s in Q16 counts per 5 ms: 600 / 1296000 turns of 112896000 counts, 1/200 s (paper, 2.2)."""


class Bench:
    """Network, plant and master; one thread, simulated time."""

    def __init__(self, folder: Path) -> None:
        sheets = {file.stem: str(file) for file in write_eds(folder)}
        self.plant = Plant(load(), 1)
        self.made: Network = build(NetworkConfig(canopen=True), self.plant, 1)
        self.master = canopen.Network()
        self.bus = LockstepBus(self.made.wire, self.hear)
        self.master.bus = self.bus
        self.heard: list[can.Message] = []
        for name, board in self.made.boards.items():
            node = canopen.RemoteNode(board.device_type, sheets[name.partition("_")[0].lower()])
            node.sdo.RESPONSE_TIMEOUT = 0.01  # the answer is there, or never comes
            self.master.add_node(node)
            self.master.subscribe(EMCY_BASE + board.device_type, node.emcy.on_emcy)
            assert name in self.made.voices

    def hear(self, message: can.Message) -> None:
        self.heard.append(message)
        self.master.notify(message.arbitration_id, message.data, message.timestamp)

    def command(self, opcode: int, *arguments: int) -> None:
        self.master.send_message(p.COMMAND_BASE + RA, p.pack_command(RA, opcode, *arguments))

    def rate_arcsec(self) -> float:
        """True rate of RA."""
        return self.plant.ra.truth(self.made.queue.now_ns)[1] * 206_264.806


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.bus.shutdown()


def test_the_master_brings_up_all_nodes_and_reads_who_they_are(bench: Bench) -> None:
    bench.bus.run(1.1)
    identifiers = {message.arbitration_id for message in bench.heard}
    stale = {EMCY_BASE + RA, EMCY_BASE + p.Device.AXIS_DEC}  # the encoders' boards are not started yet
    assert identifiers - stale == {0x700 + board.device_type for board in bench.made.boards.values()}
    for node in bench.master.values():
        assert node.nmt.state == "PRE-OPERATIONAL"
        assert node.sdo[0x1018][4].raw == node.id
        assert node.sdo[0x1018][2].raw == node.id >> 4
        assert node.sdo[0x1000].raw == 0
    bench.master.nmt.state = "OPERATIONAL"
    bench.bus.run(2.2)
    assert {node.nmt.state for node in bench.master.values()} == {"OPERATIONAL"}
    identifiers = {message.arbitration_id for message in bench.heard}
    assert {p.MEASUREMENT_BASE + RA, p.SUMMARY_BASE + RA, 0x380 + RA} <= identifiers
    bench.master.nmt.state = "STOPPED"
    bench.heard.clear()
    bench.bus.run(1.1)
    assert {message.arbitration_id for message in bench.heard} <= {0x700 + node for node in bench.master}


def test_the_mapped_pdos_are_the_documented_frames(bench: Bench) -> None:
    node = bench.master[RA]
    node.tpdo.read()
    assert [node.tpdo[k].cob_id for k in (1, 2, 3, 4)] == [0x111, 0x211, 0x311, 0x391]
    bench.master.nmt.state = "OPERATIONAL"
    bench.bus.run(0.1)
    motion = node.tpdo[2]
    assert motion[0].od.index == FRAMES
    data = motion[0].raw.to_bytes(8, "little")
    assert data[0] == RA
    assert p.unpack_motion(data).mode == p.AxisMode.OFF


def test_a_gain_set_by_sdo_shows_in_the_plant(bench: Bench) -> None:
    """Without integral action (and little proportional) the loop does not hold 600"/s; with the plant
    file's it does (paper, Fig. 10)."""
    node = bench.master[RA]
    bench.master.nmt.state = "OPERATIONAL"
    bench.bus.run(0.5)
    kp, ki = PARAMETERS + p.AxisParameter.KP_Q12, PARAMETERS + p.AxisParameter.KI_Q12
    before = node.sdo[kp].raw, node.sdo[ki].raw
    assert before == tuple(bench.made.boards["AXIS_RA"].parameters.get(number).value for number in (2, 3))
    node.sdo[kp].raw, node.sdo[ki].raw = 1, 0
    bench.command(p.Opcode.POWER, 1)
    bench.command(p.Opcode.SET_RATE, RATE_600)
    bench.bus.run(3.0)
    assert abs(bench.rate_arcsec()) < 60.0
    node.sdo[kp].raw, node.sdo[ki].raw = before
    bench.bus.run(5.0)
    assert bench.rate_arcsec() == pytest.approx(600.0, abs=60.0)


def test_what_cannot_be_is_refused_with_the_right_code(bench: Bench) -> None:
    sdo = bench.master[RA].sdo
    split = PARAMETERS + p.AxisParameter.COUNTER_SPLIT_PERCENT
    for value in (9, 26):
        with pytest.raises(SdoAbortedError) as refused:
            sdo[split].raw = value
        assert refused.value.code == 0x06090030
    assert sdo[split].raw == bench.made.boards["AXIS_RA"].parameters.get(1).value
    with pytest.raises(SdoAbortedError) as refused:
        sdo.upload(0x5000, 0)
    assert refused.value.code == 0x06020000


def _answers(bench: Bench, said: bytes) -> list[bytes]:
    """What the SDO server of RA says to `said`, sent as it is."""
    bench.heard.clear()
    bench.master.send_message(0x600 + RA, said)
    bench.bus.run(0.01)
    return [bytes(message.data) for message in bench.heard if message.arbitration_id == 0x580 + RA]


@pytest.mark.parametrize("said", [b"", b"\x01", b"\x02\x11\x00", b"\x50\x11", b"\x02\x12"])
def test_what_is_no_nmt_command_of_this_node_changes_nothing(bench: Bench, said: bytes) -> None:
    """Two bytes, and a command of CiA 301 (7.2.8.3)."""
    bench.bus.run(0.5)
    bench.master.send_message(0, said)
    bench.bus.run(0.1)
    assert bench.made.voices["AXIS_RA"].node.nmt.state == "PRE-OPERATIONAL"


@pytest.mark.parametrize("length", range(8))
def test_an_sdo_of_less_than_eight_bytes_is_ignored(
    bench: Bench, length: int, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.bus.run(0.5)
    assert _answers(bench, bytes.fromhex("4018100400000000")[:length]) == []
    assert bench.master[RA].sdo[0x1018][4].raw == RA
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("command", [0x60, 0x70, 0x00, 0x01, 0xE0, 0xC0])
def test_a_segment_of_no_transfer_is_aborted(
    bench: Bench, command: int, capfd: pytest.CaptureFixture[str]
) -> None:
    """Command specifier not valid (CiA 301, table 22)."""
    bench.bus.run(0.5)
    (answer,) = _answers(bench, bytes([command]) + bytes(7))
    assert (answer[0], int.from_bytes(answer[4:], "little")) == (0x80, 0x05040001)
    assert capfd.readouterr().err == ""


def test_a_transfer_ends_with_its_last_segment(bench: Bench) -> None:
    bench.bus.run(0.5)
    frames = FRAMES.to_bytes(2, "little")
    assert _answers(bench, b"\x40" + frames + b"\x01\0\0\0\0")[0][0] == 0x41
    assert [_answers(bench, bytes([command]) + bytes(7))[0][0] for command in (0x60, 0x70)] == [0x00, 0x1D]
    assert _answers(bench, b"\x60" + bytes(7))[0][0] == 0x80
    assert _answers(bench, b"\x21" + frames + b"\x01\x08\0\0\0")[0][0] == 0x60
    assert _answers(bench, b"\x00" + bytes(7))[0][0] == 0x20
    (answer,) = _answers(bench, b"\x10" + bytes(7))
    assert int.from_bytes(answer[4:], "little") == 0x06070012


def test_a_stopped_node_takes_no_parameters(bench: Bench) -> None:
    """Without SDO in STOPPED (CiA 301, table 39)."""
    bench.bus.run(0.5)
    kp = PARAMETERS + p.AxisParameter.KP_Q12
    before = bench.master[RA].sdo[kp].raw
    bench.master[RA].nmt.state = "STOPPED"
    bench.bus.run(0.01)
    assert _answers(bench, b"\x23" + kp.to_bytes(2, "little") + b"\0\x01\0\0\0") == []
    bench.master[RA].nmt.state = "PRE-OPERATIONAL"
    bench.bus.run(0.01)
    assert bench.master[RA].sdo[kp].raw == before


def test_a_fault_is_an_emergency_and_its_end_too(bench: Bench) -> None:
    node = bench.master[RA]
    bench.master.nmt.state = "OPERATIONAL"
    bench.bus.run(0.5)
    node.emcy.reset()
    bench.made.boards["POSITION_RA"].power_off(bench.made.queue.now_ns)
    bench.bus.run(0.5)
    assert [error.code for error in node.emcy.active] == [0x8100]
    assert node.sdo[0x1001].raw == 0x11
    bench.made.boards["POSITION_RA"].power_on(bench.made.queue.now_ns)
    bench.bus.run(1.0)
    assert bench.master[p.Device.POSITION_RA].nmt.state == "PRE-OPERATIONAL"
    bench.master[p.Device.POSITION_RA].nmt.state = "OPERATIONAL"
    bench.bus.run(0.5)
    assert node.emcy.active == []


def test_a_reset_boots_the_board_again(bench: Bench) -> None:
    bench.master.nmt.state = "OPERATIONAL"
    bench.bus.run(0.2)
    bench.heard.clear()
    bench.master[RA].nmt.send_command(0x81)
    bench.bus.run(0.6)
    boots = [m for m in bench.heard if m.arbitration_id == 0x700 + RA and bytes(m.data) == b"\0"]
    assert len(boots) == 1
    assert bench.made.voices["AXIS_RA"].node.nmt.state == "PRE-OPERATIONAL"


def test_an_eds_per_board_type(tmp_path: Path) -> None:
    files = write_eds(tmp_path)
    assert [file.name for file in files] == [
        "axis.eds", "display.eds", "focus.eds", "gateway.eds", "motor.eds", "position.eds",
        "canopen.dbc",
    ]  # fmt: skip
    for file in files[:-1]:
        found = canopen.import_od(str(file))
        assert {0x1000, 0x1001, 0x1017, 0x1018, 0x1400, 0x1600, 0x1800, 0x1A00} <= set(found)
    axis = canopen.import_od(str(tmp_path / "axis.eds"))
    split = axis[PARAMETERS + 1]
    assert (split.name, split.min, split.max) == ("counter_split_percent", 10, 25)


def test_a_network_without_it_is_as_it_was() -> None:
    made = build(NetworkConfig(), Plant(load(), 1), 1)
    assert made.voices == {}


def test_every_type_of_the_final_network_has_a_product_code_of_its_own(tmp_path: Path) -> None:
    files = write_eds(tmp_path, name="final")
    assert {"auxiliary", "dome", "weather", "power"} <= {file.stem for file in files}
    codes = [canopen.import_od(str(file))[0x1018][2].default for file in files[:-1]]
    assert len(set(codes)) == len(codes) == 10
