"""What a CANopen master expects, by `canopen`'s own master from the EDS alone; and a host that needs none."""

import configparser
import re
from collections.abc import Iterator
from pathlib import Path

import cantools
import pytest
from canopen.sdo.exceptions import SdoAbortedError

from bus import protocol as p
from scenarios.commands.describing import write_eds
from tests.boards.canopen.test_voice import RA, Bench

MASTER = 0x7F
_EVENT = 0xFF


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    made.bus.run(0.5)
    made.master.nmt.state = "OPERATIONAL"
    made.heard.clear()
    yield made
    made.bus.shutdown()


def heard(bench: Bench, identifier: int) -> list[bytes]:
    return [bytes(each.data) for each in bench.heard if each.arbitration_id == identifier]


def refused(bench: Bench, index: int, sub: int, value: int, size: int = 4, node: int = RA) -> int:
    with pytest.raises(SdoAbortedError) as aborted:
        bench.master[node].sdo.download(index, sub, value.to_bytes(size, "little"))
    return aborted.value.code


@pytest.mark.parametrize(("kind", "frames"), [(1, 6), (3, 2), (0, 6), (240, 0)])
def test_a_synchronous_pdo_comes_with_sync(bench: Bench, kind: int, frames: int) -> None:
    motion = bench.master[RA].tpdo[2]
    motion.read()
    motion.trans_type = kind
    motion.save()
    bench.bus.run(0.1)
    bench.heard.clear()
    bench.bus.run(0.1)
    assert heard(bench, 0x211) == []
    for _ in range(6):
        bench.master.sync.transmit()
        bench.bus.run(0.02)
    assert len(heard(bench, 0x211)) == frames
    motion.trans_type = _EVENT
    motion.save()
    bench.heard.clear()
    bench.bus.run(0.1)
    assert len(heard(bench, 0x211)) >= 9  # every 10 ms, as documented


def test_a_pdo_is_moved_and_mapped_anew(bench: Bench) -> None:
    node = bench.master[RA]
    motion = node.tpdo[2]
    motion.read()
    motion.cob_id = 0x381
    motion.clear()
    motion.add_variable("kp_q12")
    motion.add_variable("ki_q12")
    motion.save()
    bench.heard.clear()
    bench.bus.run(0.1)
    assert heard(bench, 0x211) == []
    assert set(heard(bench, 0x381)) == {
        b"".join(node.sdo[k].raw.to_bytes(4, "little") for k in ("kp_q12", "ki_q12"))
    }
    assert motion["kp_q12"].raw == node.sdo["kp_q12"].raw


def test_parameters_come_by_pdo_at_the_next_sync(bench: Bench) -> None:
    node = bench.master[RA]
    command = node.rpdo[1]
    command.read()
    command.cob_id, command.trans_type = 0x401, 1
    command.clear()
    command.add_variable("kp_q12")
    command.save()
    before = node.sdo["kp_q12"].raw
    command["kp_q12"].raw = before + 5
    command.transmit()
    assert node.sdo["kp_q12"].raw == before
    bench.master.sync.transmit()
    assert node.sdo["kp_q12"].raw == before + 5
    bench.command(p.Opcode.PING)  # COMMAND has no place any more
    assert heard(bench, 0x111) == []
    bench.master.send_message(0x401, b"\1\2")
    bench.master.sync.transmit()
    assert node.emcy.log[-1].code == 0x8210


@pytest.mark.parametrize(
    ("index", "sub", "value", "code"),
    [
        (0x1801, 1, 0x381, 0x06090030),  # moved while it is valid
        (0x1801, 1, 1 << 31 | 0x601, 0x06090030),  # where SDO is
        (0x1801, 1, 1 << 31 | 1 << 29 | 0x211, 0x06090030),  # 29 bits
        (0x1A01, 1, 0x21020020, 0x08000022),  # mapped while it is valid
        (0x1005, 0, 1 << 30 | 0x80, 0x06090030),  # these boards produce no SYNC
        (0x1010, 1, 1, 0x08000020),
        (0x1011, 1, int.from_bytes(b"save", "little"), 0x08000020),
        (0x1014, 0, 0x191, 0x06010002),
        (0x1000, 0, 1, 0x06010002),
        (0x1005, 0, 0x85, 0x06090030),  # where commands are: it would never be heard as SYNC
        (0x1005, 0, 0x611, 0x06090030),
        (0x1005, 1, 0x80, 0x06090011),
        (0x1016, 5, 0x7F0064, 0x06090011),
    ],
)  # fmt: skip
def test_what_cannot_be_set_is_refused(bench: Bench, index: int, sub: int, value: int, code: int) -> None:
    assert refused(bench, index, sub, value) == code


def test_what_cannot_be_mapped_is_refused(bench: Bench) -> None:
    sdo = bench.master[RA].sdo
    assert refused(bench, 0x1801, 2, 241, 1) == 0x06090030
    sdo[0x1801][1].raw = 1 << 31 | 0x211
    sdo[0x1A01][0].raw = 0
    for entry in (0x10000020, 0x21020010, 0x50000020, 0x21020120):  # not mappable, size, index, sub-index
        assert refused(bench, 0x1A01, 1, entry) == 0x06040041
    for at in (1, 2, 3):
        sdo[0x1A01][at].raw = 0x21020020
    assert refused(bench, 0x1A01, 0, 3, 1) == 0x06040042
    sdo[0x1A01][0].raw = 2
    assert refused(bench, 0x1A01, 1, 0x21030020) == 0x08000022


def test_a_dead_master_is_noticed_and_its_return(bench: Bench) -> None:
    node = bench.master[p.Device.DISPLAY]  # an axis board would miss its encoder, too
    node.sdo[0x1016][1].raw = MASTER << 16 | 200
    assert refused(bench, 0x1016, 2, MASTER << 16 | 300, node=node.id) == 0x06040043
    bench.bus.run(1.0)
    assert node.nmt.state == "OPERATIONAL"  # watched from its first heartbeat on
    for _ in range(4):
        bench.master.send_message(0x700 + MASTER, b"\5")
        bench.bus.run(0.15)
    assert [each.code for each in node.emcy.active] == []
    bench.bus.run(0.15)
    assert node.emcy.active[-1].code == 0x8130
    assert node.emcy.active[-1].data[0] == MASTER
    assert bench.made.voices["DISPLAY"].node.nmt.state == "PRE-OPERATIONAL"
    assert node.sdo[0x1001].raw == 0x11
    assert node.sdo[0x1003][1].raw == 0x8130
    bench.master.send_message(0x700 + MASTER, b"\5")
    bench.bus.run(0.01)
    assert node.emcy.active == []
    assert node.sdo[0x1001].raw == 0
    assert node.sdo[0x1003][0].raw >= 1
    node.sdo[0x1003][0].raw = 0
    assert node.sdo[0x1003][0].raw == 0
    with pytest.raises(SdoAbortedError) as nothing:
        assert node.sdo[0x1003][1].raw
    assert nothing.value.code == 0x08000024


def test_what_is_saved_outlives_a_reset_until_the_defaults_come_back(bench: Bench) -> None:
    node = bench.master[RA]
    first = node.sdo["kp_q12"].raw

    def reset() -> int:
        node.nmt.state = "RESET"
        bench.bus.run(0.6)
        return int(node.sdo[0x1017].raw)

    node.sdo[0x1017].raw = 500
    assert reset() == 1000
    node.sdo[0x1017].raw, node.sdo["kp_q12"].raw = 500, first + 1
    node.sdo.download(0x1010, 1, b"save")
    assert reset() == 500
    assert node.sdo["kp_q12"].raw == first + 1
    node.sdo.download(0x1011, 1, b"load")
    assert node.sdo[0x1017].raw == 500
    assert reset() == 1000
    assert node.sdo["kp_q12"].raw == first


def test_an_object_comes_in_blocks_with_its_crc(bench: Bench) -> None:
    sdo = bench.master[RA].sdo
    with sdo.open(0x1008, 0, "rb", block_transfer=True, buffering=0) as stream:
        assert stream.read() == b"schmidt AXIS"
        assert stream.crc_supported
        assert stream.size == 12
    with sdo.open(0x1008, 0, "rb") as stream:
        assert stream.read() == b"schmidt AXIS"
    answers = []
    for request in (b"\xa3", b"\xa0\x08\x10\x00\x00", b"\xa0\x08\x10\x00\x80", b"\xa4\x08\x10\x00\x01"):
        bench.heard.clear()
        bench.master.send_message(0x600 + RA, request.ljust(8, b"\0"))
        answers.append(heard(bench, 0x580 + RA)[-1])
    assert [int.from_bytes(each[4:], "little") for each in answers] == [
        0x05040001,
        0x05040002,
        0x05040002,
        12,
    ]
    for request, blocks in ((b"\xa3", 1), (b"\xa2\x00\x01", 1), (b"\xa2\x01\x7f", 1), (b"\xa2\x01\x7f", 1)):
        bench.heard.clear()
        bench.master.send_message(0x600 + RA, request.ljust(8, b"\0"))
        assert len(heard(bench, 0x580 + RA)) == blocks
        answers.append(heard(bench, 0x580 + RA)[-1])
    # one segment, again as it was not acknowledged, the last, the end with two bytes unused
    assert [each[0] for each in answers[4:]] == [0x01, 0x01, 0x81, 0xC1 | 2 << 2]


def mapped_objects(file: Path) -> dict[str, bool]:
    """Those that the sheet's PDOs hold as they come, and whether it says that each may be mapped."""
    sheet = configparser.ConfigParser()
    sheet.read(file)
    entries = [
        int(sheet[name]["DefaultValue"], 0)
        for name in sheet
        if re.fullmatch(r"1[6a]..sub[1-8]", name, re.IGNORECASE)
    ]
    names = [f"{entry >> 16:04X}sub{entry >> 8 & 0xFF:X}" for entry in entries if entry]
    return {name: int(sheet[name]["PDOMapping"], 0) == 1 for name in names}


def test_the_sheets_are_the_same_bytes_and_the_dbc_reads_the_bus(bench: Bench, tmp_path: Path) -> None:
    first, second = write_eds(tmp_path / "one"), write_eds(tmp_path / "two")
    assert [file.read_bytes() for file in first] == [file.read_bytes() for file in second]
    sheet = (tmp_path / "one" / "axis.eds").read_text()
    assert "BaudRate_1000=1\n" in sheet
    assert "PDOMapping=0x0" in sheet.split("[1000]")[1].split("[")[0]
    for file in first:
        if file.suffix == ".eds":
            assert len(mapped := mapped_objects(file)) >= 5
            assert all(mapped.values()), file.name
    dbc = cantools.database.load_file(tmp_path / "one" / "canopen.dbc")
    assert isinstance(dbc, cantools.database.can.Database)
    bench.bus.run(1.5)
    assert len(bench.heard) > 1000
    for message in bench.heard:
        dbc.decode_message(message.arbitration_id, bytes(message.data))
    assert dbc.decode_message(0x700 + RA, b"\5") == {"State": "OPERATIONAL"}
