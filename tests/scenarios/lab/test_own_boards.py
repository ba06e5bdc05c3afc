"""A user's board that fails is one line that names board, file and simulated time."""

from pathlib import Path

import pytest

from boards.core.declared import BoardError
from bus.can import Frame
from bus.protocol import COMMAND_BASE, Opcode, pack_command
from scenarios.lab.network import Network
from scenarios.lab.prepare import prepare
from scenarios.lab.wiring import wire
from tests.scenarios.conftest import Command

DBC = """VERSION ""

BU_: GATEWAY NODE

BO_ 128 COMMAND: 8 GATEWAY
 SG_ Opcode M : 8|8@1+ (1,0) [0|255] "" NODE
 SG_ Heat_Percent m80 : 16|8@1+ (1,0) [0|100] "%" NODE

BO_ 512 CELL: 8 NODE
 SG_ Temperature : 16|16@1- (0.01,0) [-40|60] "degC" GATEWAY

BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 512 500;
VAL_ 128 Opcode 80 "HEAT" ;
"""
NO_INTEGER = "(Bad.TABLE: Source|cannot be imported: TypeError: int object expected)"
"""Of a row: what is said of it, and what the compiled library says itself."""
KIND_END = '.with_name("bad.dbc"))'
BOARD = """import sys
from pathlib import Path
from boards.core import Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol.nodes import Kind
from bus.protocol.nodes.kind import ParameterRow


class Bad(DeclaredBoard):
    KIND = Kind("BAD", {"BAD": 0x76}, Path(__file__).with_name("bad.dbc"))
    TABLE = (
        Source("sample", priority=2, latency_cycles=12, cost_cycles=900),
        Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
    )

    def measure(self, t_ns):
        MEASURE

    def heat(self, t_ns, percent):
        HEAT
"""
GOOD = "return {'Temperature': 1.0}"
SCENARIO = """name: bad
start_utc: 2026-02-10T14:00:00Z
network: {boards: [bad.py]}
steps:
  - wait: {for: 3 s}
"""


def write(folder: Path, measure: str = GOOD, heat: str = "return None") -> Path:
    (folder / "bad.dbc").write_text(DBC)
    (folder / "bad.py").write_text(BOARD.replace("MEASURE", measure).replace("HEAT", heat))
    (folder / "bad.yaml").write_text(SCENARIO)
    return folder / "bad.yaml"


def made(file: Path) -> Network:
    return wire(*prepare(file))


@pytest.mark.parametrize(
    ("measure", "words"),
    [
        ("return {'Temperature': 'warm'}", "measure returned Temperature as str, expected a number"),
        ("return {'Temperature': float('nan')}", "measure returned Temperature that is no finite number"),
        ("return {'Temperature': 10**400}", "measure returned Temperature that is no finite number"),
        ("return 'warm'", "measure returned str, expected a mapping of signals"),
        ("return None", "measure returned NoneType, expected a mapping of signals"),
        ("return 1 / 0", "ZeroDivisionError: division by zero"),
        ("raise KeyError('no')", "KeyError: 'no'"),
        ("sys.exit(3)", "SystemExit: 3"),
        ("sys.exit()", "SystemExit"),
        ("raise GeneratorExit", "GeneratorExit"),
        ("raise BaseException('out')", "BaseException: out"),
        ("raise type('Mute', (Exception,), {'__str__': lambda self: 1 / 0})", "Mute"),
        ("return {'Temprature': 1.0}", "LookupError: measure returned Temprature, which no frame has"),
    ],
)
def test_a_board_that_fails_is_named_with_file_and_time(measure: str, words: str, tmp_path: Path) -> None:
    network = made(write(tmp_path, f"{GOOD[:6]} {GOOD[7:]} if t_ns < 1_200_000_000 else self.bad()"
                                   f"\n\n    def bad(self):\n        {measure}"))  # fmt: skip
    with pytest.raises(BoardError) as caught:
        network.run_until(3_000_000_000)
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / 'bad.py'}: board BAD fails at 1.")
    assert text.endswith(f" s: {words}")


@pytest.mark.parametrize(
    "heat", ["return 'hot'", "return (0, 0, 10**400)", "sys.exit()", "raise OSError('x')"]
)
def test_a_command_that_fails_is_named_too(heat: str, tmp_path: Path) -> None:
    network = made(write(tmp_path, heat=heat))
    pc = network.wire.attach("pc")
    pc.send(Frame(COMMAND_BASE + 0x76, bytes((0x76, 80, 5, 0, 0, 0, 0, 0))), 0)
    with pytest.raises(BoardError, match=r"bad.py: board BAD fails at 0\.0\d+ s: "):
        network.run_until(1_000_000_000)


@pytest.mark.parametrize("method", ["state", "health"])
def test_what_no_frame_can_hold_is_named_too(method: str, tmp_path: Path) -> None:
    network = made(write(tmp_path, heat=f"return None\n\n    def {method}(self):\n        return 'well'"))
    pc = network.wire.attach("pc")
    pc.send(Frame(COMMAND_BASE + 0x76, pack_command(0x76, Opcode.PING)), 0)
    with pytest.raises(BoardError, match=rf"bad.py: board BAD fails at 0\.\d+ s: {method} cannot be sent: "):
        network.run_until(1_500_000_000)


def test_it_is_one_line_of_the_command(tmp_path: Path, schmidt: Command) -> None:
    done = schmidt("run", write(tmp_path, "sys.exit(0)"), "--no-report")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "board BAD fails at" in done.stderr and done.stderr.endswith("SystemExit: 0\n")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("import sys\n", "import sys\nsys.exit(4)\n", "bad.py: cannot be imported: SystemExit: 4"),
        ("    KIND = Kind(", "    KIND = (", "bad.py: Bad.KIND cannot be used"),
        ("    def measure", "    def reset(self):\n        sys.exit(5)\n\n    def measure",
         "board BAD fails at 0 s: SystemExit: 5"),
        ("    def measure", "    class PART:\n        def __init__(self, more): pass\n\n    def measure",
         "board BAD fails at 0 s: TypeError"),
        ("    def measure", "    def __new__(cls, *given):\n        return 5\n\n    def measure",
         "board BAD fails at 0 s: TypeError: its class makes a int"),
        ("cost_cycles=900", "cost_cycles=10**30", "bad.py: Bad.TABLE: Source"),
        ("cost_cycles=900", "cost_cycles=float('nan')", f"bad.py: {NO_INTEGER}"),
        ("latency_cycles=12, cost", "latency_cycles=-12, cost", "bad.py: Bad.TABLE: Source"),
        (KIND_END, f"{KIND_END[:-1]}, (ParameterRow(1, 'a', 0, 5, 9),))", "Bad.KIND: parameter a: low"),
        (KIND_END, f"{KIND_END[:-1]}, (ParameterRow(1, 'a', 0, 5, 2.5),))", "Bad.KIND: parameter a: low"),
        ("cost_cycles=900", "cost_cycles=1.5", f"bad.py: {NO_INTEGER}"),
        (KIND_END, f"{KIND_END[:-1]}, (ParameterRow(999, 'a', 0, 5, 1),))", "parameter a: its number is 1"),
        ("    def measure", "    PINS = (Pin('a', default=float('nan')),)\n\n    def measure", "Bad.PINS: a"),
        ("    def measure", "    PINS = (Pin('a'), Pin('a'))\n\n    def measure", "Bad.PINS: a"),
        (KIND_END, ".parent)", "it is no regular file"),
    ],
)  # fmt: skip
def test_a_board_that_cannot_be_made_is_named(old: str, new: str, words: str, tmp_path: Path) -> None:
    file = write(tmp_path)
    board = file.with_name("bad.py")
    board.write_text(board.read_text().replace(old, new))
    with pytest.raises(ValueError, match=words.replace(".", r"\.")):
        made(file)


@pytest.mark.parametrize(
    ("old", "new"), [("16|8@1+", "0|8@1+"), ("m80 :", "m1 :"), ("SG_ Temperature", "SG_ Device")]
)
def test_frames_whose_signals_overlap_are_refused(old: str, new: str, tmp_path: Path) -> None:
    file = write(tmp_path)
    file.with_name("bad.dbc").write_text(DBC.replace(old, new))
    with pytest.raises(ValueError, match=r"bad\.dbc: The signals \w+ and \w+ are overlapping"):
        made(file)
