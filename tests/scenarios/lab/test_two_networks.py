"""Two networks in one process have boards of the same name and device type that differ in all else."""

from pathlib import Path

import pytest

from bus.can import Frame
from bus.conformance import Settings, run
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import Opcode, Result, pack_command, unpack_reply
from bus.protocol.nodes import KindError, arguments_of, documented
from scenarios.lab.network import Network
from scenarios.lab.networks import config_from, devices_of
from scenarios.lab.nodes import load_board
from scenarios.lab.prepare import chosen
from scenarios.lab.wiring import wire

DBC = """VERSION ""
BU_: GATEWAY NODE
BO_ 128 COMMAND: 8 GATEWAY
 SG_ Opcode M : 8|8@1+ (1,0) [0|255] "" NODE
 SG_ {word}_Value m80 : 16|{bits}@1+ (1,0) [0|{high}] "" NODE
BO_ 512 {word}: 8 NODE
 SG_ Value : 8|16@1+ (1,0) [0|65535] "" GATEWAY
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 512 {period};
VAL_ 128 Opcode 80 "{word}" ;
"""
PYTHON = """from pathlib import Path
from boards.core import Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol.nodes import Kind, ParameterRow
class Own(DeclaredBoard):
    KIND = Kind("{kind}", {{"{kind}": {number}}}, Path(__file__).with_name("own.dbc"),
                (ParameterRow(1, "most", 0, {high}, {high}),))
    TABLE = (Source("sample", priority=2, latency_cycles=12, cost_cycles=900),
             Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True))
    value = 0
    def measure(self, t_ns):
        return {{"Value": self.value}}
    def {lower}(self, t_ns, value):
        self.value = value
"""
YAML = (
    "name: own\nstart_utc: 2026-02-10T14:00:00Z\nnetwork: {boards: [own.py]}\nsteps: [{wait: {for: 1 s}}]\n"
)


def written(folder: Path, word: str, bits: int, kind: str = "FILTER", number: int = 0x76) -> Path:
    folder.mkdir()
    high = (1 << bits) - 1
    (folder / "own.dbc").write_text(DBC.format(word=word, bits=bits, high=high, period=2000 // bits))
    text = PYTHON.format(kind=kind, number=number, high=high, lower=word.lower())
    (folder / "own.py").write_text(text)
    (folder / "own.yaml").write_text(YAML)
    return folder


def wired(folder: Path) -> Network:
    return wire(*chosen(folder / "own.yaml"))


def test_two_networks_do_not_see_each_others_boards(tmp_path: Path) -> None:
    networks = [wired(written(tmp_path / word, word, bits)) for word, bits in (("WHEEL", 8), ("LAMP", 16))]
    without = wire(*chosen(None))
    said: list[dict[int, bytes]] = []
    for network in networks:
        heard: dict[int, bytes] = {}
        network.wire.tap(lambda _t, frame, _who, heard=heard: heard.__setitem__(frame.identifier, frame.data))
        said.append(heard)
    for network, heard, word, length in zip(networks, said, ("WHEEL", "LAMP"), (1, 2), strict=True):
        device = network.devices[-1]
        (opcode,) = arguments_of(device.declared)
        assert (device, device.name, int(opcode), opcode.name) == (0x76, "FILTER", 0x50, word)
        sent = pack_command(device, opcode, 200)
        assert sent == bytes([0x76, 0x50]) + (200).to_bytes(length, "little") + bytes(6 - length)
        network.wire.attach("pc").send(Frame(0x0F6, sent), 0)
        network.run_until(3_000_000_000)
        assert unpack_reply(heard[0x176]).result == Result.OK
        decoded = documented(network.devices).decode_message(0x276, heard[0x276])
        assert decoded == {"Device": "FILTER", "Value": 200}
        assert documented(network.devices).get_message_by_frame_id(0x276).name == f"FILTER_{word}"
    without.run_until(1_000_000_000)
    assert "FILTER" not in [device.name for device in without.devices] and "FILTER" not in without.boards


@pytest.mark.parametrize(("word", "bits", "beyond"), [("WHEEL", 8, "256"), ("LAMP", 16, "65536")])
def test_each_is_checked_by_its_own_declaration(tmp_path: Path, word: str, bits: int, beyond: str) -> None:
    networks = {w: wired(written(tmp_path / w, w, b)) for w, b in (("WHEEL", 8), ("LAMP", 16))}
    device = networks[word].devices[-1]
    with SchmidtBus(networks[word].wire) as bus:
        results = run(bus, devices=[device], settings=Settings(motion=True, period_tolerance=0.002))
    assert [result for result in results if not result.passed] == []
    said = {(result.check, result.subject) for result in results}
    assert {("period", f"FILTER_{word}"), ("out of range", f"FILTER SET_PARAMETER 1 {beyond}")} <= said
    assert any(subject.startswith(f"FILTER {word} ") for _, subject in said)
    assert Opcode.PING.declared is None


def test_boards_of_one_network_have_names_and_types_of_their_own(tmp_path: Path) -> None:
    first = written(tmp_path / "a", "WHEEL", 8)
    load = [load_board(first / "own.py")]
    assert load_board(first / "own.py", load) is load[0]
    with pytest.raises(KindError, match="board kind FILTER: declared twice, and differently"):
        load_board(written(tmp_path / "b", "LAMP", 16) / "own.py", load)
    with pytest.raises(KindError, match="board LAMP: name or device type 0x76 is taken"):
        load_board(written(tmp_path / "c", "LAMP", 16, "LAMP") / "own.py", load)
    with pytest.raises(KindError, match="declared twice"):
        config_from({"boards": ["a/own.py", "b/own.py"]}, {}, tmp_path)
    assert [d.name for d in devices_of(config_from({"boards": ["c/own.py"]}, {}, tmp_path))][-1] == "LAMP"


def test_a_scenario_may_take_the_supply_from_its_own_board(tmp_path: Path) -> None:
    folder = written(tmp_path / "own", "WHEEL", 8)
    (folder / "own.yaml").write_text(YAML + "faults: [{node_off: {node: FILTER}, at: 1 s}]\n")
    network = wired(folder)
    network.run_until(900_000_000)
    assert network.board("FILTER").on
    network.run_until(1_100_000_000)
    assert not network.board("FILTER").on
